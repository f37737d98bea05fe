// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>

#include "world/material_presets.hpp"
#include "world/read_laws.hpp"

namespace straytrace {
namespace {

constexpr std::string_view cases[] = {"low", "mid", "high"};

// `take`: low, mid or high, or a number 0, 1, 2, which may be a parameter.
int case_of(Node const& material) {
  Node const take = material["take"];
  if (!take) return 1;
  for (int i = 0; i < 3; ++i)
    if (take.kind() == Node::Kind::scalar && take.text() == cases[i]) return i;
  double const number = take.as_number(dim::plain, 0, 2);
  if (std::isfinite(number) && number != std::floor(number))
    take.problem("'take' is one of three cases", "write low, mid or high, or 0, 1, 2 for a parameter");
  return std::isfinite(number) ? int(number) : 1;
}

// The preset of a material: a name of the list, or its own numbers.
std::optional<MaterialPreset> preset_of(std::string const& name, Node const& material) {
  if (Node const own = material["preset"]; own.kind() == Node::Kind::table) return read_preset_numbers(name, own);
  std::vector<std::string_view> names;
  for (MaterialPreset const& p : material_presets()) names.push_back(p.name);
  std::string const wanted = material.choice("preset", names);
  for (MaterialPreset const& p : material_presets())
    if (p.name == wanted) return p;
  return {};
}

// Largest share of the light that the laws read so far scatter at any incidence.
double most_scattered(LawReading const& out) {
  double most = 0;
  for (int i = 0; i < AlbedoTable::size; ++i) {
    double sum = 0;
    for (PoolRef const law : out.laws)
      sum += out.world.view().laws.visit(law, [&](auto const& l) { return l.albedo(AlbedoTable::cosine(i)); });
    most = std::fmax(most, sum);
  }
  return most;
}

}  // namespace

LawInfo read_preset(Node const& material, LawReading& out, Optic& optic) {
  int const which = case_of(material);
  auto const preset = preset_of(out.material, material);
  if (!preset) {
    material.has("bracket");
    return {};
  }
  using Gives = MaterialPreset::Gives;
  Dimension const dimension = preset->gives == Gives::brdf ? dim::brdf : dim::plain;
  double values[3] = {preset->values[0], preset->values[1], preset->values[2]};
  bool const own = material.has("bracket");
  if (own) {
    auto const given = material["bracket"].as_numbers(dimension, 3);
    if (some_missing(given)) return {};
    if (!(given[0] >= 0 && given[0] <= given[1] && given[1] <= given[2])) {
      material["bracket"].problem("a bracket is low, mid, high, in this order", "write [1e-3 /sr, 3e-3 /sr, 1e-2 /sr]");
      return {};
    }
    for (int i = 0; i < 3; ++i) values[i] = given[std::size_t(i)];
  }
  double const value = values[which];
  if (value > 0) {
    out.spread.low = values[0] / value;
    out.spread.high = values[2] / value;
  }
  out.spread.of_reflection = preset->gives == Gives::reflect;
  out.spread.status = preset->status;
  if (preset->gives == Gives::reflect) {
    optic.reflect = value;
  } else if (preset->gives == Gives::tis_75 && !own) {
    constexpr double per_peak = 0.0868071;  // albedo at 75 deg of a forward lobe of peak 1/sr, width 0.3, rise 1
    Polynomial p;
    p.c[0][0] = value / pi;
    p.width = 0.3;
    p.peak = (preset->at_75[which] - value) / per_peak;
    p.prepare();
    out.add(p);
  } else {
    double const tis = preset->gives == Gives::brdf ? pi * value : value;
    if (tis > 1) material.problem("the preset would scatter more than 1", "lower its bracket");
    out.add(Lambertian{std::fmin(tis, 1)});
  }
  if (preset->through > 0) {
    optic.through[out.laws.size()] = true;
    out.add(Lambertian{preset->through});
  }
  if (preset->reflect > 0 && !material.has("specular")) {
    optic.reflect = preset->reflect;
    if (preset->through > 0) optic.transmit = std::fmax(0, 1 - preset->reflect - most_scattered(out));  // a window
  }
  out.note(fmt::format("preset {}, {} of [{:g}, {:g}, {:g}]{}; {}, {}, {}{}{}", preset->name, cases[which], values[0],
                       values[1], values[2], dimension == dim::brdf ? " /sr" : "", preset->status, preset->source,
                       preset->wavelength, preset->note.empty() ? "" : "; ", preset->note));
  if (!own && !preset->has_bracket())
    material["preset"].warning(
        fmt::format("preset '{}' comes without a bracket", preset->name),
        fmt::format("name a material of your own: {{preset: {}, bracket: [low, mid, high]}}", preset->name));
  return {"preset " + preset->name, fmt::format("{}, {}", preset->status, preset->source), preset->wavelength};
}

}  // namespace straytrace
