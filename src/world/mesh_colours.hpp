// SPDX-License-Identifier: BSD-3-Clause
// Colours that mesh files give, as "#rrggbb" of sRGB.
#pragma once

#include <assimp/scene.h>

#include <string>
#include <vector>

namespace straytrace {

// "#RRGGBB" of three shares of 1.
std::string colour_text(double red, double green, double blue);
// Of the material of a glTF file, whose numbers are linear; empty: it has none.
std::string gltf_colour(aiScene const&, aiMesh const&);
// By face, where the vertices have colours: that of the first corner. Empty: they have none, or so many that they are
// a photograph.
std::vector<std::string> vertex_colours(aiMesh const&);

}  // namespace straytrace
