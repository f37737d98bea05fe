// SPDX-License-Identifier: BSD-3-Clause
#include "report/curve_file.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <unistd.h>

#include "base/message.hpp"
#include "report/curve_text.hpp"
#include "report/picture.hpp"
#include "report/report.hpp"

namespace straytrace {
namespace {

namespace fs = std::filesystem;

// A folder of our own for the picture on its way.
class Workplace {
 public:
  Workplace() {
    std::string name = (fs::temp_directory_path() / "straytrace-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw InputError(fmt::format("error: cannot make a folder in '{}' for the picture\n  set TMPDIR to another one",
                                   fs::temp_directory_path().string()));
    folder_ = name;
  }
  ~Workplace() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Workplace(Workplace const&) = delete;
  Workplace& operator=(Workplace const&) = delete;
  std::string path(char const* name) const { return (folder_ / name).string(); }

 private:
  fs::path folder_;
};

std::string drawn(std::string const& json) {
  Workplace const place;
  std::string const from = place.path("curves.json"), to = place.path("curves.png");
  std::string message;
  write_file(from, json);
  if (!draw_curves_picture(from, to, message))
    throw InputError("error: " + message + "\n  or write .txt, .csv or .hdf5");
  return read_file(to);
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
