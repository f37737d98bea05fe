// SPDX-License-Identifier: BSD-3-Clause
// How dimensions are called in messages.
#include <fmt/format.h>

#include <array>
#include <utility>

#include "base/quantity.hpp"

namespace straytrace {
namespace {

struct Named {
  Dimension dimension;
  std::string_view name, example, accepted;
};

constexpr Dimension area{4};

constexpr std::array named{
    Named{dim::plain, "plain number", "", "a plain number, %, ppm, ppb"},
    Named{dim::length, "length", "m", "m, km, cm, mm, um, nm, in"},
    Named{dim::angle, "angle", "deg", "rad, mrad, urad, deg, arcmin, arcsec"},
    Named{dim::mass, "mass", "kg", "kg, g"},
    Named{dim::time, "time", "s", "s, ms, us, min, h"},
    Named{dim::frequency, "frequency", "Hz", "Hz, kHz, MHz, mHz"},
    Named{dim::power, "power", "W", "W, kW, MW, mW"},
    Named{area, "area", "m^2", "m^2, cm^2, mm^2"},
    Named{dim::brdf, "BRDF (1/sr)", "1/sr", "1/sr"},
    Named{dim::per_metre, "curvature (1/m)", "1/m", "1/m, 1/km, 1/cm, 1/mm"},
    Named{{0, 0, 0, 0, 2}, "solid angle", "sr", "sr"},
    Named{{0, 0, 0, 0, 0, 2}, "number of counts", "count", "count"},
    Named{{0, 0, 0, 0, 0, 0, 2}, "voltage", "V", "V"},
    Named{{2, 0, -2}, "speed", "m/s", "m/s, mm/s, um/s, nm/s"},
    Named{{2, 0, -4}, "acceleration", "m/s^2", "m/s^2, mm/s^2, um/s^2, nm/s^2"},
    Named{dim::displacement_asd, "displacement density (m/sqrt(Hz))", "m/sqrt(Hz)",
          "m/sqrt(Hz), mm/sqrt(Hz), um/sqrt(Hz), nm/sqrt(Hz)"},
    Named{dim::displacement_psd, "displacement power density (m^2/Hz)", "m^2/Hz", "m^2/Hz, um^2/Hz, nm^2/Hz"},
    Named{dim::angle_asd, "angle density (rad/sqrt(Hz))", "rad/sqrt(Hz)", "rad/sqrt(Hz), mrad/sqrt(Hz), urad/sqrt(Hz)"},
    Named{dim::angle_psd, "angle power density (rad^2/Hz)", "rad^2/Hz", "rad^2/Hz, urad^2/Hz"},
};

Named const* find(Dimension d) {
  for (Named const& n : named)
    if (n.dimension == d) return &n;
  return nullptr;
}

std::string powered(std::string_view symbol, int halves) {
  if (halves == 2) return std::string(symbol);
  if (halves == 1) return fmt::format("sqrt({})", symbol);
  return fmt::format("{}^{:g}", symbol, halves / 2.0);
}

std::string si_symbols(Dimension d) {
  if (d.second % 2 != 0) {  // a density per root hertz reads better than root seconds
    Dimension rest = d;
    rest.second = static_cast<std::int8_t>(d.second - 1);
    return fmt::format("{}/sqrt(Hz)", si_symbols(rest));
  }
  std::array<std::pair<std::string_view, int>, 7> const parts{{{"m", d.metre},
                                                               {"kg", d.kilogram},
                                                               {"s", d.second},
                                                               {"rad", d.radian},
                                                               {"sr", d.steradian},
                                                               {"count", d.count},
                                                               {"V", d.volt}}};
  std::string above, below;
  for (auto const& [symbol, halves] : parts) {
    if (halves > 0) (above += above.empty() ? "" : "*") += powered(symbol, halves);
    if (halves < 0) below += fmt::format("/{}", powered(symbol, -halves));
  }
  return (above.empty() ? "1" : above) + below;
}

}  // namespace

std::string name_of(Dimension d) {
  Named const* hit = find(d);
  return hit ? std::string(hit->name) : si_symbols(d);
}

std::string example_unit(Dimension d) {
  Named const* hit = find(d);
  return hit ? std::string(hit->example) : si_symbols(d);
}

std::string accepted_units(Dimension d) {
  Named const* hit = find(d);
  return hit ? std::string(hit->accepted) : si_symbols(d);
}

std::string described(Dimension d) {
  Named const* hit = find(d);
  if (!hit) return fmt::format("a quantity in {}", si_symbols(d));
  bool const vowel = std::string_view("aeiou").find(hit->name.front()) != std::string_view::npos;
  return fmt::format("{} {}", vowel ? "an" : "a", hit->name);
}

std::string with_unit(std::string const& number, Dimension d) {
  std::string unit = example_unit(d);
  if (unit.starts_with("1/")) unit.erase(0, 1);
  return unit.empty() ? number : number + " " + unit;
}

}  // namespace straytrace
