// SPDX-License-Identifier: BSD-3-Clause
#include "report/scene_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "trace/step/path.hpp"
#include "world/ghosts/beam_tree.hpp"

namespace straytrace::report {
namespace {

struct NamedColour {
  std::uint32_t rgb;
  char const* name;
};
constexpr std::array<NamedColour, 24> palette = {
    {{0x1f77b4, "blue"},  {0xd62728, "red"},    {0x2ca02c, "green"}, {0xff7f0e, "orange"}, {0x9467bd, "purple"},
     {0x8c564b, "brown"}, {0xe377c2, "pink"},   {0xbcbd22, "olive"}, {0x17becf, "cyan"},   {0x8a8a8a, "grey"},
     {0xe6b800, "gold"},  {0x2b3a8f, "navy"},   {0x008080, "teal"},  {0x800000, "maroon"}, {0x7fd13b, "lime"},
     {0xff7f6a, "coral"}, {0xc77cff, "violet"}, {0xd2b48c, "sand"},  {0x8ecbff, "sky"},    {0xff5c8a, "rose"},
     {0x5b7f2b, "moss"},  {0x5f7f9f, "steel"},  {0x7a2a6a, "plum"},  {0x7fe0c0, "mint"}}};

Rgb rgb_of(std::uint32_t hex) {
  return {double(hex >> 16 & 255) / 255, double(hex >> 8 & 255) / 255, double(hex & 255) / 255};
}

std::uint32_t hash_of(std::string const& text) {  // FNV-1a
  std::uint32_t h = 2166136261u;
  for (char c : text) h = (h ^ std::uint8_t(c)) * 16777619u;
  return h;
}

std::map<std::string, NamedColour> colours_of(World const& world) {
  std::set<std::string> names;
  for (Surface const& s : world.surfaces()) names.insert(object_of(world.groups()[s.group.value]));
  std::map<std::string, NamedColour> colours;
  std::array<bool, palette.size()> taken = {};
  std::size_t free = palette.size();
  for (std::string const& name : names) {
    std::size_t i = hash_of(name) % palette.size();
    while (free > 0 && taken[i]) i = (i + 1) % palette.size();
    if (!taken[i]) --free;
    taken[i] = true;
    colours[name] = palette[i];
  }
  return colours;
}

std::uint32_t id_colour(GroupId group) { return (group.value + 1) * 0x9e3779u & 0xffffffu; }  // odd: no two alike

std::string group_of(World const& world, SurfaceId id) { return world.name_of(id); }

std::array<std::uint8_t, 3> bytes(Rgb const& c) {
  auto const byte = [](double x) { return std::uint8_t(std::lround(255 * std::clamp(x, 0.0, 1.0))); };
  return {byte(c.r), byte(c.g), byte(c.b)};
}

template <class Colour>
std::vector<std::uint8_t> flat(std::vector<Seen> const& seen, Colour const& colour) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * seen.size());
  for (Seen const& s : seen) {
    Rgb const c = s.surface.valid() ? colour(s) : Rgb{};
    for (std::uint8_t const x : bytes(c)) rgb.push_back(x);
  }
  return rgb;
}

LookSettings without_glass(LookSettings settings) {
  std::replace(settings.looks.begin(), settings.looks.end(), Look::glass, Look::solid);
  return settings;
}

// From dark blue by green to yellow.
Rgb heat(double x) {
  static constexpr Rgb stops[] = {
      {0.27, 0.00, 0.33}, {0.23, 0.32, 0.55}, {0.13, 0.57, 0.55}, {0.37, 0.79, 0.38}, {0.99, 0.91, 0.14}};
  double const at = 4 * std::clamp(x, 0.0, 1.0);
  int const i = std::min(3, int(at));
  Rgb const &a = stops[i], &b = stops[i + 1];
  double const s = at - i;
  return {a.r + s * (b.r - a.r), a.g + s * (b.g - a.g), a.b + s * (b.b - a.b)};
}

}  // namespace

std::string object_of(std::string const& group) { return group.substr(0, group.find('/')); }

Drawn draw_shaded(World const& world, Camera const& camera, LookSettings const& settings) {
  auto const colours = colours_of(world);
  std::vector<Rgb> base;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    base.push_back(rgb_of(colours.at(object_of(group_of(world, {id}))).rgb));
  std::vector<bool> visible;
  Drawn drawn;
  drawn.rgb = shaded(
      world.view(), camera, settings, [&](Seen const& s) { return base[s.surface.value]; }, visible);
  std::set<std::string> names;
  for (std::uint32_t id = 0; id < visible.size(); ++id)
    if (visible[id]) names.insert(object_of(group_of(world, {id})));
  for (std::string const& name : names)
    drawn.legend.push_back({fmt::format("#{:06x}", colours.at(name).rgb), colours.at(name).name, name});
  return drawn;
}

Drawn draw_ids(World const& world, Camera const& camera, LookSettings const& settings) {
  auto const seen = seen_by(world.view(), camera, without_glass(settings));
  std::map<std::string, std::uint32_t> names;
  Drawn drawn;
  drawn.rgb = flat(seen, [&](Seen const& s) {
    std::uint32_t const colour = id_colour(world.surfaces()[s.surface.value].group);
    names[group_of(world, s.surface)] = colour;
    return rgb_of(colour);
  });
  for (auto const& [name, colour] : names) drawn.legend.push_back({fmt::format("#{:06x}", colour), "", name});
  return drawn;
}

Drawn draw_normals(World const& world, Camera const& camera, LookSettings const& settings) {
  Drawn drawn;
  drawn.rgb = flat(seen_by(world.view(), camera, without_glass(settings)), [&](Seen const& s) {
    Vec3 const n = s.normal;
    return Rgb{0.5 + 0.5 * dot(n, camera.right), 0.5 + 0.5 * dot(n, camera.up), 0.5 - 0.5 * dot(n, camera.forward)};
  });
  drawn.scale = "red, green, blue: normal to the right, upwards, towards the eye; 0 to 255 for -1 to 1";
  return drawn;
}

Drawn draw_depths(World const& world, Camera const& camera, LookSettings const& settings) {
  auto const seen = seen_by(world.view(), camera, without_glass(settings));
  double near = infinity, far = 0;
  for (Seen const& s : seen)
    if (s.surface.valid()) {
      near = std::min(near, s.distance);
      far = std::max(far, s.distance);
    }
  Drawn drawn;
  double const range = far > near ? std::log(far / near) : 1;
  drawn.rgb = flat(seen, [&](Seen const& s) {
    double const x = 1 - 0.9 * std::log(s.distance / near) / range;
    return Rgb{x, x, x};
  });
  drawn.scale =
      far > 0 ? fmt::format("white {:.4g} m, grey 26 of 255 {:.4g} m, logarithmic between; black: nothing", near, far)
              : "the picture is empty";
  return drawn;
}

Drawn draw_importance(World const& world, Camera const& camera, LookSettings const& settings) {
  WorldView const view = world.view();
  double low = infinity, high = 0;
  for (std::size_t i = 0; i < view.steering.sides.size; ++i)
    if (double const a = view.steering.sides[i].adjoint; a > 0) {
      low = std::min(low, a);
      high = std::max(high, a);
    }
  low = std::max(low, 1e-9 * high);
  Drawn drawn;
  std::vector<bool> visible;
  drawn.rgb = shaded(
      view, camera, settings,
      [&](Seen const& s) {
        std::uint32_t const patch = patch_of(view, s.surface, s.point, s.piece);
        double const a = patch == WorldView::none ? 0 : view.steering.sides[2 * patch + (s.front ? 0 : 1)].adjoint;
        return a > 0 ? heat(high > low ? std::log(a / low) / std::log(high / low) : 1) : Rgb{0.6, 0.6, 0.6};
      },
      visible);
  if (high > low)
    drawn.bar =
        ColourBar{low, high, "adjoint: score per unit of power that arrives", [](double x) { return bytes(heat(x)); }};
  drawn.scale =
      high > 0
          ? fmt::format("adjoint from {:.3g} (violet) by green to {:.3g} (yellow), logarithmic; grey: none", low, high)
          : "no targets: no light of a second scatter is received";
  return drawn;
}

HaloScale halo_scale(std::vector<HaloSurface> const& surfaces) {
  constexpr double faintest = 1e-6;  // part of the brightest that has a colour of its own
  HaloScale scale{infinity, 0};
  for (HaloSurface const& s : surfaces)
    for (HaloPatch const& p : s.patches)
      if (p.irradiance > 0) scale = {std::min(scale.low, p.irradiance), std::max(scale.high, p.irradiance)};
  if (!(scale.high > 0)) return {};
  return {std::max(scale.low, faintest * scale.high), scale.high};
}

Drawn draw_halo(World const& world, Camera const& camera, LookSettings const& settings, HaloLight const& light,
                double power) {
  constexpr int rings = 64;  // of the scale; the picture has those of the field
  std::vector<HaloSurface> const surfaces = light.surfaces(rings);
  auto const [low, high] = halo_scale(surfaces);
  Drawn drawn;
  std::map<std::string, double> objects;
  drawn.halo_in_watts = power > 0;
  double const unit = power > 0 ? power : 1;
  for (HaloSurface const& s : surfaces) objects[object_of(group_of(world, s.surface))] += unit * s.share;
  for (auto const& [name, on] : objects) drawn.halo.push_back({name, on});
  std::ranges::stable_sort(drawn.halo, std::greater{}, &HaloOn::power);
  std::vector<bool> visible;
  drawn.rgb = shaded(
      world.view(), camera, settings,
      [&, low = low, high = high](Seen const& s) {
        double const e = light.on(s.surface, s.point, s.front);
        return e > 0 ? heat(high > low ? std::log(e / low) / std::log(high / low) : 1) : Rgb{0.6, 0.6, 0.6};
      },
      visible, 1);
  if (high > low)
    drawn.bar = ColourBar{unit * low, unit * high,
                          power > 0 ? "irradiance: watts per square metre" : "share of the mode per square metre",
                          [](double x) { return bytes(heat(x)); }};
  drawn.scale = high > 0 ? fmt::format(
                               "light at small angles from {:.3g} (violet) by green to {:.3g} {} (yellow), "
                               "logarithmic; grey: none",
                               unit * low, unit * high, power > 0 ? "W/m^2" : "of the power of the mode per m^2")
                         : "no light at small angles falls on surfaces";
  return drawn;
}

namespace {

// The film: yellow is the brightest scattered light, black four decades below, white one above, where glints are.
constexpr double below = 4;

// From black by red and yellow to white, 0 to 1.
void burn(double x, std::vector<std::uint8_t>& rgb) {
  for (double const from : {0.0, 0.4, 0.8})
    rgb.push_back(std::uint8_t(std::lround(255 * std::clamp((x - from) / (from < 0.8 ? 0.4 : 0.2), 0.0, 1.0))));
}

}  // namespace

Drawn draw_flash(World const& world, Camera const& camera, LookSettings const& settings, Flash const& flash) {
  std::vector<FlashLight> const picture = flash_picture(world.view(), camera, flash, settings);
  double brightest = 0, glint = 0;
  std::map<std::string, Shine> objects;
  Drawn drawn;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    FlashLight const& light = picture[i];
    brightest = std::max(brightest, light.scattered);
    glint = std::max(glint, light.glint);
    if (!light.first.valid()) continue;
    Shine& object = objects[object_of(world.name_of(light.first))];
    double const angle = solid_angle(camera, std::uint32_t(i % camera.columns), std::uint32_t(i / camera.columns));
    object.scattered += light.scattered * angle;
    object.glint += light.glint * angle;
  }
  double const yellow = brightest > 0 ? brightest : glint;
  for (FlashLight const& light : picture)
    burn(light.both() > 0 ? 0.8 + 0.8 / below * std::log10(light.both() / yellow) : 0, drawn.rgb);
  for (auto& [name, object] : objects) {
    if (!(object.scattered + object.glint > 0)) continue;
    object.object = name;
    drawn.shine.push_back(object);
  }
  std::stable_sort(drawn.shine.begin(), drawn.shine.end(),
                   [](Shine const& a, Shine const& b) { return a.scattered + a.glint > b.scattered + b.glint; });
  drawn.scale = yellow > 0 ? fmt::format(
                                 "radiance over the intensity of the flash: yellow {:.3g} /m^2, black 1e-{:.0f} of it "
                                 "or less, logarithmic; white: glints, up to {:.3g} /m^2",
                                 yellow, below, glint)
                           : "no light returns";
  return drawn;
}

namespace {

constexpr double faintest_beam = 1e-12;  // of the launched power
constexpr std::array<int, 3> beam_red{192, 0, 0};
constexpr double half_line = 1.0;             // px
constexpr double dot_period = 7, dot_on = 3;  // px, of hidden parts
constexpr double hidden_ink = 0.45;

class Straight : public BeamSink {
 public:
  Straight(BeamLaunch const& launch, Box const& box, std::vector<BeamLine>& lines)
      : start_(launch.mode.origin), box_(box), lines_(lines) {}
  void arrived(BeamSpot const& spot, std::uint32_t /*number*/, std::span<BeamStep const> way) override {
    lines_.push_back({way.empty() ? start_ : way.back().point, spot.mode.origin});
  }
  void ended(BeamEnd end, BeamSpot const* spot, LeavingBeam const& beam, std::span<BeamStep const> way) override {
    if (end != BeamEnd::escaped || spot) return;
    Vec3 const from = way.empty() ? start_ : way.back().point;
    lines_.push_back({from, from + length(box_.upper - box_.lower) * beam.mode.travel});
  }

 private:
  Vec3 start_;
  Box const& box_;
  std::vector<BeamLine>& lines_;
};

struct PicturePlace {
  double column = 0, row = 0, distance = 0;  // px; m along the ray of the camera
};

// Where the camera sees a point; none: behind it, or beyond a round picture. The inverse of Camera::ray.
std::optional<PicturePlace> place_in(Camera const& c, Vec3 point) {
  Vec3 const v = point - c.eye;
  double x = dot(v, c.right), y = dot(v, c.up), distance = length(v);
  double const ahead = dot(v, c.forward);
  if (c.lens == Camera::Lens::perspective) {
    if (!(ahead > 1e-9 * distance)) return {};
    x /= ahead, y /= ahead;
  } else if (c.lens == Camera::Lens::flat) {
    distance = ahead;
  } else {
    double const across = std::sqrt(x * x + y * y), angle = std::atan2(across, ahead);
    if (angle > std::min(c.half_width, c.half_height)) return {};
    double const scale = across > 0 ? angle / across : 0;
    x *= scale, y *= scale;
  }
  return PicturePlace{0.5 * (x / c.half_width + 1) * c.columns, 0.5 * (1 - y / c.half_height) * c.rows, distance};
}

// Lines of the width of a pen, with soft edges: the share of the ink in each pixel.
class Pen {
 public:
  Pen(WorldView const& world, Camera const& camera, LookSettings const& settings)
      : world_(world), camera_(camera), settings_(settings), ink_(std::size_t{camera.columns} * camera.rows) {}

  void draw(BeamLine const& line) {
    drawn_ = 0;
    before_.reset();
    divide(line.from, place_in(camera_, line.from), line.to, place_in(camera_, line.to), 0);
  }
  void blend(std::vector<std::uint8_t>& rgb) const {
    for (std::size_t i = 0; i < ink_.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        double const old = rgb[3 * i + k];
        rgb[3 * i + k] = std::uint8_t(std::lround(old + ink_[i] * (beam_red[k] - old)));
      }
  }

 private:
  using Place = std::optional<PicturePlace>;

  // Halves until a piece is shorter than half a pixel: lines are curved in round pictures.
  void divide(Vec3 a, Place const& at_a, Vec3 b, Place const& at_b, int depth) {
    constexpr int deepest = 40;
    if ((!at_a && !at_b) || depth > deepest || beside(at_a, at_b)) return;
    if (at_a && at_b && std::hypot(at_a->column - at_b->column, at_a->row - at_b->row) < 0.5) return dab(b, *at_b);
    Vec3 const middle = 0.5 * (a + b);
    Place const at = place_in(camera_, middle);
    divide(a, at_a, middle, at, depth + 1);
    divide(middle, at, b, at_b, depth + 1);
  }
  bool beside(Place const& a, Place const& b) const {
    if (!a || !b || camera_.lens == Camera::Lens::fisheye) return false;
    double const margin = 2;
    return std::max(a->column, b->column) < -margin || std::min(a->column, b->column) > camera_.columns + margin ||
           std::max(a->row, b->row) < -margin || std::min(a->row, b->row) > camera_.rows + margin;
  }
  void dab(Vec3 point, PicturePlace const& at) {
    if (before_) drawn_ += std::hypot(at.column - before_->column, at.row - before_->row);
    before_ = at;
    if (std::ranges::any_of(settings_.cuts, [&](Cut const& cut) { return dot(point, cut.normal) > cut.offset; }))
      return;
    bool const hidden = is_hidden(at);
    if (hidden && std::fmod(drawn_, dot_period) > dot_on) return;
    double const strength = hidden ? hidden_ink : 1;
    int const reach = int(std::ceil(half_line)) + 1, column = int(std::floor(at.column)), row = int(std::floor(at.row));
    for (int y = std::max(row - reach, 0); y <= std::min(row + reach, int(camera_.rows) - 1); ++y)
      for (int x = std::max(column - reach, 0); x <= std::min(column + reach, int(camera_.columns) - 1); ++x) {
        double const off = std::hypot(x + 0.5 - at.column, y + 0.5 - at.row);
        double& ink = ink_[std::size_t(y) * camera_.columns + std::size_t(x)];
        ink = std::max(ink, strength * std::clamp(half_line + 0.5 - off, 0.0, 1.0));
      }
  }
  bool is_hidden(PicturePlace const& at) const {
    constexpr double nearer = 1e-4;  // of the distance: a beam ends on what it lights
    Ray const ray = camera_.ray(at.column, at.row);
    if (!(ray.t_max > 0)) return true;
    Sight const s = sight(world_, ray, camera_.from, settings_);
    return s.solid.surface.valid() && s.solid.distance < (1 - nearer) * at.distance;
  }

  WorldView const& world_;
  Camera const& camera_;
  LookSettings const& settings_;
  std::vector<double> ink_;  // 0 to 1
  double drawn_ = 0;         // px of this line
  Place before_;
};

}  // namespace

std::vector<BeamLine> beam_lines(World const& world) {
  std::vector<BeamLine> lines;
  WorldView const view = world.view();
  Box const box = bounds_of(view, [](SurfaceId) { return true; });
  std::map<std::uint32_t, Vec3> standing;  // last spot of the mode of a beam
  for (Footprint const& f : world.footprints()) {
    if (!f.standing) continue;
    if (auto const before = standing.find(f.beam); before != standing.end())
      lines.push_back({before->second, f.centre});
    standing[f.beam] = f.centre;
  }
  TreeLimits limits;
  limits.order = 0;
  for (BeamLaunch const& launch : launches(world)) {
    limits.floor = faintest_beam * launch.passes;
    Straight sink(launch, box, lines);
    grow_tree(world, launch, limits, sink);
  }
  return lines;
}

void draw_beams(Drawn& drawn, World const& world, Camera const& camera, LookSettings const& settings,
                std::vector<BeamLine> const& lines) {
  WorldView const view = world.view();
  Pen pen(view, camera, settings);
  for (BeamLine const& line : lines) pen.draw(line);
  pen.blend(drawn.rgb);
  if (!lines.empty()) drawn.legend.push_back({"#c00000", "crimson", "main beams; dotted: hidden"});
}

}  // namespace straytrace::report
