// SPDX-License-Identifier: BSD-3-Clause
// SSDD in the specular coordinate system. Data in the plane of incidence are written at the union of their angles, each
// measured value at its own place and the others between their neighbours; data on a grid as they stand.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/constants.hpp"
#include "world/degree.hpp"
#include "world/measured/scatter_file.hpp"

namespace straytrace {
namespace {

// Degrees to a millionth: the same angle of two incidences is the same number.
double rounded(double radian) { return std::round(radian / degree * 1e6) / 1e6 + 0.0; }

struct Turned {
  double polar, azimuth, value;  // deg about the specular direction, azimuth 0 away from the normal; 1/sr
};

Turned turned(ScatterPoint const& p) {
  double const s = std::sin(p.theta_s), x = s * std::cos(p.phi), y = s * std::sin(p.phi), z = std::cos(p.theta_s),
               si = std::sin(p.theta_i), ci = std::cos(p.theta_i);
  double const away = x * ci - z * si, on = x * si + z * ci, side = std::fabs(y);  // symmetric about the plane
  double const polar = rounded(std::atan2(std::hypot(away, side), on));
  return {polar, polar > 0 ? rounded(std::atan2(side, away)) : 0, p.value};
}

// Value at an angle: linear in ln over ln(polar) between neighbours; beyond them the nearest, or zero.
double between(std::map<double, double> const& curve, double polar, bool zero) {
  auto const above = curve.lower_bound(polar);
  if (above != curve.end() && above->first == polar) return above->second;
  if (above == curve.begin() || above == curve.end())
    return zero ? 0 : above == curve.end() ? curve.rbegin()->second : above->second;
  auto const below = std::prev(above);
  double const x0 = std::log(std::max(below->first, 1e-6)), x1 = std::log(above->first),
               share = (std::log(polar) - x0) / (x1 - x0);
  return below->second * std::pow(above->second / below->second, share);
}

struct Grid {
  std::set<double> polar, azimuth;
  std::vector<double> incidence;
  std::vector<std::map<double, std::map<double, double>>> value;  // [incidence][azimuth][polar]
};

Grid grid_of(ScatterFile const& file) {
  Grid g;
  for (auto const& group : by_incidence(file.points)) {
    g.incidence.push_back(rounded(group[0].theta_i));
    g.value.emplace_back();
    for (ScatterPoint const& p : group) {
      Turned const t = turned(p);
      g.polar.insert(t.polar);
      if (t.polar > 0) g.azimuth.insert(t.azimuth);
      g.value.back()[t.azimuth][t.polar] = t.value;
    }
    for (auto const& [azimuth, curve] : std::map(g.value.back()))  // the specular direction belongs to all azimuths
      if (curve.contains(0))
        for (auto& [other, values] : g.value.back()) values[0] = curve.at(0);
  }
  return g;
}

// Comments that this program reads back: the format has no place for them.
std::string declared_lines(ScatterDeclared const& d) {
  std::string out;
  if (!d.polarisation_in.empty()) out += fmt::format("# polarisation_in: {}\n", d.polarisation_in);
  if (!d.polarisation_out.empty()) out += fmt::format("# polarisation_out: {}\n", d.polarisation_out);
  if (d.noise_floor > 0) out += fmt::format("# noise_floor: {:.6g} /sr\n", d.noise_floor);
  if (d.noise_floor == 0) out += "# noise_floor: none\n";
  return out;
}

}  // namespace

std::string ssdd_text(ScatterFile const& file, std::string_view beyond, std::string& why) {
  why.clear();
  for (ScatterPoint const& p : file.points)
    if (p.theta_s != p.theta_s) {
      why = "the file gives offsets, not directions";
      return {};
    }
  Grid const g = grid_of(file);
  bool const plane = std::all_of(g.azimuth.begin(), g.azimuth.end(), [](double a) { return a == 0 || a == 180; });
  if (!plane && g.azimuth.size() > 361) {
    why = fmt::format("the directions form no grid about the specular direction: {} azimuths", g.azimuth.size());
    return {};
  }
  std::string rows;
  std::size_t filled = 0;
  for (double const azimuth : g.azimuth)
    for (double const polar : g.polar)
      for (auto const& incidence : g.value) {
        // A side that was not measured takes the other one.
        auto const nearest = [&] {
          auto best = incidence.begin();
          for (auto it = best; it != incidence.end(); ++it)
            if (std::fabs(it->first - azimuth) < std::fabs(best->first - azimuth)) best = it;
          return best;
        }();
        filled += nearest->first != azimuth || !nearest->second.contains(polar);
        rows += fmt::format("{:.6g}\n", between(nearest->second, polar, beyond == "zero"));
      }
  return fmt::format(
      "VERSION 0.2\nSOFTWARE straytrace\n\n# converted from: {}\n# of {} values {} were not measured: interpolated, or "
      "continued ({})\n# azimuth 0 points from the specular direction away from the normal\n{}DATA_TYPE "
      "{}\nCOLOR_MODEL "
      "spectrum\nWAVELENGTH_LIST {:.10g}\nPARAM_TYPE specular_coordinate_system\nREDUCTION_TYPE "
      "bilateral_symmetry\nPARAM0_LIST {}\nPARAM2_LIST {}\nPARAM3_LIST {}\nSOURCE_TYPE measured\nDATA ascii\n{}",
      file.format, g.incidence.size() * g.polar.size() * g.azimuth.size(), filled, beyond,
      declared_lines(file.declared), file.transmitted ? "btdf" : "brdf", file.declared.wavelength * 1e9,
      fmt::join(g.incidence, " "), fmt::join(g.polar, " "), fmt::join(g.azimuth, " "), rows);
}

}  // namespace straytrace
