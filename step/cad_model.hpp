// SPDX-License-Identifier: BSD-3-Clause
// Content of a STEP file as passed to straytrace. Lengths in m, in the frame of the file; charts of faces are
// those of src/geometry/cad/cad_face.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace straytrace::step {

using Triple = std::array<double, 3>;
struct ChartPoint {
  double x = 0, y = 0;
};
// Straight on to the next corner, or along an arc that turns by 4 atan(bulge), against the clock when positive.
struct Corner {
  double x = 0, y = 0, bulge = 0;
};
using Loop = std::vector<Corner>;

enum class Kind { plane, cylinder, cone, sphere, torus };
constexpr std::array<char const*, 5> kind_names = {"plane", "cylinder", "cone", "sphere", "torus"};

struct Face {
  Kind kind = Kind::plane;
  Triple origin{}, x{1, 0, 0}, z{0, 0, 1};  // frame; a cone has its apex at the origin and opens along z
  double radius = 0, second = 0;            // m: cylinder, sphere, ring and tube of a torus; half angle of a cone, rad
  bool flipped = false;                     // the side outside the solid is not that of the carrier's normal
  // Natural bounds: radii of a plane or cone, heights of a cylinder or sphere; none of a whole torus.
  bool natural = false;
  std::array<double, 2> within{};
  std::vector<Loop> loops;  // otherwise
};

struct Triangles {
  std::vector<Triple> vertices;
  std::vector<std::array<std::uint32_t, 3>> corners;  // counter-clockwise seen from outside the solid
  std::size_t faces = 0;                              // number of faces of the file that they represent
};

struct Part {
  std::string name, colour;  // "sub/dump"; "#202020", empty: none in the file
  std::vector<Face> faces;
  Triangles triangles;
};

struct Note {
  std::string what, suggestion;
};

struct Settings {
  double tolerance = 1e-6;  // m, of trimming by curves
  double chord = 1e-5;      // m, of faces that become triangles
};

struct Model {
  std::string schema;        // as in the file
  double unit = 0;           // m per unit of the file; 0: it has several, or one that is not known
  bool unit_stated = false;  // false: the file states none, millimetres are assumed
  Triple lower{}, upper{};   // m, bounding box
  std::vector<Part> parts;
  std::vector<Note> notes;
};

// Thrown for a file that cannot be used.
struct Refused {
  std::string what, suggestion;
};

}  // namespace straytrace::step
