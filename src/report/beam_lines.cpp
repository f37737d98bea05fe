// SPDX-License-Identifier: BSD-3-Clause
#include "report/beam_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include "world/ghosts/beam_tree.hpp"

namespace straytrace::report {
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
