// SPDX-License-Identifier: BSD-3-Clause
// straytrace inspect: the content of a material, a preset or a BSDF file as interpreted.
#include "cli/inspect/inspect.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "base/text/json_text.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "io/delimited_text.hpp"
#include "io/hdf5/read_write.hpp"
#include "noise/classes/motion_classes.hpp"
#include "report/html/page_json.hpp"
#include "results/curves/curve_file.hpp"
#include "results/results.hpp"
#include "results/text/picture.hpp"
#include "results/text/scatter_text.hpp"
#include "session/library_entries.hpp"
#include "session/model.hpp"
#include "session/open_run.hpp"
#include "world/build/read_materials.hpp"
#include "world/build/read_parts.hpp"
#include "world/import/geometry_file.hpp"
#include "world/import/newmtl.hpp"
#include "world/model/material.hpp"
#include "world/scatter_data/scatter_file.hpp"

namespace straytrace::cli {
namespace {

constexpr std::array<double, 3> bands_from = {0.1, 1, 10};  // Hz

void print_json(std::vector<CoordinateMotion> const& rows) {
  nlohmann::json out = nlohmann::json::array();
  for (CoordinateMotion const& r : rows) {
    nlohmann::json above = nlohmann::json::object();
    for (std::size_t b = 0; b < bands_from.size(); ++b) above[fmt::format("{:g}", bands_from[b])] = r.above[b];
    out.push_back({{"body", r.body},
                   {"coordinate", r.axis},
                   {"unit", r.unit},
                   {"rms", r.rms},
                   {"rms_above_Hz", above},
                   {"rms_rate_per_s", r.rate},
                   {"drift_per_s", r.drift}});
  }
  std::cout << json_text(nlohmann::json{{"motion", out}}) << '\n';
}

void print_table(std::vector<CoordinateMotion> const& rows) {
  std::cout << fmt::format("{:<20}{:<6}{:>12}", "body", "", "rms");
  for (double const f : bands_from) std::cout << fmt::format("{:>13}", fmt::format("> {:g} Hz", f));
  std::cout << fmt::format("{:>14}{:>14}\n", "rms per s", "drift per s");
  for (CoordinateMotion const& r : rows) {
    std::cout << fmt::format("{:<20}{:<6}{:>12}", r.body, r.axis, fmt::format("{:.3e}", r.rms));
    for (double const a : r.above) std::cout << fmt::format("{:>13}", fmt::format("{:.3e}", a));
    std::cout << fmt::format("{:>14}{:>14}  {}\n", fmt::format("{:.3e}", r.rate),
                             r.drift > 0 ? fmt::format("{:.3e}", r.drift) : "-", r.unit);
  }
}

// ASDs on 200 frequencies a decade; tones and drifts have none.
CurveSheet sheet_of(std::vector<CoordinateMotion> const& rows, std::vector<MotionClass> const& classes) {
  double low = infinity, high = 0;
  for (MotionClass const& c : classes) {
    if (c.tone_frequency > 0 || c.drift) continue;
    low = std::min(low, c.reference.lowest());
    high = std::max(high, c.reference.highest());
  }
  if (!(low < high)) throw InputError("no motion of this file has a spectrum to draw", "remove --plot");
  CurveSheet sheet;
  sheet.title = "Motion of bodies, amplitude spectral density";
  sheet.notes = {"tones and drifts are not drawn"};
  sheet.x = {"frequency", "Hz", {}};
  auto const n = static_cast<std::size_t>(200 * std::log10(high / low)) + 2;
  for (std::size_t i = 0; i < n; ++i) sheet.x.values.push_back(low * std::pow(high / low, double(i) / double(n - 1)));
  for (CoordinateMotion const& r : rows) {
    CurveColumn curve{r.body + " " + r.axis, r.unit + "/sqrt(Hz)", {}};
    for (double const f : sheet.x.values) curve.values.push_back(r.asd(classes, f));
    sheet.y.push_back(std::move(curve));
  }
  return sheet;
}

}  // namespace

bool shows_motion(Scene const& scene) { return scene.table("bodies") && !scene.root().has("materials"); }

int inspect_motion(Scene const& scene, std::string const& plot, PrintOptions const& options) {
  if (!plot.empty()) check_curve_ending(plot, "--plot");
  MotionSet const motion = read_motion_file(scene);
  print_warnings(scene, options);
  std::vector<MotionClass> const classes = group_by_shape(motion);
  std::vector<CoordinateMotion> const rows = coordinate_motions(motion, classes, bands_from);
  if (options.json())
    print_json(rows);
  else
    print_table(rows);
  if (plot.empty()) return done;
  write_curves({plot}, sheet_of(rows, classes));
  if (!options.json()) std::cout << "\npicture: " << plot << '\n';
  return done;
}

namespace {

// "1064 nm" of the command line.
double length_of(std::string const& text) {
  auto const number = leading_number(text);
  auto const unit = number ? parse_unit(number->rest) : std::nullopt;
  double const length = unit && unit->dimension == dim::length ? to_si(number->value, *unit) : 0;
  if (!(length > 1e-8 && length < 1e-3))
    throw InputError(fmt::format("'{}' is not a wavelength", text), "write --wavelength \"1064 nm\"");
  return length;
}

ScatterFile read(ScatterRequest const& r) {
  auto const [text, why] = bytes_of_file(r.file);
  if (!why.empty()) throw InputError(fmt::format("cannot read '{}': {}", r.file, why), "name a file");
  ScatterDeclared given;
  given.angles = r.angles;
  given.entry = r.entry;
  if (!r.wavelength.empty()) given.wavelength = length_of(r.wavelength);
  std::vector<Problem> problems;
  ScatterFile file = read_scatter_file(text, given, problems);
  if (problems.empty()) check_scatter_points(file.points, problems);
  if (problems.empty()) return file;
  throw errors_in(r.file, std::move(problems));
}

void draw(nlohmann::json const& data, std::string const& png) {
  std::string message;
  std::string const picture = picture_of(json_text(data), "scatter", message);
  if (picture.empty()) throw InputError(message, "or remove --plot");
  write_file(png, picture);
}

}  // namespace

int inspect_scatter(ScatterRequest const& r) {
  if (!r.plot.empty()) check_ending(r.plot, {".png"}, "--plot");
  ScatterFile const file = read(r);
  std::string const name = std::filesystem::path(r.file).filename().string();
  ScatterAudit const audit = audit_scatter(file, r.beyond);
  std::vector<ScatterFit> const fits = fit_scatter(file, name);
  std::string ssdd, why;
  if (!r.write.empty()) {
    if (!r.write.ends_with(".ssdd"))
      throw InputError(fmt::format("'{}' is not an SSDD file", r.write), "write --write NAME.ssdd");
    ssdd = ssdd_text(file, r.beyond, why);
    if (!why.empty()) throw InputError(fmt::format("cannot convert '{}' to SSDD: {}", r.file, why), "remove --write");
  }
  nlohmann::json const data = scatter_json(name, file, audit, fits);
  if (!r.plot.empty()) draw(data, r.plot);
  if (!r.write.empty()) write_file(r.write, ssdd);
  if (r.json()) {
    std::cout << json_text(data) << '\n';
    return done;
  }
  std::cout << scatter_text(name, file, audit, fits, r.beyond);
  if (!r.plot.empty()) std::cout << "\npicture: " << r.plot << '\n';
  if (!r.write.empty()) std::cout << "written: " << r.write << '\n';
  return done;
}

namespace {

struct InspectOptions : ScatterRequest {
  std::string scene, units;
};

bool is_list(std::string const& name) { return name.ends_with(".mtl"); }
// By its name, or by its key 'straytrace' where it has another one.
bool is_scene(std::string const& name) {
  if (name.ends_with(".yaml") || name.ends_with(".yml")) return true;
  std::string const head = "\n" + head_of_file(name, 1 << 16);
  return head.find("\nstraytrace:") != head.npos;
}

bool is_preset(std::string const& name) {
  for (MaterialPreset const& p : material_presets())
    if (p.name == name) return true;
  return false;
}

// A scene with only the preset; it reads from `texts` as long as it lives.
Scene scene_of_preset(std::string const& name, FileTexts& texts) {
  texts["preset"] = fmt::format("straytrace: 1\nmaterials: {{{0}: {{preset: {0}}}}}\n", name);
  return read_scene("preset", {}, &texts);
}

[[noreturn]] void refuse_name(std::string const& name) {
  std::vector<std::string> names;
  for (MaterialPreset const& p : material_presets()) names.emplace_back(p.name);
  for (LibraryEntry const& e : library_entries()) {
    if (e.name == name)
      throw InputError(
          fmt::format("'{}' is a {} of the library, but inspect shows presets, materials of a scene, and files", name,
                      e.kind),
          fmt::format("see straytrace library {}", name));
    names.push_back(e.name);
  }
  std::filesystem::path const file = name;
  std::string near = file.has_extension() ? nearest_file(file) : "";
  near = near.empty() ? nearest_word(name, names) : (file.parent_path() / near).string();
  throw InputError(
      fmt::format("'{}' is neither a file nor in the library", name),
      fmt::format("{}for a material of a scene, name the scene after it: straytrace inspect steel arm.yaml",
                  near.empty() ? "" : fmt::format("did you mean '{}'? ", near)));
}

void print_bsdf(WorldView const& world, Optic const& optic, int side) {
  double any = 0;
  for (double offset : material_offsets(6, 1e-5, 1)) any = std::fmax(any, bsdf_at(world, optic, 0, offset, side));
  if (!(any > 0)) return;
  std::cout << fmt::format("\nBSDF [1/sr], {}, in the plane of incidence towards the normal\n{:>14}",
                           side > 0 ? "reflected" : "transmitted", "|beta-beta0|");
  for (double degrees : material_incidences) std::cout << fmt::format("  {:>6.0f} deg", degrees);
  std::cout << '\n';
  for (double offset : material_offsets(2, 1e-5, 1)) {
    std::cout << fmt::format("{:14.3e}", offset);
    for (double degrees : material_incidences) {
      double const value = bsdf_at(world, optic, degrees, offset, side);
      std::cout << (value < 0 ? fmt::format("  {:>10}", "-") : fmt::format("  {:10.3e}", value));
    }
    std::cout << '\n';
  }
}

// ", source: TEXT"; nothing where none is given.
std::string if_given(char const* what, std::string const& text) {
  return text == "not given" ? "" : fmt::format(", {}: {}", what, text);
}

// "law 1: power-law, exponent 2, tis 5 ppm (mirrors.yaml:7), wavelength: 1064 nm"
std::string law_line(Scene const& scene, LawInfo const& law, bool through) {
  return fmt::format("{}{}{}{}{}{}{}", law.model, through ? " (through)" : "", law.parameters.empty() ? "" : ", ",
                     law.parameters, law.place.line > 0 ? fmt::format(" ({})", scene.place_text(law.place)) : "",
                     if_given("source", law.source), if_given("wavelength", law.wavelength));
}

void print(Scene const& scene, WorldView const& world, MaterialInfo const& info,
           std::vector<std::string> const& notes) {
  Optic const& optic = world.optics[info.optic];
  std::cout << fmt::format("material {}{}\n", info.name, if_given("source", info.source));
  for (std::size_t i = 0; i < info.laws.size(); ++i)
    std::cout << fmt::format("  law {}: {}\n", i + 1, law_line(scene, info.laws[i], optic.through[i]));
  for (std::string const& note : notes) std::cout << "  " << note << '\n';
  std::cout << fmt::format("\n{:>6}  {:>10}", "deg", "TIS");
  for (int i = 0; i < optic.laws; ++i) std::cout << fmt::format("  {:>10}", fmt::format("law {}", i + 1));
  std::cout << fmt::format("  {:>10}  {:>10}  {:>10}\n", "specular R", "T", "absorbed");
  for (double degrees : material_angles) {
    MaterialShares const r = shares_at(world, optic, degrees);
    std::cout << fmt::format("{:6.0f}  {:10.4e}", degrees, r.scattered);
    for (double share : r.laws) std::cout << fmt::format("  {:10.4e}", share);
    std::cout << fmt::format("  {:10.4e}  {:10.4e}  {:10.4e}\n", r.reflect, r.transmit, r.absorbed);
  }
  print_bsdf(world, optic, 1);
  print_bsdf(world, optic, -1);
}

void plot(nlohmann::json const& data, std::string const& png) {
  std::string message;
  std::string const picture = picture_of(json_text(data), "law", message);
  if (picture.empty()) throw InputError(message, "or remove --plot");
  write_file(png, picture);
  std::cout << "\npicture: " << png << '\n';
}

// A list of materials in the newmtl format, as a file that a scene can include.
int print_list(std::string const& file, bool json) {
  std::string const text = read_text(file);
  std::vector<Problem> problems;
  std::vector<NewmtlMaterial> const list = read_newmtl(text, problems);
  std::string const name = std::filesystem::path(file).filename().string();
  if (list.empty() && problems.empty())
    throw InputError(fmt::format("'{}' contains no material", file), "begin with a line 'newmtl NAME'");
  if (!problems.empty()) throw errors_in(file, std::move(problems));
  if (!json) {
    std::cout << fmt::format(
                     "straytrace: 1\n# of {}: save this as materials.yaml next to a scene and write there\n"
                     "#   include: [materials.yaml]\n",
                     name)
              << materials_table(list);
    return done;
  }
  nlohmann::json out = nlohmann::json::array();
  for (NewmtlMaterial const& m : list)
    out.push_back({{"material", m.name},
                   {"transmit", m.transmit},
                   {"reflect", m.reflect},
                   {"scatter_transmit", m.scatter_transmit},
                   {"scatter_reflect", m.scatter_reflect},
                   {"index", m.index},
                   {"wavelength", m.wavelength}});
  std::cout << json_text(out) << '\n';
  return done;
}

// The requested scene; nothing where the input is a file of measured scatter.
std::optional<Scene> scene_asked(InspectOptions const& i, FileTexts& texts) {
  std::string const& name = i.file;
  bool const whole = is_scene(name), own = !i.scene.empty();
  if (whole && own)
    throw InputError("two scenes", "write straytrace inspect MATERIAL SCENE, or straytrace inspect SCENE");
  if (own || whole) return read_scene(own ? i.scene : name, i.overrides);
  if (is_preset(name)) return scene_of_preset(name, texts);
  if (std::filesystem::is_regular_file(name)) return {};
  refuse_name(name);
}

// A model, not a list of materials: what `check` finds wrong with it is an error here as well.
void check_model(Scene const& scene, InspectOptions const& i) {
  for (char const* const table : {"scene", "beams", "ports", "receivers", "interferometer"})
    if (scene.root().has(table)) {
      read_model(i.scene.empty() ? i.file : i.scene, i.overrides);
      return;
    }
}

void check_outputs(InspectOptions const& i, bool motion) {
  if (!i.write.empty())
    throw InputError("--write converts files of measured scatter", "name such a file, or remove --write");
  if (!i.plot.empty() && !motion) check_ending(i.plot, {".png"}, "--plot");
}

// Whether an HDF5 file is marked as a run, unlike records of sensors.
bool is_run(std::string const& file) {
  try {
    return hdf5::Reader(read_file(file), {[](std::string const&) { return false; }}).has_attribute("/", "file_type");
  } catch (InputError const&) {
    return true;  // damaged: the reader of runs reports it
  }
}

int inspect(InspectOptions const& i) {
  std::string const& name = i.file;
  if (is_run_file(name) && !is_run(name))
    throw InputError(fmt::format("'{}' is HDF5 but not a run file", name),
                     fmt::format("for recorded data, see straytrace signal psd {}, which lists its channels", name));
  if (is_run_file(name))
    throw InputError(
        fmt::format("'{}' is a run file", name),
        fmt::format("see straytrace paths {0}, straytrace noise {0}, or straytrace run {0} -o FOLDER to repeat it",
                    name));
  if (is_geometry(name) && i.scene.empty()) return inspect_geometry(name, i.units, i.plot, i);
  if (is_list(i.file) && i.scene.empty()) return print_list(i.file, i.json());
  FileTexts texts;
  std::optional<Scene> const asked = scene_asked(i, texts);
  if (!asked) return inspect_scatter(i);
  Scene const& scene = *asked;
  bool const own = !i.scene.empty(), motion = is_scene(i.file) && shows_motion(scene);
  check_outputs(i, motion);
  if (motion) return inspect_motion(scene, i.plot, i);
  check_model(scene, i);
  World world;
  Registry names;
  read_media(scene, world, names);
  read_materials(scene, world, names);
  scene.throw_if_problems();
  print_warnings(scene, i);
  bool found = false;
  std::vector<std::string> known;
  for (MaterialInfo const& info : world.materials) {
    known.push_back(info.name);
    if (own && info.name != i.file) continue;
    std::vector<std::string> notes;
    for (std::string const& note : world.notes)
      if (note.starts_with("material " + info.name + ":")) notes.push_back(note.substr(11 + info.name.size()));
    if (found && !i.json()) std::cout << '\n';
    found = true;
    nlohmann::json const data = material_json(world.view(), info, notes);
    if (i.json())
      std::cout << json_text(data) << '\n';
    else
      print(scene, world.view(), info, notes);
    if (!i.plot.empty()) plot(data, i.plot);
    if (!i.plot.empty()) break;
  }
  if (found) return done;
  throw InputError(fmt::format("'{}' has no material '{}'", own ? i.scene : i.file, i.file),
                   did_you_mean(i.file, known, fmt::format("its materials: {}", fmt::join(known, ", "))));
}

}  // namespace

void add_inspect(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<InspectOptions>();
  InspectOptions& o = *options;
  auto* const command = app.add_subcommand(
      "inspect", "Show the content of a material, a preset, or a file of CAD, meshes, measured scatter or motion.");
  command
      ->add_option(
          "what", o.file,
          "material of a scene, preset, CAD or mesh file, file of measured scatter, list of materials (newmtl, .mtl), "
          "scene, or motion file")
      ->required();
  command->add_option("scene", o.scene, "scene that contains the material");
  add_overrides(*command, o.overrides,
                "set a parameter, for example -p rim=48cm, or any value by its place in the scene");
  mark_output(*command, *command->add_option("--plot", o.plot,
                                             "draw the parts, BSDF against |beta - beta0| and TIS against angle, "
                                             "measured scatter with fits and residuals, or "
                                             "the ASDs of motion, into this PNG file"));
  command->add_option("--units", o.units, "unit of the numbers of a CAD or mesh file, for example mm");
  mark_output(*command,
              *command->add_option("--write", o.write, "convert a file of measured scatter into this SSDD file"));
  command->add_option("--beyond", o.beyond, "extrapolation of measured scatter: constant, power or zero")
      ->check(CLI::IsMember({"constant", "power", "zero"}));
  command->add_option("--angles", o.angles, "angles of a CSV that does not declare them: from_normal or from_specular")
      ->check(CLI::IsMember({"from_normal", "from_specular"}));
  command->add_option("--wavelength", o.wavelength,
                      "wavelength of a file that does not declare it, for example \"633 nm\"");
  command->add_option("--entry", o.entry, "name of the entry of an ABg catalogue");
  command->add_flag("--quiet", o.quiet, "no warnings");
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace inspect oxidised_steel\n"
      "  straytrace inspect test_mass examples/virgo_arm.yaml --format json\n"
      "  straytrace inspect examples/data/steel_bsdf.csv --plot steel.png\n"
      "  straytrace inspect examples/data/cad_bench.step --plot bench.png\n"
      "  straytrace inspect examples/data/iris.mtl > materials.yaml");
  command->callback([options, &exit_code] { exit_code = inspect(*options); });
}

}  // namespace straytrace::cli
