// SPDX-License-Identifier: BSD-3-Clause
// Physical dimensions and quantities of the input language (docs/reference/scene.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/namespaces.hpp"

namespace straytrace {

// Powers are counted in halves, so that m/sqrt(Hz) = m s^(1/2) is {2, 0, 1}. Angle, solid angle and counts differ
// from 1 on purpose: the user must write "1/sr".
struct Dimension {
  std::int8_t metre = 0, kilogram = 0, second = 0, radian = 0, steradian = 0, count = 0, volt = 0;
  bool operator==(Dimension const&) const = default;
};

namespace dim {
inline constexpr Dimension plain{}, length{2}, per_metre{-2}, angle{0, 0, 0, 2}, mass{0, 2}, time{0, 0, 2},
    frequency{0, 0, -2}, power{4, 2, -6}, brdf{0, 0, 0, 0, -2}, displacement_asd{2, 0, 1}, displacement_psd{4, 0, 2},
    angle_asd{0, 0, 1, 2}, angle_psd{0, 0, 2, 4};
}

enum class Amplitude : std::uint8_t { none, peak, peak_to_peak, rms };  // part of a quantity, never assumed

struct Quantity {
  double si = 0;
  Dimension dimension;
  Amplitude amplitude = Amplitude::none;
};

std::string name_of(Dimension);         // "length", "angle", "BRDF (1/sr)", or the unit in SI symbols
std::string example_unit(Dimension);    // as a user may write it: "m", "deg", "1/sr", "m/sqrt(Hz)"
std::string accepted_units(Dimension);  // "rad, mrad, urad, deg, arcmin, arcsec"
// Factor to SI and dimension of a unit expression such as "um/s^2" or "m/sqrt(Hz)"; empty when not understood. Knows
// the units of the language and those of sensors: N, Pa, T, A, mV.
std::optional<Quantity> parse_unit(std::string_view);

struct LeadingUnit {
  Quantity unit;           // factor to SI and dimension
  std::size_t length = 0;  // bytes of the text that belong to it
};
// The longest unit a text begins with, as it may follow a number: "m/sqrt(Hz) + a" -> "m/sqrt(Hz)", "/sr" -> "/sr".
std::optional<LeadingUnit> leading_unit(std::string_view);
bool is_unit_name(std::string_view);        // a single unit without prefix arithmetic: "um", "%", "h"
std::string likely_unit(std::string_view);  // "m" for "metre", "Hz" for "hz"; empty when nothing is close
std::string all_unit_names();               // for messages
// value * factor; a unit that is 1/n of SI divides by n, so that 1064 nm is the same double as 1064e-9.
double to_si(double value, Quantity const& unit);
// Product, quotient and power of dimensions; empty when it is not representable (powers beyond halves, too large).
std::optional<Dimension> times(Dimension, Dimension, int sign = 1);
std::optional<Dimension> power_of(Dimension, double exponent);
std::string described(Dimension);                             // "a length", "an angle", "a plain number"
std::string with_unit(std::string const& number, Dimension);  // "55 deg", "1e-4 /sr": an example that is accepted

}  // namespace straytrace
