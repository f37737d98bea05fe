// SPDX-License-Identifier: BSD-3-Clause
// SSDD 0.2 (surface scattering distribution data): blocks of tables over lists of angles. The BRDF or BTDF is read.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "base/vec3.hpp"
#include "world/degree.hpp"
#include "world/measured/scatter_file.hpp"
#include "world/measured/text_tokens.hpp"

namespace straytrace {
namespace {

struct Block {
  std::string type, colour, directions;
  std::array<std::vector<double>, 5> list;  // deg
  std::vector<double> wavelengths;          // nm
  bool ascii = true;
  Token where;

  std::size_t size(std::size_t i) const { return std::max<std::size_t>(1, list[i].size()); }
};

class SsddReader {
 public:
  SsddReader(std::string_view text, ScatterFile& file, std::vector<Problem>& problems)
      : in_(text, problems), file_(file) {}

  void read() {
    while (in_.sound && !in_.done()) {
      Token const key = in_.next();
      if (key.text == "DATA_TYPE")
        block(key);
      else if (!is_header(key.text))
        in_.refuse(key, fmt::format("unknown keyword '{}'", key.text),
                   "known: VERSION, SOFTWARE, API, DATE, DATA_TYPE");
      else
        in_.rest_of_line(key);
    }
    if (in_.sound && !found_)
      in_.refuse({}, "the file holds no BRDF or BTDF", "only specular shares: give them to 'specular' of the material");
  }

 private:
  static bool is_header(std::string_view word) {
    return word == "VERSION" || word == "SOFTWARE" || word == "API" || word == "DATE";
  }

  void block(Token const& first) {
    Block b;
    b.where = first;
    b.type = word(first);
    while (in_.sound) {
      Token const key = in_.next();
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

  std::string word(Token const& key) {
    auto const words = in_.rest_of_line(key);
    if (words.empty()) in_.refuse(key, fmt::format("'{}' says nothing", key.text), "write its value behind it");
    return words.empty() ? "" : std::string(words[0].text);
  }

  void entry(Token const& key, Block& b) {
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
    else if (std::find(std::begin(others), std::end(others), k) != std::end(others))
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
      refuse("several azimuths of incidence: the surface has a direction, the law 'table' has none",
             "keep one azimuth, or describe grooves by the law 'grooves'");
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
        Token const where = in_.peek();
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

  void keep(Block const& b, std::size_t i, double value, Token const& where) {
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

  TokenReader in_;
  ScatterFile& file_;
  bool found_ = false;
};

}  // namespace

void read_ssdd(std::string_view text, ScatterFile& file, std::vector<Problem>& problems) {
  SsddReader(text, file, problems).read();
}

}  // namespace straytrace
