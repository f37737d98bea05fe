// SPDX-License-Identifier: BSD-3-Clause
// Laboratory CSV: the declarations '# key: value' and the columns.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "io/delimited_text.hpp"
#include "world/scatter_data/scatter_file.hpp"

namespace straytrace::world {
namespace {

// "1064 nm" of this dimension.
std::optional<double> quantity(std::string_view text, Dimension dimension) {
  std::size_t const end = text.find_first_of(" \t");
  if (end == text.npos || !is_number(text.substr(0, end))) return {};
  std::string_view const rest = without_blanks(text.substr(end));
  auto unit = parse_unit(rest);
  if (auto const leading = leading_unit(rest); !unit && leading && leading->length == rest.size()) unit = leading->unit;
  if (!unit || unit->dimension != dimension) return {};
  return number_in(text.substr(0, end), *unit);
}

class Declarations {
 public:
  explicit Declarations(std::vector<Problem>& problems) : problems_(problems) {}
  ScatterDeclared out;

  void line(std::string_view text, std::uint32_t number) {
    std::size_t const colon = text.find(':');
    if (!text.starts_with('#') || colon == text.npos) return;
    std::string const key(without_blanks(text.substr(1, colon - 1)));
    if (key.empty() || key.find(' ') != key.npos) return;
    std::string_view value = text.substr(colon + 1);
    value = without_blanks(value.substr(0, value.find('(')));
    where_ = {key, number, std::uint32_t(text.find(key)) + 1};
    std::vector<std::string> const known{"wavelength",       "angles",      "polarisation_in",
                                         "polarisation_out", "noise_floor", "theta_i"};
    if (std::ranges::find(known, key) != known.end()) return declare_once(key, std::string(value));
    if (std::string const near = nearest_word(key, known); !near.empty())
      complain(problems_, where_, fmt::format("unknown declaration '{}'", key),
               fmt::format("did you mean '{}'?", near));
  }

 private:
  void declare_once(std::string const& key, std::string const& value) {
    auto const [first, fresh] = declared_.try_emplace(key, value, where_.line);
    if (fresh) return declare(key, value);
    auto const& [other, line] = first->second;
    if (other != value)
      complain(problems_, where_,
               fmt::format("'{}' is '{}' here and '{}' in line {}", key, shortened(value), shortened(other), line),
               "keep one of them");
  }
  void declare(std::string const& key, std::string const& value) {
    if (key == "wavelength") number(value, dim::length, 1e-8, 1e-3, "1064 nm", out.wavelength);
    if (key == "theta_i") number(value, dim::angle, 0, 89.99 * degree, "5 deg", out.theta_i);
    if (key == "noise_floor" && value == "none")
      out.noise_floor = 0;
    else if (key == "noise_floor")
      number(value, dim::brdf, 0, 1e9, "1e-7 /sr' or 'none", out.noise_floor);
    if (key == "angles") word(value, {"from_normal", "from_specular"}, out.angles);
    if (key == "polarisation_in") word(value, {"s", "p", "unpolarised"}, out.polarisation_in);
    if (key == "polarisation_out") word(value, {"s", "p", "both"}, out.polarisation_out);
  }
  void number(std::string const& text, Dimension dimension, double low, double high, char const* example,
              double& into) {
    auto const value = quantity(text, dimension);
    bool const good = value && *value >= low && *value <= high;
    into = good ? *value : not_a_number;
    if (!good)
      complain(problems_, where_, fmt::format("'{}' cannot be '{}'", where_.text, shortened(text)),
               fmt::format("write '# {}: {}'", where_.text, example));
  }
  void word(std::string const& text, std::vector<std::string> const& choices, std::string& into) {
    if (std::ranges::find(choices, text) != choices.end()) {
      into = text;
      return;
    }
    complain(problems_, where_, fmt::format("'{}' is not one of {}", shortened(text), fmt::join(choices, ", ")),
             fmt::format("write '# {}: {}'", where_.text, choices[0]));
  }
  std::vector<Problem>& problems_;
  std::map<std::string, std::pair<std::string, std::uint32_t>> declared_;  // values and lines
  TextCell where_;
};

class Columns {
 public:
  Columns(ScatterFile& file, std::vector<Problem>& problems) : file_(file), problems_(problems) {}

  void read(std::string_view text) {
    table_ = parse_csv_table(text, Comments::anywhere, "theta_i [deg], theta_s [deg], brdf [1/sr]", problems_);
    if (table_.columns.empty() || !columns_fit()) return;
    std::size_t const before = problems_.size();
    for (CsvTable::Row const& row : table_.rows)
      if (problems_.size() < before + 10) point(row);
    if (problems_.size() == before) note();
  }

 private:
  bool there(char const* column) const { return table_.find(column) >= 0; }
  double value(CsvTable::Row const& row, char const* column) const {
    return there(column) ? row.values[std::size_t(table_.find(column))] : 0;
  }
  double unit_of(char const* column) const { return table_.columns[std::size_t(table_.find(column))].unit.si; }  // SI
  std::uint32_t at(CsvTable::Row const& row, char const* column) const {
    return there(column) ? row.cells[std::size_t(table_.find(column))].column : 1;
  }
  bool problem(std::uint32_t line, std::uint32_t column, std::string what, std::string suggestion) {
    complain(problems_, {" ", line, column}, std::move(what), std::move(suggestion));
    return false;
  }

  bool column_fits(CsvTable::Column const& c) {
    static constexpr std::string_view known[] = {"theta_i", "theta_s", "phi", "offset", "brdf", "brdf_cos", "error"};
    if (std::find(std::begin(known), std::end(known), c.name) == std::end(known))
      return problem(c.line, c.at, fmt::format("unknown column '{}'", c.name),
                     fmt::format("known columns: {}", fmt::join(known, ", ")));
    bool const angle = c.name == "theta_i" || c.name == "theta_s" || c.name == "phi", offset = c.name == "offset";
    Dimension const wanted = angle ? dim::angle : offset ? dim::plain : dim::brdf;
    if (c.unit.dimension == wanted) return true;
    return problem(c.line, c.at, wrong_unit(c, wanted),
                   fmt::format("write '{}{}'", c.name,
                               angle    ? " [deg]"
                               : offset ? ""
                                        : " [1/sr]"));
  }

  bool columns_fit() {
    bool sound = true;
    for (CsvTable::Column const& c : table_.columns) sound &= column_fits(c);
    if (!sound) return false;
    std::uint32_t const line = table_.columns.front().line;
    if (there("brdf") == there("brdf_cos"))
      return problem(line, 1, "the values must be either 'brdf' or 'brdf_cos'",
                     "'brdf_cos' is BRDF times cos(theta_s)");
    if (there("offset") == there("theta_s") || (there("phi") && !there("theta_s")))
      return problem(line, 1, "the direction of scatter must be 'offset', or 'theta_s' with or without 'phi'",
                     "offset = |alpha - alpha_0| in direction cosines");
    if (there("theta_i") == (file_.declared.theta_i >= 0))
      return problem(
          line, 1,
          there("theta_i") ? "the incidence is both a column and declared" : "the angle of incidence is missing",
          "add a column 'theta_i [deg]', or '# theta_i: 5 deg' for all of them");
    if (there("offset") && there("brdf_cos"))
      return problem(line, 1, "'brdf_cos' needs the angle of scatter, not an offset", "divide by the cosine first");
    return true;
  }

  bool point(CsvTable::Row const& row) {
    double const incidence = there("theta_i") ? value(row, "theta_i") : file_.declared.theta_i;
    if (!(incidence >= 0 && incidence < pi / 2))
      return problem(row.line(), at(row, "theta_i"), fmt::format("incidence of {:g} deg", incidence / degree),
                     there("theta_i") && incidence < 90 && unit_of("theta_i") == 1
                         ? "give 0 to below 90 deg; if the numbers are degrees, write 'theta_i [deg]' into the header"
                         : "give 0 to below 90 deg");
    bool const from_specular = file_.declared.angles == "from_specular";
    double const scatter = value(row, "theta_s") + (from_specular ? incidence : 0), phi = value(row, "phi");
    if (!(std::fabs(scatter) < pi / 2))
      return problem(row.line(), at(row, "theta_s"),
                     fmt::format("scatter at {:g} deg from the normal", scatter / degree),
                     "remove directions below the surface; check 'angles'");
    char const* const column = there("brdf") ? "brdf" : "brdf_cos";
    double const cosine = there("brdf") ? 1 : std::cos(scatter);
    ScatterPoint p = scatter_point(incidence, scatter, phi, value(row, column) / cosine);
    if (there("offset")) {
      p.offset = value(row, "offset");
      p.theta_s = p.phi = std::numeric_limits<double>::quiet_NaN();
    }
    if (!(p.offset >= 0 && p.offset < 2))
      return problem(row.line(), at(row, "offset"), fmt::format("offset {:g}", p.offset), "give 0 to below 2");
    p.error = value(row, "error") / cosine;
    if (p.error < 0)
      return problem(row.line(), at(row, "error"), fmt::format("error {:g} /sr", p.error), "give one standard error");
    p.line = row.line();
    p.column = at(row, column);
    file_.points.push_back(p);
    return true;
  }

  void note() {
    file_.notes.push_back(
        fmt::format("columns {}; {}{}", fmt::join(names(), ", "),
                    there("brdf_cos") ? "values divided by cos(theta_s)" : "values are BSDF, without the cosine",
                    there("offset") ? ""
                    : file_.declared.angles == "from_specular"
                        ? "; theta_s from the specular direction, positive away from the normal"
                        : "; theta_s from the normal, positive on the side of the specular direction"));
  }
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (CsvTable::Column const& c : table_.columns) out.push_back(c.name);
    return out;
  }

  ScatterFile& file_;
  std::vector<Problem>& problems_;
  CsvTable table_;
};

}  // namespace

ScatterDeclared read_declarations(std::string_view text, std::vector<Problem>& problems) {
  Declarations all(problems);
  for (TextLine const& line : text_lines(text, Comments::kept)) all.line(without_blanks(line.text), line.number);
  return all.out;
}

void read_scatter_columns(std::string_view text, ScatterFile& file, std::vector<Problem>& problems) {
  Columns(file, problems).read(text);
}

}  // namespace straytrace::world
