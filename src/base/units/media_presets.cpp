// SPDX-License-Identifier: BSD-3-Clause
#include "base/units/media_presets.hpp"

#include <cmath>

namespace straytrace {
namespace {

constexpr double sq(double x) { return x * x; }
// A single measured index, for the Nd:YAG line only.
constexpr MediumPreset at_1064(std::string_view name, double index, std::string_view source) {
  return {name, 1.066e-6, 1.062e-6, 293.15, index * index, {}, {}, source};
}

constexpr MediumPreset presets[] = {
    {"fused_silica",
     3.71e-6,
     0.21e-6,
     293.15,
     1,
     {0.6961663, 0.4079426, 0.8974794},
     {sq(0.0684043), sq(0.1162414), sq(9.896161)},
     "published: Malitson 1965, 20 C"},
    {"bk7",
     2.5e-6,
     0.3e-6,
     293.15,
     1,
     {1.03961212, 0.231792344, 1.01046945},
     {0.00600069867, 0.0200179144, 103.560653},
     "published: Schott N-BK7 data sheet, 20 C"},
    {"sapphire",
     5.0e-6,
     0.2e-6,
     293.15,
     1,
     {1.4313493, 0.65054713, 5.3414021},
     {sq(0.0726631), sq(0.1193242), sq(18.028251)},
     "published: Malitson and Dodge 1972, ordinary ray, 20 C"},
    {"calcium_fluoride",
     9.7e-6,
     0.23e-6,
     297.15,
     1,
     {0.5675888, 0.4710914, 3.8484723},
     {sq(0.050263605), sq(0.1003909), sq(34.649040)},
     "published: Malitson 1963, 24 C"},
    {"silicon",
     11e-6,
     1.36e-6,
     293.15,
     1,
     {10.6684293, 0.003043475, 1.54133408},
     {sq(0.301516485), sq(1.13475115), sq(1104.0)},
     "published: Handbook of Optics, 3rd ed., vol. 4 (2009), room temperature"},
    at_1064("suprasil", 1.45003, "original program: Suprasil 3001, in vacuum; temperature not stated, 20 C assumed"),
    at_1064("herasil", 1.45012, "original program: Herasil, in vacuum; temperature not stated, 20 C assumed"),
    at_1064("silicon_carbide", 2.5835, "original program; temperature not stated, 20 C assumed"),
};

}  // namespace

std::span<MediumPreset const> medium_presets() { return presets; }

std::optional<double> index_of(MediumPreset const& p, double wavelength) {
  if (!(wavelength >= p.shortest && wavelength <= p.longest)) return {};
  double const square = sq(wavelength * 1e6);
  double sum = p.constant;
  for (int i = 0; i < 3; ++i) sum += p.strength[i] * square / (square - p.resonance[i]);
  return std::sqrt(sum);
}

}  // namespace straytrace
