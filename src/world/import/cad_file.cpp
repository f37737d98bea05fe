// SPDX-License-Identifier: BSD-3-Clause
#include "world/import/cad_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <unistd.h>

#include "base/files/read_write.hpp"
#include "base/process/child_process.hpp"
#include "base/text/json_text.hpp"
#include "base/text/words.hpp"

namespace straytrace::world {
namespace {

using nlohmann::json;
constexpr int known_version = 1;

double number(json const& node) {
  double const x = node.get<double>();
  if (!std::isfinite(x)) throw std::runtime_error("a number is not finite");
  return x;
}
double positive(json const& node, char const* what) {
  double const x = number(node);
  if (!(x > 0)) throw std::runtime_error(fmt::format("the {} {:g} is not positive", what, x));
  return x;
}
Vec3 vector(json const& node) {
  if (node.size() != 3) throw std::runtime_error("a vector does not have three numbers");
  return {number(node[0]), number(node[1]), number(node[2])};
}

Pose frame_of(json const& node) {
  Vec3 const x = vector(node.at("x")), z = vector(node.at("z"));
  if (std::fabs(length(x) - 1) > 1e-6 || std::fabs(length(z) - 1) > 1e-6 || std::fabs(dot(x, z)) > 1e-6)
    throw std::runtime_error("the axes of a face are not perpendicular");
  Vec3 const e3 = unit(z), e1 = unit(x - dot(x, e3) * e3);
  return {vector(node.at("origin")), e1, cross(e3, e1), e3};
}

std::vector<ChartLoop> loops_of(json const& node) {
  std::vector<ChartLoop> loops;
  for (json const& numbers : node) {
    if (numbers.size() < 6 || numbers.size() % 3 != 0) throw std::runtime_error("a loop has fewer than two corners");
    ChartLoop& loop = loops.emplace_back();
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
      ChartCorner const c{number(numbers[i]), number(numbers[i + 1]), number(numbers[i + 2])};
      if (std::fabs(c.bulge) > 1) throw std::runtime_error("an arc turns by more than half a circle");
      loop.push_back(c);
    }
  }
  if (loops.empty()) throw std::runtime_error("a face has no loop");
  return loops;
}

CadFileFace face_of(json const& node) {
  static constexpr std::array<std::string_view, 5> kinds = {"plane", "cylinder", "cone", "sphere", "torus"};
  std::string const kind = node.at("kind");
  auto const at = std::ranges::find(kinds, kind);
  if (at == kinds.end()) throw std::runtime_error(fmt::format("'{}' is not a kind of face", kind));
  CadFileFace f;
  f.carrier = Carrier(at - kinds.begin());
  f.frame = frame_of(node);
  f.flipped = node.at("flipped");
  if (f.carrier != Carrier::plane && f.carrier != Carrier::cone) f.radius = positive(node.at("radius"), "radius");
  if (f.carrier == Carrier::torus || f.carrier == Carrier::cone)
    f.second = positive(node.at("second"), "second number");
  if (f.carrier == Carrier::cone && !(f.second < pi / 2))
    throw std::runtime_error("a cone opens by 90 degrees or more");
  if (f.carrier == Carrier::torus && !(f.second < f.radius)) throw std::runtime_error("a torus intersects itself");
  f.natural = node.contains("within");
  if (!f.natural) {
    f.loops = loops_of(node.at("loops"));
    return f;
  }
  f.from = number(node.at("within").at(0));
  f.to = number(node.at("within").at(1));
  if (f.carrier != Carrier::torus && !(f.from < f.to)) throw std::runtime_error("a face has no width");
  return f;
}

void read_triangles(json const& node, CadFilePart& part) {
  part.freeform = node.at("faces");
  for (json const& v : node.at("vertices")) {
    Vec3 const p = vector(v);
    part.vertices.push_back({float(p.x), float(p.y), float(p.z)});
  }
  for (json const& t : node.at("corners")) {
    MeshTriangle triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.corner[i] = t.at(i);
      if (triangle.corner[i] >= part.vertices.size()) throw std::runtime_error("a triangle refers to a missing corner");
    }
    part.triangles.push_back(triangle);
  }
}

void read(json const& all, CadFile& out) {
  out.made_by = all.at("made_by");
  out.schema = all.at("schema");
  out.unit = number(all.at("unit"));
  out.unit_stated = all.at("unit_stated");
  out.tolerance = number(all.at("tolerance"));
  out.chord = number(all.at("chord"));
  out.box = {vector(all.at("lower")), vector(all.at("upper"))};
  for (json const& n : all.at("notes")) out.notes.push_back({n.at("what"), n.at("suggestion")});
  for (json const& p : all.at("parts")) {
    CadFilePart& part = out.parts.emplace_back();
    part.name = p.at("name");
    part.colour = p.at("colour");
    for (json const& f : p.at("faces")) part.faces.push_back(face_of(f));
    if (p.contains("triangles")) read_triangles(p.at("triangles"), part);
  }
  if (out.parts.empty()) throw std::runtime_error("it contains no parts");
}

}  // namespace

Box CadFile::box_in_unit() const {
  double const u = unit > 0 ? unit : 1;
  return {(1 / u) * box.lower, (1 / u) * box.upper};
}

bool is_step(std::string const& name) {
  std::string const low = lower_case(name);
  return low.ends_with(".step") || low.ends_with(".stp") || low.ends_with(".p21");
}

bool is_converted(std::string const& name) { return lower_case(name).ends_with(".cad.json"); }

MeshFault read_cad_file(std::string const& text, CadFile& out) {
  std::string const fix = "convert it again: straytrace-step FILE.step";
  try {
    json const all = read_json(text);
    if (!all.is_object() || !all.contains("straytrace_cad"))
      return {"this is not CAD geometry of straytrace: it has no 'straytrace_cad'", fix};
    if (int const version = all.at("straytrace_cad"); version != known_version)
      return {fmt::format("it has version {} of the format, this program reads version {}", version, known_version),
              fix};
    read(all, out);
  } catch (std::exception const& e) {
    return {fmt::format("the converted file is damaged: {}", e.what()), fix};
  }
  return {};
}

}  // namespace straytrace::world

extern char** environ;

namespace straytrace::world {
namespace {

namespace fs = std::filesystem;

bool can_run(fs::path const& program) {
  std::error_code ignored;
  return fs::is_regular_file(program, ignored) && ::access(program.c_str(), X_OK) == 0;
}

// Empty: there is none.
fs::path converter() {
  std::string const name = "straytrace-step";
  if (std::string const chosen = environment_variable("STRAYTRACE_STEP"); !chosen.empty())
    return can_run(chosen) ? fs::path(chosen) : fs::path();
  std::error_code unknown;
  if (fs::path const beside = fs::read_symlink("/proc/self/exe", unknown).parent_path() / name; can_run(beside))
    return beside;
  std::string const path = environment_variable("PATH");
  for (std::size_t at = 0; at < path.size();) {
    std::size_t const end = std::min(path.find(':', at), path.size());
    fs::path const folder = path.substr(at, end - at);
    if (folder.is_absolute() && can_run(folder / name)) return folder / name;
    at = end + 1;
  }
  return {};
}

fs::path cache_folder() {
  std::string const chosen = environment_variable("XDG_CACHE_HOME"), home = environment_variable("HOME");
  fs::path const base = !chosen.empty() ? fs::path(chosen) : !home.empty() ? fs::path(home) / ".cache" : fs::path();
  if (!base.is_absolute()) return {};
  fs::path const folder = base / "straytrace" / "step";
  std::error_code failed;
  fs::create_directories(folder, failed);
  return ::access(folder.c_str(), W_OK) == 0 ? folder : fs::path();
}

// A folder for one conversion, gone with it.
class WorkFolder {
 public:
  explicit WorkFolder(fs::path const& parent) {
    std::string pattern = (parent / "work-XXXXXX").string();
    if (::mkdtemp(pattern.data())) path_ = pattern;
  }
  ~WorkFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  WorkFolder(WorkFolder const&) = delete;
  WorkFolder& operator=(WorkFolder const&) = delete;
  fs::path const& path() const { return path_; }

 private:
  fs::path path_;
};

// "bench.step: error: WHAT\n  SUGGESTION\n"
MeshFault said(int status, std::string const& output) {
  constexpr std::string_view mark = ": error: ";
  std::size_t const at = output.find(mark);
  if (output.empty())
    return {fmt::format("straytrace-step ended without a message, with exit status {}", status),
            "the file may be damaged: export it again"};
  if (at == std::string::npos)
    return {"straytrace-step failed: " + output.substr(0, 300), "run it on the file by hand"};
  std::size_t const begin = at + mark.size(), end = std::min(output.find('\n', begin), output.size());
  std::string suggestion = end < output.size() ? output.substr(end + 1) : "";
  while (suggestion.ends_with('\n')) suggestion.pop_back();
  suggestion.erase(0, suggestion.find_first_not_of(' '));
  return {output.substr(begin, end - begin), suggestion};
}

StepConversion run(fs::path const& program, fs::path const& folder, std::string const& bytes) {
  fs::path const from = folder / "in.step", to = folder / "out.cad.json";
  if (!(std::ofstream(from, std::ios::binary) << bytes))
    return {"", {fmt::format("no space in '{}' to convert it", folder.parent_path().string()), "free some space"}};
  std::vector<std::string> variables;
  for (char** entry = environ; *entry; ++entry) variables.emplace_back(*entry);
  FinishedChild const child = run_child(
      {program.string(), from.string(), "-o", to.string(), "--quiet", "--end-with-parent"}, std::move(variables));
  if (child.start_error != 0)
    return {"",
            {fmt::format("cannot start '{}': {}", program.string(), std::strerror(child.start_error)),
             "build straytrace-step again"}};
  if (child.status != 0) return {"", said(child.status, child.output)};
  return {bytes_of_file(to).bytes, {}};
}

}  // namespace

StepConversion convert_step(std::string const& name, std::string const& bytes) {
  if (bytes.find('\0') != bytes.npos)
    return {"", {"the file contains a zero byte: it is binary or damaged, but STEP files are text", "export it again"}};
  fs::path const program = converter();
  if (program.empty())
    return {"",
            {"STEP files need the program straytrace-step, which is neither next to straytrace nor in PATH",
             fmt::format("install OpenCASCADE and build it (scripts/setup, scripts/build), or convert the file where "
                         "it is installed, 'straytrace-step {}', and name the .cad.json here",
                         name)}};
  std::error_code failed;
  fs::path const cache = cache_folder();
  std::string const identity = fmt::format("{} {} ", fs::file_size(program, failed),
                                           fs::last_write_time(program, failed).time_since_epoch().count());
  fs::path const kept = cache.empty() ? fs::path() : cache / (sha256(identity + bytes) + ".cad.json");
  // After a power failure the file may be incomplete.
  if (std::string text = kept.empty() ? "" : bytes_of_file(kept).bytes; nlohmann::json::accept(text))
    return {std::move(text), {}};
  WorkFolder const work(cache.empty() ? fs::temp_directory_path(failed) : cache);
  if (work.path().empty())
    return {"", {"there is no folder for the conversion", "set XDG_CACHE_HOME to a folder that you can write to"}};
  StepConversion made = run(program, work.path(), bytes);
  if (!made.text.empty() && !kept.empty()) fs::rename(work.path() / "out.cad.json", kept, failed);
  return made;
}

}  // namespace straytrace::world
