// SPDX-License-Identifier: BSD-3-Clause
// Text after ASTM E1392 and E2387: keywords, a line VARS with the names of the columns, rows. Angles are spherical, of
// both directions about the normal, in radian unless the names of the columns state a unit.
#include <fmt/format.h>

#include <cmath>

#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/text/words.hpp"
#include "io/delimited_text.hpp"
#include "world/scatter_data/scatter_file.hpp"

namespace straytrace::world {
namespace {

class AstmReader {
 public:
  AstmReader(ScatterFile& file, std::vector<Problem>& problems) : file_(file), problems_(problems) {}

  void read(std::string_view text) {
    std::size_t const before = problems_.size();
    for (TextLine const& line : text_lines(text, Comments::anywhere)) {
      if (problems_.size() >= before + 10) return;
      started_ ? row(line) : header(line);
      if (!started_ && problems_.size() > before) return;
    }
    if (!started_)
      return complain(problems_, {}, "keyword 'VARS' is missing",
                      "name the columns: VARS theta_i,phi_i,theta_s,phi_s,1064nm");
    if (expected_ >= 0 && double(rows_) != expected_)
      complain(problems_, {}, fmt::format("NUM_POINTS is {:g}, but the file has {} rows", expected_, rows_),
               "the file is cut off, or NUM_POINTS is wrong");
    file_.notes.push_back(fmt::format("column '{}' of {}; angles in {}, spherical about the normal", name_, channels_,
                                      unit_[0].si == 1 ? "radian" : "degrees"));
  }

 private:
  void header(TextLine const& line) {
    auto const words = words_of(line);
    if (words[0].text == "NUM_POINTS") {
      auto const count = words.size() > 1 ? number_in(words[1].text) : std::nullopt;
      if (!count) return complain_of_number(problems_, words.back(), "the number of points");
      expected_ = *count;
    }
    if (words[0].text != "VARS") return;
    std::size_t const at = line.text.find("VARS") + 4;
    auto cells = comma_cells({line.text.substr(at), line.number});
    for (TextCell& c : cells) c.column += std::uint32_t(at);
    started_ = columns(cells);
  }

  // The channel: the only one, or the one at the requested wavelength.
  bool columns(std::vector<TextCell> const& cells) {
    TextCell const& first = cells[0];
    auto const refuse = [&](std::string what, std::string suggestion) {
      complain(problems_, first, std::move(what), std::move(suggestion));
      return false;
    };
    if (cells.size() < 5)
      return refuse(counted(cells.size(), "column"), "write VARS theta_i,phi_i,theta_s,phi_s,1064nm");
    for (std::size_t i = 0; i < 4; ++i) {
      auto const name = column_title(cells[i].text);
      if (!name)
        return refuse(fmt::format("cannot read the name '{}'", shortened(cells[i].text)), "write theta_i [deg]");
      unit_[i] = name->unit.dimension == dim::angle ? name->unit : Quantity{1, dim::angle, {}};
    }
    channels_ = cells.size() - 4;
    std::string known;
    for (std::size_t i = 4; i < cells.size(); ++i) {
      double const wavelength = nanometres(cells[i].text) * 1e-9;
      known += (known.empty() ? "" : ", ") + std::string(cells[i].text);
      double const asked = file_.declared.wavelength;
      if (channels_ > 1 && !(asked > 0 && std::fabs(wavelength / asked - 1) < 1e-3)) continue;
      if (wavelength > 0 && asked > 0 && std::fabs(wavelength / asked - 1) > 1e-3)
        return refuse(fmt::format("the file is at {:g} nm, but {:g} nm is requested", wavelength * 1e9, asked * 1e9),
                      "give the wavelength of the file, or remove it");
      if (wavelength > 0) file_.declared.wavelength = wavelength;
      channel_ = i;
      name_ = cells[i].text;
    }
    width_ = cells.size();
    if (channel_ == 0)
      return refuse(fmt::format("the file has {} channels", channels_), "choose one by 'wavelength': " + known);
    return true;
  }
  static double nanometres(std::string_view name) {
    if (!name.ends_with("nm")) return 0;
    return number_in(without_blanks(name.substr(0, name.size() - 2))).value_or(0);
  }

  void row(TextLine const& line) {
    auto cells = comma_cells(line);
    ++rows_;
    if (cells.size() != width_)
      return complain(problems_, {line.text.substr(0, 1), line.number, 1},
                      fmt::format("{} values, but VARS names {}", cells.size(), width_),
                      cells.size() > width_ ? surplus_remedy(cells) : "give one value per name, separated by commas");
    double x[5] = {};
    bool sound = true;
    for (std::size_t i = 0; i < 5; ++i) {
      TextCell const& c = cells[i < 4 ? i : channel_];
      auto const value = number_in(c.text, i < 4 ? unit_[i] : Quantity{1, dim::plain, {}});
      x[i] = value.value_or(0);
      if (!value)
        complain_of_number(problems_, c, i < 4 ? "an angle" : "the BSDF in 1/sr");
      else if ((i == 0 || i == 2) && !(std::fabs(x[i]) <= pi / 2 + 1e-6))
        complain(problems_, c, fmt::format("a polar angle of {:g} rad", x[i]),
                 "angles are in radian; for degrees name the columns 'theta_i [deg]' and so on");
      else
        continue;
      sound = false;
    }
    if (!sound) return;
    if (!(std::fabs(x[0]) < pi / 2 - 1e-6) || !(std::fabs(x[2]) < pi / 2 - 1e-6)) return;  // grazing: no cosine
    // Spherical azimuths: the specular direction is opposite to the incident one.
    double const phi = x[3] - x[1] - pi;
    ScatterPoint p = scatter_point(x[0], x[2], std::remainder(phi, 2 * pi), x[4]);
    p.line = line.number;
    p.column = cells[channel_].column;
    file_.points.push_back(p);
  }

  ScatterFile& file_;
  std::vector<Problem>& problems_;
  bool started_ = false;
  double expected_ = -1;
  std::size_t rows_ = 0, channels_ = 0, channel_ = 0, width_ = 0;
  Quantity unit_[4];
  std::string name_;
};

}  // namespace

void read_astm(std::string_view text, ScatterFile& file, std::vector<Problem>& problems) {
  AstmReader(file, problems).read(text);
}

}  // namespace straytrace::world
