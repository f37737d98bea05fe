// SPDX-License-Identifier: BSD-3-Clause
#include "world/scatter_data/scatter_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/text/words.hpp"
#include "io/delimited_text.hpp"

namespace straytrace::world {
namespace {

constexpr std::string_view columns = "laboratory CSV";

// The beginning of a file, by which its format is recognised.
struct Head {
  std::string_view text;
  std::set<std::string_view> first_words;  // of its lines
  std::string_view first_line;

  explicit Head(std::string_view all) : text(all) {
    for (TextLine const& line : text_lines(all.substr(0, 65536), Comments::anywhere)) {
      if (first_words.empty()) first_line = line.text;
      first_words.insert(words_of(line)[0].text);
    }
  }
  bool has(std::string_view word) const { return first_words.contains(word); }
};

struct Format {
  std::string_view name;
  bool (*matches)(Head const&);
  void (*read)(std::string_view text, ScatterFile&, std::vector<Problem>&);  // null: recognised, not supported
  std::string_view what = {}, suggestion = {};                               // of a format that is not supported
};
// In the order in which they are tried. A new format: its reader in a file of its own, declared in scatter_file.hpp,
// and a line here.
constexpr Format formats[] = {
    {"RGL binary BSDF", [](Head const& h) { return h.text.starts_with("tensor_file"); }, nullptr,
     "an RGL binary BSDF: visible light (360 to 1000 nm) on an adaptive grid, without the steep lobe of a mirror",
     "evaluate it with the library of its authors at the directions you need and write those as laboratory CSV"},
    {"binary file", [](Head const& h) { return is_binary(h.text); }, nullptr, "a binary file of no known format",
     "export it as text: laboratory CSV, Zemax tabular BSDF, ASTM or SSDD"},
    {"SSDD", [](Head const& h) { return h.has("DATA_TYPE") || (h.has("VERSION") && h.has("COLOR_MODEL")); }, read_ssdd},
    {"Zemax tabular BSDF",
     [](Head const& h) {
       return h.has("SampleRotation") || h.has("ScatterAzimuth") || h.has("ScatterRadial") ||
              (h.has("Symmetry") && h.has("SpectralContent") && !h.has("AOI"));
     },
     read_zemax_table},
    {"LightTools BSDF", [](Head const& h) { return h.has("Symmetry") && h.has("SpectralContent"); }, nullptr,
     "a LightTools BSDF: angles by side and quadrant, which this program does not read",
     "export it as tabular Zemax BSDF, or write laboratory CSV"},
    {"ASTM E1392/E2387 text", [](Head const& h) { return h.has("VARS"); }, read_astm},
    {"Zemax ABg catalogue", [](Head const& h) { return h.has("NAME") && (h.has("WAVE") || h.has("WAVELENGTH")); },
     read_abg_catalogue},
    {columns,
     [](Head const& h) {
       return h.first_line.find("theta") != h.text.npos || h.first_line.find("brdf") != h.text.npos ||
              h.first_line.find("bsdf") != h.text.npos;
     },
     read_scatter_columns}};

Format const* known_format(std::string_view text) {
  Head const head(text);
  for (Format const& format : formats)
    if (format.matches(head)) return &format;
  return nullptr;
}

void adopt(ScatterFile& file, ScatterDeclared const& given, std::vector<Problem>& problems) {
  ScatterDeclared& d = file.declared;
  auto const differ = [&](std::string_view key, std::string const& in_file, std::string const& said) {
    complain(problems, {}, fmt::format("the file declares {} {}, but {} is requested", key, in_file, said),
             "keep one of them");
  };
  if (d.wavelength > 0 && given.wavelength > 0 && std::fabs(d.wavelength / given.wavelength - 1) > 1e-3)
    differ("wavelength", fmt::format("{:g} nm", d.wavelength * 1e9), fmt::format("{:g} nm", given.wavelength * 1e9));
  if (!d.angles.empty() && !given.angles.empty() && d.angles != given.angles) differ("angles", d.angles, given.angles);
  if (d.wavelength == 0) d.wavelength = given.wavelength;
  if (d.angles.empty()) d.angles = given.angles;
  d.entry = given.entry;
}

constexpr std::string_view layout =
    "# wavelength: 1064 nm\n"
    "    # angles: from_normal          (or from_specular)\n"
    "    # polarisation_in: s           (s, p or unpolarised)\n"
    "    # polarisation_out: both       (s, p or both)\n"
    "    # noise_floor: 1e-7 /sr        (or none)\n"
    "    theta_i [deg], theta_s [deg], brdf [1/sr]";

void demand(ScatterFile const& file, std::vector<Problem>& problems) {
  std::string missing;
  if (file.declared.wavelength == 0) missing = "wavelength";
  bool const text = file.format == columns;
  bool const turned = std::ranges::any_of(file.points, [](auto const& p) { return p.theta_s == p.theta_s; });
  if (text && turned && file.declared.angles.empty()) missing += missing.empty() ? "angles" : " and angles";
  if (missing.empty()) return;
  complain(problems, {}, fmt::format("the file does not declare {} of the measurement", missing),
           text ? fmt::format("begin the file with declarations such as:\n    {}", layout)
                : "write 'wavelength: 1064 nm' into the table, --wavelength \"1064 nm\" in the command, or '# "
                  "wavelength: 1064 nm' into the file");
}

void mark_limits(ScatterFile& file, std::vector<Problem>& problems) {
  std::size_t said = 0;
  for (ScatterPoint& p : file.points) {
    double const floor = file.declared.noise_floor;
    if (p.value < 0 && ++said <= 10)
      complain(problems, {" ", p.line, p.column},
               p.theta_s == p.theta_s ? fmt::format("BRDF {:g} /sr at {:g} deg", p.value, p.theta_s * 180 / pi)
                                      : fmt::format("BRDF {:g} /sr at offset {:g}", p.value, p.offset),
               "a BSDF is not negative: remove the point, or write 0 and declare '# noise_floor: 1e-7 /sr'");
    if (p.value == 0 && !(floor > 0) && file.format == columns && ++said <= 10)
      complain(
          problems, {" ", p.line, p.column}, "BRDF 0 /sr and no noise floor",
          "declare the floor, '# noise_floor: 1e-7 /sr', so that it counts as an upper limit; or remove the point");
    p.limit = floor > 0 && p.value <= floor;
    if (p.limit) p.value = floor;
  }
  if (file.format != columns) std::erase_if(file.points, [](ScatterPoint const& p) { return p.value == 0; });
}

// At most as many incidences as the BSDF model allows, evenly spaced in order, including the first and the last.
void thin(ScatterFile& file) {
  auto const groups = by_incidence(file.points);
  constexpr std::size_t most = Measured::most_incidences;
  if (groups.size() <= most) return;
  file.points.clear();
  for (std::size_t i = 0; i < most; ++i) {
    auto const& group = groups[(i * (groups.size() - 1) + (most - 1) / 2) / (most - 1)];
    file.points.insert(file.points.end(), group.begin(), group.end());
  }
  file.incidences_left_out = groups.size() - most;
  file.notes.push_back(fmt::format("{} incidences, of which {} are used", groups.size(), most));
}

}  // namespace

ScatterPoint scatter_point(double theta_i, double theta_s, double phi, double value) {
  ScatterPoint p;
  p.theta_i = theta_i;
  p.theta_s = theta_s;
  p.phi = phi;
  p.value = value;
  p.offset = std::hypot(std::sin(theta_s) * std::cos(phi) - std::sin(theta_i), std::sin(theta_s) * std::sin(phi));
  return p;
}

std::vector<std::vector<ScatterPoint>> by_incidence(std::vector<ScatterPoint> const& points) {
  std::vector<std::vector<ScatterPoint>> out;
  for (ScatterPoint const& p : points) {
    auto const there = std::ranges::find_if(
        out, [&](auto const& group) { return std::fabs(std::sin(group[0].theta_i) - std::sin(p.theta_i)) < 1e-6; });
    if (there == out.end())
      out.push_back({p});
    else
      there->push_back(p);
  }
  std::ranges::sort(out, [](auto const& a, auto const& b) { return a[0].theta_i < b[0].theta_i; });
  return out;
}

ScatterFile read_scatter_file(std::string_view written, ScatterDeclared const& given, std::vector<Problem>& problems) {
  std::string const text = with_plain_spaces(written);
  Format const* const format = known_format(text);
  ScatterFile file;
  if (!format) {
    complain(
        problems, {},
        text_lines(text, Comments::kept).empty() ? "the file is empty" : "unknown format of measured scatter",
        fmt::format("Zemax tabular BSDF, ABg catalogue, ASTM text, SSDD, or laboratory CSV, which begins with\n    {}",
                    layout));
    return file;
  }
  if (!format->read) {
    complain(problems, {}, fmt::format("this is {}", format->what), std::string(format->suggestion));
    return file;
  }
  file.format = format->name;
  std::size_t const before = problems.size();
  file.declared = read_declarations(text, problems);
  adopt(file, given, problems);
  format->read(text, file, problems);
  mark_limits(file, problems);
  thin(file);
  if (problems.size() == before && file.points.empty())
    complain(problems, {}, "the file has no point above the surface", "check its angles");
  if (problems.size() == before || !file.points.empty()) demand(file, problems);
  return file;
}

void check_scatter_points(std::vector<ScatterPoint> const& points, std::vector<Problem>& problems) {
  auto const groups = by_incidence(points);
  for (auto const& group : groups) {
    auto const [low, high] = std::minmax_element(group.begin(), group.end(),
                                                 [](auto const& a, auto const& b) { return a.offset < b.offset; });
    if (high->offset < 1.5 * low->offset || high->offset < 1e-6)
      complain(problems, {},
               fmt::format("the points at {:.4g} deg of incidence do not cover a range of angles",
                           group[0].theta_i * 180 / pi),
               "measure several angles of scatter for each incidence, or remove this one");
  }
}

Measured law_of_points(std::vector<ScatterPoint> const& points, std::string_view beyond, MeasuredSummary& summary) {
  std::vector<MeasuredPoint> all;
  for (ScatterPoint const& p : points) all.push_back({std::sin(p.theta_i), p.offset, p.value});
  Measured law;
  summary = fit_measured(law, all,
                         beyond == "constant" ? Beyond::constant
                         : beyond == "power"  ? Beyond::power
                                              : Beyond::zero);
  return law;
}

// Laboratory CSV: the declarations '# key: value' and the columns.

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
