// SPDX-License-Identifier: BSD-3-Clause
// straytrace render: pictures of a scene, computed by rays. straytrace maps: the light on the receivers of a run.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/text/json_text.hpp"
#include "base/text/words.hpp"
#include "base/units/quantity.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "report/scene_picture.hpp"
#include "results/receivers/receivers.hpp"
#include "results/text/picture.hpp"
#include "session/light/cavity_waves.hpp"
#include "session/light/lit_table.hpp"
#include "session/light/optical_network.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"
#include "trace/importance/importance.hpp"
#include "world/model/world.hpp"

namespace straytrace::cli {
namespace {

struct RenderOptions : SceneOptions {
  std::string out;
  unsigned threads = 0;
  std::string mode = "shaded", eye, look, up, field, pixels = "800x600", from, at;
  std::vector<std::string> cuts;
  std::string lamp = "5 mm";
  bool section = false, whole = false, flash = false, beams = false;
};

[[noreturn]] void refuse_option(std::string const& option, std::string const& text, std::string const& instead) {
  throw InputError(fmt::format("'{}' is not valid for --{}", text, option), instead);
}

double number_in(std::string const& option, std::string const& text, Dimension dimension, std::string const& instead) {
  auto const number = leading_number(text);
  bool const bare = number && number->rest.empty();
  if (bare && (number->value == 0 || dimension == dim::plain)) return number->value;
  auto const unit = number && !bare ? parse_unit(number->rest) : std::nullopt;
  if (!unit || unit->dimension != dimension) refuse_option(option, text, instead);
  return to_si(number->value, *unit);
}

Vec3 vector_in(std::string const& option, std::string const& text, Dimension dimension, std::string const& instead) {
  std::vector<std::string> const parts = CLI::detail::split(text, ',');
  if (parts.size() != 3) refuse_option(option, text, instead);
  return {number_in(option, parts[0], dimension, instead), number_in(option, parts[1], dimension, instead),
          number_in(option, parts[2], dimension, instead)};
}

void read_pixels(std::string const& text, std::uint32_t& columns, std::uint32_t& rows) {
  std::vector<std::string> const parts = CLI::detail::split(text, 'x');
  auto const side = [&](std::string const& part) {
    bool const digits = !part.empty() && part.size() < 6 && part.find_first_not_of("0123456789") == part.npos;
    int const n = digits ? std::stoi(part) : 0;
    if (n < 8 || n > 8192) refuse_option("pixels", text, "write for example --pixels 800x600, each from 8 to 8192");
    return std::uint32_t(n);
  };
  if (parts.size() != 2) side("");
  columns = side(parts[0]);
  rows = side(parts[1]);
}

// "x=0": away with the side on which the eye is; "x>0", "x<0": with that side.
Cut read_cut(std::string const& text, Vec3 eye) {
  std::string const instead = "write for example --cut x=0, --cut \"y>5cm\"";
  if (text.size() < 3 || text[0] < 'x' || text[0] > 'z' || std::string("=<>").find(text[1]) == std::string::npos)
    refuse_option("cut", text, instead);
  double const value = number_in("cut", text.substr(2), dim::length, instead);
  Vec3 normal;
  (&normal.x)[text[0] - 'x'] = 1;
  bool const above = text[1] == '=' ? dot(eye, normal) > value : text[1] == '>';
  return above ? Cut{normal, value} : Cut{-normal, -value};
}

bool belongs(std::string const& group, std::string const& name) {
  return group == name || group.starts_with(name + "/");
}

// Names for --at and --from.
[[noreturn]] void unknown_name(World const& world, std::string const& option, std::string const& name) {
  std::vector<std::string> known;
  if (option == "from") {
    known = world.ports();
    known.insert(known.end(), world.receiver_names().begin(), world.receiver_names().end());
  }
  for (std::string const& group : world.groups()) {
    known.push_back(group);
    known.push_back(object_of(group));
  }
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  throw InputError(fmt::format("--{}: the scene has no '{}'", option, name),
                   did_you_mean(name, known, fmt::format("its names: {}", fmt::join(known, ", "))));
}

struct Stand {  // of an eye
  Vec3 point, look;
  Departure on;
};

Stand stand_at(World const& world, Footprint const& f) {
  if (f.free) return {f.centre, f.travel, {}};
  return {world.view().project(f.surface, f.centre), -f.travel, {f.surface}};
}

// The spot of a port, a free beam, the first spot on a surface, or the middle of a surface.
Stand stand_on(World const& world, std::string const& name) {
  WorldView const view = world.view();
  for (Footprint const& f : world.footprints())
    if (f.port.valid() && world.ports()[f.port.value] == name) return stand_at(world, f);
  for (Footprint const& f : world.footprints()) {
    GroupId const group = f.free ? f.origin : world.surfaces()[f.surface.value].group;
    if (group.valid() && belongs(world.groups()[group.value], name)) return stand_at(world, f);
  }
  SurfaceId on;
  for (std::uint32_t id = 0; id < world.surfaces().size() && !on.valid(); ++id)
    if (belongs(world.name_of({id}), name)) on = {id};
  for (std::size_t i = 0; i < world.receivers().size(); ++i)
    if (world.receiver_names()[i] == name) on = world.receivers()[i].surface;
  if (!on.valid()) unknown_name(world, "from", name);
  SurfacePoint const middle = view.shapes.visit(world.surfaces()[on.value].shape, [](auto const& s) {
    if constexpr (HasPieces<std::decay_t<decltype(s)>>)
      return s.sample(0.5, 0.5);
    else
      return SurfacePoint{s.project(s.reference()), 0};
  });
  bool const open_front = looks_of(view)[2 * on.value] == Look::open;
  Vec3 const normal = view.normal(on, middle.point, middle.piece);
  return {middle.point, open_front ? -normal : normal, {on, middle.piece}};
}

Framing choose_view(World const& world, RenderOptions const& w) {
  std::uint32_t columns = 0, rows = 0;
  read_pixels(w.pixels, columns, rows);
  std::string const angle = "write for example --fov 30deg, between 0 and 180 degrees (360 with --from)";
  double field = w.field.empty() ? (w.from.empty() ? 30 : 170) * degree : number_in("fov", w.field, dim::angle, angle);
  if (!(field > 1e-9 && field <= (w.from.empty() ? 179 : 360) * degree)) refuse_option("fov", w.field, angle);
  std::string const direction = "write three numbers, for example --up 0,1,0";
  Vec3 const up = w.up.empty() ? Vec3{0, 1, 0} : vector_in("up", w.up, dim::plain, direction);
  if (!(length(up) > 0)) refuse_option("up", w.up, direction);
  if (!w.from.empty()) {
    Stand const s = stand_on(world, w.from);
    Framing f;
    f.camera = (field > 100 * degree ? fisheye_at : looking_at)(s.point, s.point + s.look, up, field, columns, rows);
    f.camera.from = s.on;
    return f;
  }
  WorldView const view = world.view();
  Box const box = bounds_of(view, [&](SurfaceId id) { return w.at.empty() || belongs(world.name_of(id), w.at); });
  if (!(box.lower.x <= box.upper.x)) unknown_name(world, "at", w.at);
  if (w.eye.empty()) {
    if (!w.look.empty()) throw InputError("--look without --eye", "give the position of the eye: --eye 0,0,-1m");
    return w.section || is_long(box) ? section(box, columns, rows) : framing(box, field, columns, rows);
  }
  std::string const place = "write three lengths, for example --eye 0,20cm,-1.5m";
  Vec3 const eye = vector_in("eye", w.eye, dim::length, place);
  Vec3 const look = w.look.empty() ? 0.5 * (box.lower + box.upper) : vector_in("look", w.look, dim::length, place);
  if (!(length(look - eye) > 0)) refuse_option("look", w.look, "--eye and --look are the same point");
  return {looking_at(eye, look, up, field, columns, rows), {}};
}

void print(RenderOptions const& options, Camera const& c, Drawn const& drawn) {
  if (options.json()) {
    nlohmann::json legend = nlohmann::json::array();
    for (LegendEntry const& e : drawn.legend)
      legend.push_back({{"colour", e.colour}, {"name", e.name}, {"object", e.what}});
    nlohmann::json shine = nlohmann::json::array();
    for (Shine const& o : drawn.shine)
      shine.push_back({{"object", o.object}, {"scattered", o.scattered}, {"glint", o.glint}});
    nlohmann::json halo = nlohmann::json::array();
    for (HaloOn const& on : drawn.halo)
      halo.push_back({{"object", on.object}, {drawn.halo_in_watts ? "power_W" : "power_share", on.power}});
    nlohmann::json const out{{"file", options.out},
                             {"columns", c.columns},
                             {"rows", c.rows},
                             {"eye", {c.eye.x, c.eye.y, c.eye.z}},
                             {"forward", {c.forward.x, c.forward.y, c.forward.z}},
                             {"up", {c.up.x, c.up.y, c.up.z}},
                             {"focal_length_pixels", c.focal_length()},
                             {"scale", drawn.scale},
                             {"shine", shine},
                             {"halo", halo},
                             {"legend", legend}};
    std::cout << json_text(out) << '\n';
    return;
  }
  std::cout << fmt::format("{}: {} x {} pixels", options.out, c.columns, c.rows);
  if (c.lens == Camera::Lens::flat)
    std::cout << fmt::format(", section of {:.4g} m x {:.4g} m through ({:.4g}, {:.4g}, {:.4g}) m", 2 * c.half_width,
                             2 * c.half_height, c.eye.x, c.eye.y, c.eye.z);
  else
    std::cout << fmt::format(", eye at ({:.4g}, {:.4g}, {:.4g}) m, looking along ({:.3f}, {:.3f}, {:.3f})", c.eye.x,
                             c.eye.y, c.eye.z, c.forward.x, c.forward.y, c.forward.z);
  std::cout << '\n';
  if (!drawn.scale.empty()) std::cout << drawn.scale << '\n';
  if (!drawn.shine.empty())
    std::cout << "scattered    glint        at the eye over the intensity of the flash, 1/m^2\n";
  for (Shine const& o : drawn.shine)
    std::cout << fmt::format("{:<11.3e}  {:<11.3e}  {}\n", o.scattered, o.glint, o.object);
  if (!drawn.halo.empty())
    std::cout << fmt::format("light at small angles on objects, {}\n",
                             drawn.halo_in_watts ? "W" : "over the power of the mode");
  for (HaloOn const& on : drawn.halo) std::cout << fmt::format("{:<9.3g}  {}\n", on.power, on.object);
  for (LegendEntry const& e : drawn.legend) std::cout << fmt::format("{} {:7} {}\n", e.colour, e.name, e.what);
}

void check_picture_name(std::string const& file) {
  std::filesystem::path path(file);
  if (lower_case(path.extension().string()) == ".png") return;
  throw InputError(fmt::format("'{}' is not the name of a PNG file", file),
                   fmt::format("write -o {}", path.replace_extension(".png").string()));
}

Flash flash_of(RenderOptions const& w, Camera const& camera) {
  std::string const instead = "write for example --lamp 5mm";
  Flash const flash{.radius = number_in("lamp", w.lamp, dim::length, instead)};
  if (!(flash.radius > 0)) refuse_option("lamp", w.lamp, instead);
  if (camera.lens == Camera::Lens::flat || w.mode != "shaded" || !w.cuts.empty())
    throw InputError("--flash needs a camera position and a complete scene",
                     "write --from NAME or --eye X,Y,Z, without --section, --mode and --cut");
  return flash;
}

// With the importance map of the run, unless parameters have changed.
void steer_as_traced(World& world, std::optional<RunFile> const& run, std::vector<std::string> const& overrides) {
  world.limits.targets = true;
  bool const kept = run && overrides.empty() && !run->about.importance.strips.empty();
  if (!kept || !show_importance(world, run->about.importance)) steer(world);
}

using Draw = std::function<Drawn(Camera const&, LookSettings const&)>;

void draw(RenderOptions const& w, World const& world, Draw const& drawn_by) {
  Framing const view = choose_view(world, w);
  LookSettings settings{view.cuts, looks_of(world.view()), w.threads};
  if (w.whole) std::replace(settings.looks.begin(), settings.looks.end(), Look::open, Look::solid);
  for (std::string const& cut : w.cuts) settings.cuts.push_back(read_cut(cut, view.camera.eye));
  Drawn drawn = drawn_by(view.camera, settings);
  if (w.beams) draw_beams(drawn, world, view.camera, settings, beam_lines(world));
  Image image{view.camera.columns, view.camera.rows, drawn.rgb};
  if (drawn.bar) add_colour_bar(image, *drawn.bar);
  write_png(w.out, image);
  print(w, view.camera, drawn);
}

// Of a run with its own field; otherwise the field is solved.
void draw_halo_of(RenderOptions const& w, std::optional<RunFile> const& run) {
  Model model = run ? model_of(*run, w.overrides) : read_model(w.input, w.overrides);
  if (run) model.waves = run->about.waves;
  choose_view(model.world, w);  // bad options before a long computation
  WaveRecord const& field = waves_to_show(model, w.overrides.empty(), w.threads, w);
  HaloLight const light(model.world, *model.arm, field.irradiance);
  draw(w, model.world, [&](Camera const& camera, LookSettings const& settings) {
    return draw_halo(model.world, camera, settings, light, field.power);
  });
}

int render(RenderOptions const& w) {
  check_picture_name(w.out);
  if (w.beams && (w.flash || (w.mode != "shaded" && w.mode != "importance" && w.mode != "halo")))
    throw InputError(fmt::format("{} does not show beams", w.flash ? "--flash" : "--mode " + w.mode),
                     "remove --beams, or write --mode shaded");
  std::optional<RunFile> file;
  if (names_run(w.input)) file = read_run(w.input);
  if (w.mode == "halo" && !w.flash) {
    draw_halo_of(w, file);
    return done;
  }
  Scene const scene = file ? scene_of(*file, w.overrides) : read_scene(w.input, w.overrides);
  World world = build_lit_world(scene);
  scene.throw_if_problems();
  if (w.mode == "importance" && !w.flash) {
    choose_view(world, w);
    steer_as_traced(world, file, w.overrides);
  }
  draw(w, world, [&](Camera const& camera, LookSettings const& settings) {
    if (w.flash) return draw_flash(world, camera, settings, flash_of(w, camera));
    auto* const drawn_by = w.mode == "id"           ? draw_ids
                           : w.mode == "depth"      ? draw_depths
                           : w.mode == "normal"     ? draw_normals
                           : w.mode == "importance" ? draw_importance
                                                    : draw_shaded;
    return drawn_by(world, camera, settings);
  });
  return done;
}

}  // namespace

void add_render(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<RenderOptions>();
  RenderOptions& o = *options;
  auto* const command = app.add_subcommand("render", "Draw a scene by ray casting, to check its geometry.");
  add_scene_options(*command, o, "scene (YAML), or run file (HDF5)");
  mark_output(*command, *command->add_option("-o,--out", o.out, "picture to write (PNG)")->required());
  command->add_option("--mode", o.mode, "shaded, id, normal, depth, importance or halo")
      ->check(CLI::IsMember({"shaded", "id", "normal", "depth", "importance", "halo"}));
  command->add_option("--eye", o.eye, "position of the camera, for example 0,20cm,-1.5m");
  command->add_option("--look", o.look, "point in the middle of the picture; default: middle of the scene");
  command->add_option("--up", o.up, "upward direction of the picture; default: 0,1,0");
  command->add_option("--fov", o.field, "angle from the lower to the upper edge; default: 30deg, with --from 170deg");
  command->add_option("--pixels", o.pixels, "width x height; default: 800x600");
  command->add_option("--from", o.from, "view from this port, beam, receiver or surface, against its light");
  command->add_option("--at", o.at, "frame this object instead of the whole scene")->group("Camera");
  command->add_option("--cut", o.cuts, "remove one side of a plane: x=0 (the side of the eye), \"y>5cm\"")
      ->allow_extra_args(false);
  auto* const flash =
      command->add_flag("--flash", o.flash, "show scattered light and glints of the camera's own flash");
  command->add_option("--lamp", o.lamp, "radius of the flash around the eye; default: 5 mm")->needs(flash);
  command->add_flag("--section", o.section,
                    "section along the axis, with separate scales for both sides of the picture");
  command->add_flag("--beams", o.beams, "draw the main beams, dotted behind what hides them");
  command->add_flag("--whole", o.whole, "also draw the back of walls without material there");
  command->add_option("--threads", o.threads, "default: all cores; does not change the picture");
  command->footer(
      "Examples:\n"
      "  straytrace render examples/bench.yaml -o bench.png\n"
      "  straytrace render examples/end_bench.yaml -o beams.png --at lens --beams\n"
      "  straytrace render examples/virgo_arm.yaml -o view.png --from ITM --fov 2deg\n"
      "  straytrace render examples/virgo_arm.yaml -o flash.png --from ITM --fov 2deg --flash\n"
      "  straytrace render out/run.h5 -o where_not.png --mode importance");
  command->callback([options, &exit_code] { exit_code = render(*options); });
}

// straytrace maps: the light on the receivers of a run, as pictures and numbers.

namespace {

struct MapsOptions {
  std::string input, out;
};

// Of the cells of each receiver within the rim of its surface, m^2. The model is built only for a file that does not
// state them, where a map has cells.
std::vector<std::vector<double>> areas_of(RunFile const& file, std::vector<Receiver> const& receivers) {
  if (!file.about.map_areas.empty()) return file.about.map_areas;
  std::vector<std::vector<double>> areas(receivers.size());
  if (std::ranges::none_of(receivers, [](Receiver const& r) { return r.map_size() > 0; })) return areas;
  Model const model = model_of(file);
  for (std::size_t i = 0; i < receivers.size(); ++i)
    areas[i] = map_areas(model.world.view(), model.world.receivers().at(i).surface, receivers[i]);
  return areas;
}

int maps(MapsOptions const& options) {
  RunFile const file = read_run_file(options.input);
  RunContent const content = file.content();
  if (content.receivers.empty())
    throw InputError(fmt::format("'{}' has no receivers", options.input),
                     "add 'receivers: {PD: {on: SURFACE, map: {...}}}' to the scene and repeat the trace");
  OutputFolder const folder(options.out);
  std::vector<std::string> const files = write_maps(options.out, content, areas_of(file, content.receivers));
  if (files.empty())
    throw InputError(fmt::format("no receiver of '{}' has a map", options.input),
                     "give it 'map', 'angles' or 'quadrants'");
  std::string picture, message;
  for (std::size_t i = 0; i < content.receivers.size() && picture.empty(); ++i)
    if (content.receivers[i].map_size() > 0 || content.receivers[i].angle_bins > 0) {
      picture = file.trace.coupling.receivers[i] + ".png";
      std::replace(picture.begin(), picture.end(), '/', '_');
    }
  bool const drawn =
      picture.empty() || draw_map_pictures(options.input, options.out, options.out + "/" + picture, message);
  for (std::string const& name : files) std::cout << options.out << '/' << name << '\n';
  if (!drawn) std::cerr << "warning: pictures were not drawn: " << message << '\n';
  return done;
}

}  // namespace

void add_maps(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<MapsOptions>();
  MapsOptions& o = *options;
  auto* const command =
      app.add_subcommand("maps", "Write irradiance, angles, fields and quadrants of receivers as CSV, NPY and PNG.");
  command->add_option("run", o.input, "run file (HDF5)")->required();
  command->add_option("-o,--out", o.out, "folder for the maps")->required();
  command->footer(
      "Examples:\n"
      "  straytrace maps out/run.h5 -o out/maps\n"
      "  straytrace maps bench.h5 -o maps/\n"
      "Row 0 is the lowest, column 0 the leftmost, seen from the front of the receiver.");
  command->callback([options, &exit_code] {
    drop_slashes(options->out);
    exit_code = maps(*options);
  });
}

}  // namespace straytrace::cli
