// SPDX-License-Identifier: BSD-3-Clause
#include "world/mesh_colours.hpp"

#include <assimp/material.h>
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "world/mesh_file.hpp"

namespace straytrace {
namespace {

constexpr std::size_t most_colours = 64;

double srgb(double linear) { return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055; }

}  // namespace

std::string colour_text(double red, double green, double blue) {
  auto const byte = [](double x) { return int(std::lround(255 * std::fmin(std::fmax(x, 0), 1))); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(red), byte(green), byte(blue));
}

std::string gltf_colour(aiScene const& scene, aiMesh const& mesh) {
  if (mesh.mMaterialIndex >= scene.mNumMaterials) return "";
  aiColor4D c;
  if (scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_BASE_COLOR, c) != aiReturn_SUCCESS) return "";
  return colour_text(srgb(c.r), srgb(c.g), srgb(c.b));
}

std::vector<std::string> vertex_colours(aiMesh const& mesh) {
  aiColor4D const* const colours = mesh.mColors[0];
  if (!colours) return {};
  std::vector<std::string> of_face;
  std::set<std::string> seen;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    aiFace const& face = mesh.mFaces[i];
    bool const sound = face.mNumIndices > 0 && face.mIndices[0] < mesh.mNumVertices;
    aiColor4D const c = sound ? colours[face.mIndices[0]] : aiColor4D();
    of_face.push_back(colour_text(c.r, c.g, c.b));
    if (seen.insert(of_face.back()).second && seen.size() > most_colours) return {};
  }
  return of_face;
}

void set_library_colours(std::string const& library, MeshFile& mesh) {
  std::map<std::string, std::string> colour;
  std::istringstream lines(library);
  for (std::string line, name; std::getline(lines, line);) {
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
    line.erase(0, line.find_first_not_of(" \t"));
    if (line.starts_with("newmtl ")) name = line.substr(7);
    if (!line.starts_with("Kd ")) continue;
    std::istringstream numbers(line.substr(3));
    if (double r = 0, g = 0, b = 0; numbers >> r >> g >> b) colour[name] = colour_text(r, g, b);
  }
  for (MeshPart& p : mesh.parts)
    if (auto const hit = colour.find(p.material); hit != colour.end()) p.colour = hit->second;
}

}  // namespace straytrace
