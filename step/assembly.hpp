// SPDX-License-Identifier: BSD-3-Clause
// The tree of a file: shapes of single parts, placed, with names and the colours of their faces.
#pragma once

#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <functional>
#include <string>
#include <vector>

namespace straytrace::step {

struct PlacedFaces {
  std::string name;                  // "sub/dump"; names of the same parent are made unique: dump, dump_2
  TopoDS_Shape shape;                // placed
  std::vector<TopoDS_Shape> faces;   // placed, faces on one carrier joined
  std::vector<std::string> colours;  // of the faces, "#202020" or empty
};

// One after the other, in the order of the file.
void for_each_part(Handle(TDocStd_Document) const&, std::function<void(PlacedFaces const&)> const&);

}  // namespace straytrace::step
