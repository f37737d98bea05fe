// SPDX-License-Identifier: BSD-3-Clause
// Zemax ABg catalogues: entries of a name, a wavelength and rows of incidence, A, B, g (physics.md eq. 3.16).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.hpp"
#include "base/csv_cells.hpp"
#include "base/document.hpp"
#include "base/table.hpp"
#include "world/degree.hpp"
#include "world/measured/scatter_file.hpp"
#include "world/measured/text_tokens.hpp"

namespace straytrace {
namespace {

struct Row {
  double theta_i, a, b, g;  // rad, 1/sr, 1, 1
  Token where;
};
struct Entry {
  std::string name;
  double wavelength = 0;  // m
  std::vector<Row> rows;
  Token where;
};

class CatalogueReader {
 public:
  explicit CatalogueReader(std::vector<Problem>& problems) : problems_(problems) {}
  std::vector<Entry> entries;

  void line(TextLine const& line) {
    auto const words = words_of(line);
    std::string_view const key = words[0].text;
    if (key == "NAME") return name(line, words);
    if (entries.empty()) return complain(problems_, words[0], "numbers before any 'NAME'", "begin with 'NAME paint'");
    if (key == "WAVE" || key == "WAVELENGTH") return wave(words);
    bool const data = key == "DATA";
    if (!data && !is_number(key) && !has_digit(key))
      return complain(problems_, words[0], fmt::format("unknown keyword '{}'", key), "known: NAME, WAVE, DATA");
    row({words.begin() + (data ? 1 : 0), words.end()}, words[0]);
  }

 private:
  static bool has_digit(std::string_view s) { return s.find_first_of("0123456789") != s.npos; }
  void name(TextLine const& line, std::vector<Token> const& words) {
    if (words.size() < 2)
      return complain(problems_, words[0], "'NAME' without a name", "write for example 'NAME paint'");
    Entry e;
    e.name = without_blanks(line.text.substr(line.text.find("NAME") + 4));
    e.where = words[1];
    for (Entry const& other : entries)
      if (other.name == e.name)
        complain(problems_, words[1], fmt::format("entry '{}' is there twice", e.name), "choose another name");
    entries.push_back(e);
  }
  void wave(std::vector<Token> const& words) {
    auto const um = words.size() == 2 ? csv_number(words[1].text, {1, dim::plain, {}}) : std::nullopt;
    if (!um || *um < 0 || *um > 1000)
      return complain(problems_, words.back(), "'WAVE' needs the wavelength in micrometres",
                      "write for example 'WAVE 1.064'");
    entries.back().wavelength = *um * 1e-6;
  }
  void row(std::vector<Token> const& words, Token const& first) {
    static constexpr char const* what[] = {"the angle of incidence in deg", "A", "B", "g"};
    if (words.size() != 4)
      return complain(problems_, first, fmt::format("{} numbers in a row", words.size()),
                      "write four: angle of incidence in deg, A, B, g");
    double x[4] = {};
    for (std::size_t i = 0; i < 4; ++i) {
      auto const value = csv_number(words[i].text, {1, dim::plain, {}});
      if (!value) return complain_of_number(problems_, words[i], what[i]);
      x[i] = *value;
      bool const fits = i == 0 ? x[0] >= 0 && x[0] < 90 : x[i] >= 0;
      if (!fits)
        return complain(problems_, words[i], fmt::format("{} is {:g}", what[i], x[i]),
                        i == 0 ? "give 0 to below 90 deg" : "it is not negative");
    }
    if (x[2] == 0 && x[3] >= 2)
      return complain(problems_, words[2], fmt::format("B = 0 with g = {:g}: an infinite total", x[3]),
                      "give B above 0");
    entries.back().rows.push_back({x[0] * degree, x[1], x[2], x[3], words[1]});
  }
  std::vector<Problem>& problems_;
};

Entry const* chosen(std::vector<Entry> const& all, std::string const& wanted, std::vector<Problem>& problems) {
  std::vector<std::string> names;
  for (Entry const& e : all) {
    if (e.name == wanted || (wanted.empty() && all.size() == 1)) return &e;
    names.push_back(e.name);
  }
  std::string const near = nearest_word(wanted, names);
  complain(problems, {},
           wanted.empty() ? fmt::format("the catalogue has {} entries", all.size())
                          : fmt::format("the catalogue has no entry '{}'", wanted),
           !near.empty() ? fmt::format("did you mean '{}'?", near)
                         : fmt::format("say which: entry (--entry in a command): {}", fmt::join(names, ", ")));
  return nullptr;
}

}  // namespace

void read_abg_catalogue(std::string_view text, ScatterFile& file, std::vector<Problem>& problems) {
  std::size_t const before = problems.size();
  CatalogueReader reader(problems);
  for (TextLine const& line : lines_of(text)) reader.line(line);
  if (problems.size() > before) return;
  Entry const* const e = chosen(reader.entries, file.declared.entry, problems);
  if (!e) return;
  if (e->rows.empty()) return complain(problems, e->where, fmt::format("entry '{}' has no row", e->name), "add one");
  if (e->wavelength > 0) file.declared.wavelength = e->wavelength;
  for (Row const& r : e->rows) {
    for (int i = 0; i <= 320; ++i) {  // a formula has no points: as dense as the table that is made of it
      ScatterPoint p;
      p.theta_i = r.theta_i;
      p.theta_s = p.phi = std::numeric_limits<double>::quiet_NaN();
      p.offset = 1e-6 * std::pow(1.999e6, i / 320.0);
      p.value = r.a / (r.b + std::pow(p.offset, r.g));
      p.line = r.where.line;
      p.column = r.where.column;
      file.points.push_back(p);
    }
    file.notes.push_back(fmt::format("{:g} deg: A = {:g} /sr, B = {:g}, g = {:g}", r.theta_i / degree, r.a, r.b, r.g));
  }
  file.notes.push_back(fmt::format("entry '{}' of {}; formulas, not measured points: beyond its rows the nearest holds",
                                   e->name, reader.entries.size()));
}

}  // namespace straytrace
