// SPDX-License-Identifier: BSD-3-Clause
#include "report/curve_file.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "base/message.hpp"
#include "report/curve_text.hpp"
#include "report/picture.hpp"
#include "report/report.hpp"

namespace straytrace {
namespace {

namespace fs = std::filesystem;

std::string drawn(std::string const& json) {
  std::string message;
  std::string png = picture_of(json, draw_curves_picture, message);
  if (png.empty()) throw InputError("error: " + message + "\n  or write .txt, .csv or .hdf5");
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
  if (ending == ".html") return curve_format::html(sheet, drawn(curve_format::json(sheet)));
  throw InputError(curve_ending_error(file));
}

template <class Sheet>
void write_all(std::vector<std::string> const& files, Sheet const& sheet) {
  std::vector<std::pair<std::string, std::string>> contents;
  for (std::string const& file : files) contents.push_back({file, bytes_of(file, sheet)});
  write_files(contents);
}

}  // namespace

std::string curve_ending_error(std::string const& file) {
  std::string const ending = fs::path(file).extension().string();
  for (char const* known : {".txt", ".csv", ".json", ".hdf5", ".h5", ".png", ".html"})
    if (ending == known) return "";
  return fmt::format("error: '{}' does not end as a format\n  end it with .txt, .csv, .json, .hdf5, .png or .html",
                     file);
}

std::string curve_json(CurveSheet const& sheet) { return curve_format::json(sheet); }
std::string curve_json(MapSheet const& map) { return curve_format::json(map); }

void write_curves(std::vector<std::string> const& files, CurveSheet const& sheet) { write_all(files, sheet); }
void write_map(std::vector<std::string> const& files, MapSheet const& map) { write_all(files, map); }

}  // namespace straytrace
