// SPDX-License-Identifier: BSD-3-Clause
// SSDD 0.2 (surface scattering distribution data): blocks of tables over lists of angles. The BRDF or BTDF is read.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "base/math/constants.hpp"
#include "base/math/vec3.hpp"
#include "io/delimited_text.hpp"
#include "world/scatter_data/scatter_file.hpp"

namespace straytrace::world {
namespace {

struct Block {
  std::string type, colour, directions;
  std::array<std::vector<double>, 5> list;  // deg
  std::vector<double> wavelengths;          // nm
  bool ascii = true;
  TextCell where;

  std::size_t size(std::size_t i) const { return std::max<std::size_t>(1, list[i].size()); }
};

class SsddReader {
 public:
  SsddReader(std::string_view text, ScatterFile& file, std::vector<Problem>& problems)
      : in_(text, problems), file_(file) {}

  void read() {
    while (in_.sound && !in_.done()) {
      TextCell const key = in_.next();
      if (key.text == "DATA_TYPE")
        block(key);
      else if (!is_header(key.text))
        in_.refuse(key, fmt::format("unknown keyword '{}'", key.text),
                   "known: VERSION, SOFTWARE, API, DATE, DATA_TYPE");
      else
        in_.rest_of_line(key);
    }
    if (in_.sound && !found_)
      in_.refuse({}, "the file contains no BRDF or BTDF",
                 "only specular shares: give them to 'specular' of the material");
  }

 private:
  static bool is_header(std::string_view word) {
    return word == "VERSION" || word == "SOFTWARE" || word == "API" || word == "DATE";
  }

  void block(TextCell const& first) {
    Block b;
    b.where = first;
    b.type = word(first);
    while (in_.sound) {
      TextCell const key = in_.next();
      if (key.line == 0) return in_.refuse(key, "keyword 'DATA' is missing", "the file is cut off: export it again");
      if (key.text == "DATA") {
        b.ascii = word(key) == "ascii";
        break;
      }
      entry(key, b);
    }
    if (in_.sound) check(b);
    if (in_.sound) table(b);
  }

  std::string word(TextCell const& key) {
    auto const words = in_.rest_of_line(key);
    if (words.empty()) in_.refuse(key, fmt::format("'{}' has no value", key.text), "write its value after it");
    return words.empty() ? "" : std::string(words[0].text);
  }

  void entry(TextCell const& key, Block& b) {
    static constexpr std::string_view others[] = {"REDUCTION_TYPE", "NAME",          "SOURCE_TYPE",
                                                  "DEVICE",         "CREATION_DATE", "MEASUREMENT_DATE"};
    std::string_view const k = key.text;
    if (k == "COLOR_MODEL")
      b.colour = word(key);
    else if (k == "PARAM_TYPE")
      b.directions = word(key);
    else if (k == "WAVELENGTH_LIST")
      b.wavelengths = in_.numbers(in_.words_left_in_line(key), "WAVELENGTH_LIST");
    else if (k.size() == 11 && k.starts_with("PARAM") && k.ends_with("_LIST") && k[5] >= '0' && k[5] <= '4')
      b.list[std::size_t(k[5] - '0')] = in_.numbers(in_.words_left_in_line(key), std::string(k));
    else if (std::ranges::find(others, k) != std::end(others))
      in_.rest_of_line(key);
    else
      in_.refuse(key, fmt::format("unknown keyword '{}'", k), "known are those of SSDD 0.2");
  }

  void check(Block const& b) {
    auto const refuse = [&](std::string what, std::string suggestion) {
      in_.refuse(b.where, std::move(what), std::move(suggestion));
    };
    bool const scatter = b.type == "brdf" || b.type == "btdf";
    if (!scatter && b.type != "specular_reflectance" && b.type != "specular_transmittance")
      refuse(fmt::format("unknown DATA_TYPE '{}'", b.type),
             "brdf, btdf, specular_reflectance or specular_transmittance");
    if (!b.ascii) refuse("binary data", "write the file with 'DATA ascii'");
    if (b.list[0].empty()) refuse("PARAM0_LIST (incidences) is missing", "add it");
    if (scatter && (b.list[2].empty() || b.list[3].empty())) refuse("PARAM2_LIST or PARAM3_LIST is missing", "add it");
    if (scatter && b.list[1].size() > 1)
      refuse("several azimuths of incidence: the surface is anisotropic, the model 'table' is isotropic",
             "keep one azimuth, or describe grooves by the model 'grooves'");
    if (scatter && b.directions == "half_difference_coordinate_system")
      refuse("directions about the halfway vector",
             "write the file in the spherical or the specular coordinate system");
    else if (scatter && b.directions != "spherical_coordinate_system" && b.directions != "specular_coordinate_system")
      refuse(fmt::format("unknown PARAM_TYPE '{}'", b.directions), "spherical_ or specular_coordinate_system");
    if (scatter && b.colour != "monochrome" && b.colour != "spectrum")
      refuse(fmt::format("colours ('{}'), not scatter at one wavelength", b.colour),
             "export monochrome or spectrum data");
    if (b.colour == "spectrum" && b.wavelengths.empty()) refuse("WAVELENGTH_LIST is missing", "add it");
  }

  void table(Block const& b) {
    std::size_t const colours = b.colour == "spectrum" ? b.wavelengths.size() : b.colour == "monochrome" ? 1 : 3;
    bool const scatter = b.type == "brdf" || b.type == "btdf";
    std::size_t const chosen = scatter ? channel(b) : 0;
    if (scatter && found_) return in_.refuse(b.where, "a second BSDF in the file", "keep one of them");
    found_ = found_ || scatter;
    std::size_t const rows = b.size(0) * b.size(1) * (scatter ? b.size(2) * b.size(3) : 1);
    for (std::size_t i = 0; i < rows && in_.sound; ++i)
      for (std::size_t c = 0; c < colours && in_.sound; ++c) {
        TextCell const where = in_.peek();
        double const value = in_.number(fmt::format("value {} of {}", i * colours + c + 1, rows * colours));
        if (in_.sound && scatter && c == chosen) keep(b, i, value, where);
      }
    if (!in_.sound || !scatter) return;
    file_.transmitted = b.type == "btdf";
    file_.notes.push_back(fmt::format("{}, {}: {} incidences x {} polar angles x {} azimuths", b.type, b.directions,
                                      b.size(0), b.size(2), b.size(3)));
  }

  std::size_t channel(Block const& b) {
    if (b.colour != "spectrum") return 0;
    double& asked = file_.declared.wavelength;
    for (std::size_t i = 0; i < b.wavelengths.size(); ++i) {
      double const wavelength = b.wavelengths[i] * 1e-9;
      if (asked > 0 ? std::fabs(wavelength / asked - 1) > 1e-3 : b.wavelengths.size() > 1) continue;
      asked = wavelength;
      return i;
    }
    in_.refuse(b.where, fmt::format("the file has {} wavelengths", b.wavelengths.size()),
               fmt::format("choose one by 'wavelength', in nm: {}", fmt::join(b.wavelengths, ", ")));
    return 0;
  }

  void keep(Block const& b, std::size_t i, double value, TextCell const& where) {
    std::size_t const n0 = b.size(0), n01 = n0 * b.size(1), i2 = i / n01 % b.size(2), i3 = i / (n01 * b.size(2));
    double const incidence = b.list[0][i % n0] * degree, polar = b.list[2][i2] * degree, turn = b.list[3][i3] * degree;
    if (!(incidence < pi / 2 - 1e-9)) return;
    double theta = polar,
           phi = turn + pi;  // spherical azimuths: the specular direction is opposite to the incident one
    if (b.directions == "specular_coordinate_system") {
      // About the specular direction, azimuth 0 away from the normal.
      double const centre = incidence + (b.list[4].empty() ? 0 : b.list[4][i % n0] * degree);
      double const away = std::sin(polar) * std::cos(turn), side = std::sin(polar) * std::sin(turn),
                   on = std::cos(polar);
      double const x = on * std::sin(centre) + away * std::cos(centre),
                   z = on * std::cos(centre) - away * std::sin(centre);
      theta = std::acos(std::clamp(z, -1.0, 1.0));
      phi = std::atan2(side, x);
    }
    if (!(theta < pi / 2 - 1e-9)) return;
    ScatterPoint p = scatter_point(incidence, theta, phi, value);
    p.line = where.line;
    p.column = where.column;
    file_.points.push_back(p);
  }

  WordReader in_;
  ScatterFile& file_;
  bool found_ = false;
};

}  // namespace

void read_ssdd(std::string_view text, ScatterFile& file, std::vector<Problem>& problems) {
  SsddReader(text, file, problems).read();
}

// SSDD in the specular coordinate system. Data in the plane of incidence are written at the union of their angles, each
// measured value at its own place and the others between their neighbours; data on a grid unchanged.

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
  bool const plane = std::ranges::all_of(g.azimuth, [](double a) { return a == 0 || a == 180; });
  if (!plane && g.azimuth.size() > 361) {
    why = fmt::format("the directions do not form a grid about the specular direction: {} azimuths", g.azimuth.size());
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

}  // namespace straytrace::world
