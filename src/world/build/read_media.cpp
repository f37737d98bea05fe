// SPDX-License-Identifier: BSD-3-Clause
// The table `media`: what volumes are filled with. Also the wavelength, which indices and films need first.
#include "world/build/read_media.hpp"

#include <fmt/format.h>

#include <cmath>

#include "optics/media_presets.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace {
namespace {

// A preset at the wavelength of the scene; nothing, and a problem, when it is not known there.
std::optional<Medium> from_preset(Node const& where, MediumPreset const& preset, double wavelength) {
  if (auto const index = index_of(preset, wavelength)) return Medium{*index, 0};
  where.problem(fmt::format("the index of '{}' is known from {:.0f} nm to {:.0f} nm only", preset.name,
                            preset.shortest * 1e9, preset.longest * 1e9),
                "give the index at the wavelength of the beams: 'media: {name: {index: 1.45}}'");
  return {};
}

MediumPreset const* find_preset(std::string_view name) {
  for (MediumPreset const& p : medium_presets())
    if (p.name == name) return &p;
  return nullptr;
}

}  // namespace

void read_media(Scene const& scene, World& world, Registry& names) {
  for (auto const& [name, beam] : scene.table("beams").items()) {
    double const wavelength = beam.number("wavelength", dim::length, 1.064e-6, 1e-7, 1e-4);
    if (!std::isnan(wavelength)) world.wavelength = wavelength;
    break;  // one for all beams
  }
  for (auto const& [name, node] : scene.table("media").items()) {
    Medium medium;
    if (node.has("preset")) {
      if (node.has("index")) node.problem("'preset' and 'index' say the same thing twice", "keep one of them");
      auto const found = find_medium(node["preset"], world, Registry{});
      if (found) medium = *found;
    } else {
      medium.index = node.number("index", dim::plain, required, 0.1, 10);
    }
    medium.absorption = node.number("absorption", dim::per_metre, 0, 0, 1e9);
    node.has("source");
    node.refuse_unknown(fmt::format("medium '{}'", name));
    names.media[name] = medium;
  }
}

bool is_medium(std::string_view name, Registry const& names) {
  return name == "vacuum" || find_preset(name) || names.media.contains(std::string(name));
}

std::optional<Medium> find_medium(Node const& where, World const& world, Registry const& names) {
  std::string const name = where.as_word();
  if (name.empty()) return {};
  if (auto const own = names.media.find(name); own != names.media.end()) return own->second;
  if (name == "vacuum") return Medium{};
  if (MediumPreset const* const preset = find_preset(name)) return from_preset(where, *preset, world.wavelength);
  std::vector<std::string> known{"vacuum"};
  for (MediumPreset const& p : medium_presets()) known.emplace_back(p.name);
  for (auto const& [own, medium] : names.media) known.push_back(own);
  std::string const near = nearest_word(name, known);
  std::string all;
  for (std::string const& k : known) all += (all.empty() ? "" : ", ") + k;
  where.problem(fmt::format("no medium is called '{}'", name),
                near.empty() ? "known media: " + all : fmt::format("did you mean '{}'?", near));
  return {};
}

std::vector<KnownMedium> known_media() {
  std::vector<KnownMedium> all;
  for (MediumPreset const& p : medium_presets())
    for (double const wavelength : {1064e-9, 1550e-9})
      if (auto const index = index_of(p, wavelength)) {
        all.push_back({std::string(p.name), std::string(p.source), *index, wavelength});
        break;
      }
  return all;
}

}  // namespace straytrace
