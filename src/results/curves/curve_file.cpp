// SPDX-License-Identifier: BSD-3-Clause
#include "results/curves/curve_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "io/hdf5/read_write.hpp"
#include "io/markup.hpp"
#include "results/results.hpp"
#include "results/text/columns.hpp"
#include "results/text/picture.hpp"
#include "spectra/files/unit_text.hpp"

namespace straytrace::results {
namespace {

namespace fs = std::filesystem;

std::string drawn(std::string const& json) {
  std::string message;
  std::string png = picture_of(json, "curves", message);
  if (png.empty()) throw InputError(message, "or write .txt, .csv or .hdf5");
  return png;
}

template <class Sheet>
std::string bytes_of(std::string const& file, Sheet const& sheet) {
  std::string const ending = fs::path(file).extension().string();
  if (ending == ".txt") return curve_format::text(sheet);
  if (ending == ".csv") return curve_format::csv(sheet);
  if (ending == ".json") return curve_format::json(sheet);
  if (ending == ".hdf5" || ending == ".h5") return curve_format::hdf5(sheet, file);
  if (ending == ".png") return drawn(curve_format::json(sheet));
  check_curve_ending(file);
  return curve_format::html(sheet, drawn(curve_format::json(sheet)));
}

template <class Sheet>
void write_all(std::vector<std::string> const& files, Sheet const& sheet) {
  std::vector<std::pair<std::string, std::string>> contents;
  for (std::string const& file : files) contents.push_back({file, bytes_of(file, sheet)});
  write_files(contents);
}

}  // namespace

void check_ending(std::string const& file, std::vector<std::string> const& known, std::string const& option) {
  if (std::ranges::find(known, fs::path(file).extension().string()) != known.end()) return;
  throw InputError(fmt::format("{}{}'{}' does not have a known ending", option, option.empty() ? "" : ": ", file),
                   fmt::format("end it with {}{}", fmt::join(known.begin(), known.end() - 1, ", "),
                               known.size() > 1 ? " or " + known.back() : known.back()));
}

void check_curve_ending(std::string const& file, std::string const& option) {
  if (!file.ends_with(".h5")) check_ending(file, {".txt", ".csv", ".json", ".hdf5", ".png", ".html"}, option);
}

std::string curve_json(CurveSheet const& sheet) { return curve_format::json(sheet); }
std::string curve_json(MapSheet const& map) { return curve_format::json(map); }

void write_curves(std::vector<std::string> const& files, CurveSheet const& sheet) { write_all(files, sheet); }
void write_map(std::vector<std::string> const& files, MapSheet const& map) { write_all(files, map); }

}  // namespace straytrace::results

// Curves and maps as columns of text, CSV and JSON.
namespace straytrace::results::curve_format {
namespace {

using Json = nlohmann::ordered_json;

std::string number(double value) { return csv_number(std::isfinite(value), value); }

std::string with_unit(CurveColumn const& c) { return c.unit.empty() ? c.name : fmt::format("{} [{}]", c.name, c.unit); }

std::string one_word(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

std::string comments(std::string const& title, std::vector<std::string> const& notes) {
  std::string text = fmt::format("# {}\n", title);
  for (std::string const& note : notes) text += fmt::format("# {}\n", note);
  return text;
}

std::vector<CurveColumn const*> columns_of(CurveSheet const& sheet) {
  std::vector<CurveColumn const*> all{&sheet.x};
  for (CurveColumn const& c : sheet.y) all.push_back(&c);
  return all;
}

std::string rows(CurveSheet const& sheet, char separator) {
  std::string text;
  std::vector<CurveColumn const*> const columns = columns_of(sheet);
  for (std::size_t i = 0; i < sheet.x.values.size(); ++i)
    for (CurveColumn const* c : columns) {
      text += number(c->values[i]);
      text += c == columns.back() ? '\n' : separator;
    }
  return text;
}

// The map as rows time, frequency, value; lines over it are curves of their own and left to JSON and pictures.
CurveSheet long_form(MapSheet const& map) {
  CurveSheet sheet{map.title, map.notes, {"time", "s", {}},
                   false,     false,     {{"frequency", "Hz", {}}, {"value", map.unit, {}}}};
  for (std::size_t i = 0; i < map.time.size(); ++i)
    for (std::size_t k = 0; k < map.frequency.size(); ++k) {
      sheet.x.values.push_back(map.time[i]);
      sheet.y[0].values.push_back(map.frequency[k]);
      sheet.y[1].values.push_back(map.value[i * map.frequency.size() + k]);
    }
  return sheet;
}

Json numbers(std::vector<double> const& values) {
  Json list = Json::array();
  for (double const v : values) list.push_back(std::isfinite(v) ? Json(v) : Json());
  return list;
}

Json json_of(CurveColumn const& c) {
  return {{"name", c.name}, {"unit", c.unit}, {"style", c.style}, {"values", numbers(c.values)}};
}

}  // namespace

std::string text(CurveSheet const& sheet) {
  std::vector<std::string> names, words;
  for (CurveColumn const* c : columns_of(sheet)) {
    names.push_back(with_unit(*c));
    words.push_back(one_word(c->name));
  }
  return comments(sheet.title, sheet.notes) +
         fmt::format("# {}\n# {}\n", fmt::join(names, ", "), fmt::join(words, " ")) + rows(sheet, ' ');
}

std::string csv(CurveSheet const& sheet) {
  std::vector<std::string> names;
  for (CurveColumn const* c : columns_of(sheet)) names.push_back(csv_text(with_unit(*c)));
  return comments(sheet.title, sheet.notes) + fmt::format("{}\n", fmt::join(names, ",")) + rows(sheet, ',');
}

std::string json(CurveSheet const& sheet) {
  Json j{{"title", sheet.title},
         {"notes", sheet.notes},
         {"log_x", sheet.log_x},
         {"log_y", sheet.log_y},
         {"x", json_of(sheet.x)}};
  j["y"] = Json::array();
  for (CurveColumn const& c : sheet.y) j["y"].push_back(json_of(c));
  return json_text(j, 1) + "\n";
}

std::string text(MapSheet const& map) { return text(long_form(map)); }
std::string csv(MapSheet const& map) { return csv(long_form(map)); }

std::string json(MapSheet const& map) {
  Json j{{"title", map.title},
         {"notes", map.notes},
         {"unit", map.unit},
         {"time_s", map.time},
         {"frequency_Hz", map.frequency}};
  std::size_t const width = map.frequency.size();
  j["value"] = Json::array();
  for (std::size_t i = 0; i < map.time.size(); ++i) {
    auto const from = map.value.begin() + std::ptrdiff_t(i * width);
    j["value"].push_back(numbers({from, from + std::ptrdiff_t(width)}));
  }
  j["lines"] = Json::array();
  for (CurveColumn const& c : map.lines) j["lines"].push_back(json_of(c));
  j["line_time_s"] = map.line_time;
  return json_text(j) + "\n";
}

}  // namespace straytrace::results::curve_format

// Curves and maps for gwpy: TimeSeries, FrequencySeries and Spectrogram, all with regular axes.
namespace straytrace::results::curve_format {
namespace {

double regular_step_of(std::vector<double> const& axis, std::string const& name, std::string const& file) {
  if (double const step = regular_step(axis); step > 0) return step;
  std::string const stem = file.substr(0, file.rfind('.'));
  throw InputError(fmt::format("'{}': the axis '{}' is not regular, as gwpy files require", file, name),
                   fmt::format("write it as text: -o {}.txt", stem));
}

std::string free_path(std::string path, std::vector<std::string>& taken) {
  std::replace(path.begin(), path.end(), '/', '_');  // a slash would be a group
  if (path.empty()) path = "curve";
  while (std::find(taken.begin(), taken.end(), path) != taken.end()) path += "_";
  taken.push_back(path);
  return path;
}

void name(hdf5::Writer& writer, std::string const& path, std::string const& of) {
  writer.attribute(path, "name", of);
  writer.attribute(path, "channel", of);
}

void axis(hdf5::Writer& writer, std::string const& path, std::string const& letter, double start, double step,
          std::string const& unit) {
  writer.attribute(path, letter + "0", start);
  writer.attribute(path, "d" + letter, step);
  writer.attribute(path, letter + "unit", gwpy_unit(unit));
}

// On the root: gwpy takes every attribute of a dataset as an argument.
void notes(hdf5::Writer& writer, std::string const& title, std::vector<std::string> const& all) {
  writer.attribute("/", "title", title);
  if (!all.empty()) writer.attribute("/", "notes", fmt::format("{}", fmt::join(all, "\n")));
}

}  // namespace

double regular_step(std::vector<double> const& axis) {
  if (axis.size() < 2) return 0;
  double const step = (axis.back() - axis.front()) / double(axis.size() - 1);
  for (std::size_t i = 0; i < axis.size(); ++i)
    if (!(std::abs(axis[i] - axis[0] - double(i) * step) <= 1e-6 * step + 4e-16 * std::abs(axis[i]))) return 0;
  // GPS times are rounded to 0.2 us: an integer rate within this rounding is the intended one.
  double const rate = 1 / step, whole = std::round(rate);
  double const rounding = 5e-16 * std::abs(axis.back()) / (axis.back() - axis.front());
  return whole >= 1 && std::abs(rate / whole - 1) <= rounding ? 1 / whole : step;
}

std::string hdf5(CurveSheet const& sheet, std::string const& file) {
  double const step = regular_step_of(sheet.x.values, sheet.x.name, file);
  io::hdf5::Writer writer;
  std::vector<std::string> taken;
  for (CurveColumn const& c : sheet.y) {
    std::string const path = free_path(c.name, taken);
    writer.array(path, c.values, gwpy_unit(c.unit));
    axis(writer, path, "x", sheet.x.values.front(), step, sheet.x.unit);
    name(writer, path, c.name);
  }
  notes(writer, sheet.title, sheet.notes);
  return writer.bytes();
}

std::string hdf5(MapSheet const& map, std::string const& file) {
  double const step = regular_step_of(map.time, "time", file), df = regular_step_of(map.frequency, "frequency", file);
  io::hdf5::Writer writer;
  writer.array("spectrogram", map.value, gwpy_unit(map.unit), {map.time.size(), map.frequency.size()});
  axis(writer, "spectrogram", "x", map.time.front() - step / 2, step,
       "s");  // gwpy counts from the beginning of a stride
  axis(writer, "spectrogram", "y", map.frequency.front(), df, "Hz");
  name(writer, "spectrogram", "spectrogram");
  notes(writer, map.title, map.notes);
  return writer.bytes();
}

}  // namespace straytrace::results::curve_format

// Curves and maps as one self-contained page.
namespace straytrace::results::curve_format {
namespace {

constexpr std::size_t most_rows = 2000;  // keeps browsers responsive; the numbers are complete in the other formats

std::string head(std::string const& title, std::vector<std::string> const& notes, std::string const& png) {
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>\n<style>body{{font-family:"
      "sans-serif;max-width:70em;margin:1em auto;padding:0 1em}}img{{max-width:100%}}table{{border-collapse:collapse;"
      "font-size:85%}}td,th{{padding:.1em .8em;text-align:right;border-bottom:1px solid "
      "#ddd}}</style></head>\n<body><h1>"
      "{0}</h1>\n",
      escaped(title));
  page += fmt::format("<p><img alt=\"{}\" src=\"data:image/png;base64,{}\"></p>\n<ul>\n", escaped(title),
                      base64(png.data(), png.size()));
  for (std::string const& note : notes) page += fmt::format("<li>{}</li>\n", escaped(note));
  return page + "</ul>\n";
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "not known"; }

std::string title_of(std::string const& name, std::string const& unit) {
  return unit.empty() || unit == "1" ? escaped(name) : fmt::format("{} [{}]", escaped(name), escaped(unit));
}

std::string table(CurveSheet const& sheet) {
  std::size_t const rows = sheet.x.values.size(), every = rows > most_rows ? (rows + most_rows - 1) / most_rows : 1;
  std::string out = every > 1 ? fmt::format("<p>One row of {}; the other formats have all {}.</p>\n", every, rows) : "";
  out += fmt::format("<table><tr><th>{}</th>", title_of(sheet.x.name, sheet.x.unit));
  for (CurveColumn const& c : sheet.y) out += fmt::format("<th>{}</th>", title_of(c.name, c.unit));
  out += "</tr>\n";
  for (std::size_t i = 0; i < rows; i += every) {
    out += fmt::format("<tr><td>{:.14g}</td>", sheet.x.values[i]);
    for (CurveColumn const& c : sheet.y) out += fmt::format("<td>{}</td>", cell(c.values[i]));
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

}  // namespace

std::string html(CurveSheet const& sheet, std::string const& png) {
  return head(sheet.title, sheet.notes, png) + table(sheet) + "</body></html>\n";
}

std::string html(MapSheet const& map, std::string const& png) {
  // The loudest frequency of each time, which a table can hold.
  CurveSheet loudest{map.title, {},    {"time", "s", map.time},
                     false,     false, {{"loudest frequency", "Hz", {}}, {"its value", map.unit, {}}}};
  std::size_t const width = map.frequency.size();
  for (std::size_t i = 0; i < map.time.size(); ++i) {
    auto const from = map.value.begin() + std::ptrdiff_t(i * width), to = from + std::ptrdiff_t(width);
    auto const top = std::max_element(from, to);
    loudest.y[0].values.push_back(map.frequency[std::size_t(top - from)]);
    loudest.y[1].values.push_back(*top);
  }
  return head(map.title, map.notes, png) + table(loudest) + "</body></html>\n";
}

}  // namespace straytrace::results::curve_format
