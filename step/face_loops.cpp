// SPDX-License-Identifier: BSD-3-Clause
#include "step/face_loops.hpp"

#include <BRepAdaptor_Curve.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Precision.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>

namespace straytrace::step {
namespace {

constexpr int deepest = 16;         // halvings of an edge
constexpr double straight = 1e-11;  // m: what is nearer to a straight edge of the chart is one

struct Piece {
  std::vector<ChartPoint> points;  // of one edge, in the direction of the loop
  double outwards = 0;             // m
  double bulge = 0;                // of all arcs between the points of a circle in a plane; 0: straight
};

double off(ChartPoint p, ChartPoint a, ChartPoint b, ChartPoint metric) {  // distance from the edge a to b, m
  double const ux = (b.x - a.x) * metric.x, uy = (b.y - a.y) * metric.y;
  double const wx = (p.x - a.x) * metric.x, wy = (p.y - a.y) * metric.y;
  double const u2 = ux * ux + uy * uy, s = u2 > 0 ? std::clamp((wx * ux + wy * uy) / u2, 0.0, 1.0) : 0;
  return std::hypot(wx - s * ux, wy - s * uy);
}

class EdgeWalk {
 public:
  EdgeWalk(TopoDS_Edge const& edge, TopoDS_Face const& face, Chart const& chart, double tolerance)
      : chart_(chart), tolerance_(tolerance) {
    flat_ = BRep_Tool::CurveOnSurface(edge, face, from_, to_);
    if (!BRep_Tool::Degenerated(edge)) curve_.emplace(edge);
    if (edge.Orientation() == TopAbs_REVERSED) std::swap(from_, to_);
  }
  bool sound() const { return !flat_.IsNull(); }
  Piece walk() {
    ChartPoint const a = at(from_), b = at(to_);
    if (chart_.kind() == Kind::plane && curve_ && curve_->GetType() == GeomAbs_Circle) return arcs();
    Piece piece{{a}, 0};
    halve(from_, a, to_, b, 0, piece.points);
    piece.points.push_back(b);
    piece.outwards = worst_ > straight ? tolerance_ : seam;
    return piece;
  }

 private:
  ChartPoint at(double t) const {
    gp_Pnt2d const uv = flat_->Value(t);
    ChartPoint const near = chart_.of_parameters(uv.X(), uv.Y());
    return curve_ ? chart_.of_point(curve_->Value(t), near) : near;
  }
  Piece arcs() const {
    double const angle = to_ - from_;
    int const parts = std::max(1, int(std::ceil(std::fabs(angle) / 1.6)));  // a quarter or less each
    Piece piece{{}, seam, std::tan(std::fabs(angle) / parts / 4)};
    for (int i = 0; i <= parts; ++i) piece.points.push_back(at(from_ + i * angle / parts));
    ChartPoint const a = piece.points[0], b = piece.points[1], half = at(from_ + 0.5 * angle / parts);
    if ((half.x - a.x) * (b.y - a.y) - (half.y - a.y) * (b.x - a.x) < 0) piece.bulge = -piece.bulge;
    return piece;
  }
  void halve(double ta, ChartPoint a, double tb, ChartPoint b, int depth, std::vector<ChartPoint>& out) {
    double worst = 0;
    for (double share : {0.25, 0.5, 0.75}) {
      ChartPoint const p = at(ta + share * (tb - ta));
      worst = std::max(worst, off(p, a, b, chart_.metric(p)));
    }
    if (worst <= 0.5 * tolerance_ || depth == deepest) {  // the largest lies between the three
      worst_ = std::max(worst_, worst);
      return;
    }
    double const middle = 0.5 * (ta + tb);
    ChartPoint const p = at(middle);
    halve(ta, a, middle, p, depth + 1, out);
    out.push_back(p);
    halve(middle, p, tb, b, depth + 1, out);
    worst_ = std::max(worst_, worst);
  }

  Chart const& chart_;
  double tolerance_, from_ = 0, to_ = 0, worst_ = 0;
  Handle(Geom2d_Curve) flat_;
  std::optional<BRepAdaptor_Curve> curve_;
};

// Points of a piece, each moved to the right of the direction of the loop: across an arc, or the mean of its two edges.
void append_moved(Piece const& piece, Chart const& chart, Loop& out) {
  auto const& p = piece.points;
  for (std::size_t i = 0; i < p.size(); ++i) {
    bool const last = i + 1 == p.size();
    ChartPoint const before = p[i > 0 ? i - 1 : i], after = p[last ? i : i + 1], m = chart.metric(p[i]);
    double dx = (after.x - before.x) * m.x, dy = (after.y - before.y) * m.y;
    if (piece.bulge != 0) {  // the tangent turns by 2 atan(bulge) against the chord, back at its end
      double const chord_x = last ? p[i].x - p[i - 1].x : p[i + 1].x - p[i].x;
      double const chord_y = last ? p[i].y - p[i - 1].y : p[i + 1].y - p[i].y;
      double const turn = (last ? 2 : -2) * std::atan(piece.bulge);
      dx = std::cos(turn) * chord_x - std::sin(turn) * chord_y;
      dy = std::sin(turn) * chord_x + std::cos(turn) * chord_y;
    }
    double const length = std::hypot(dx, dy);
    Corner moved{p[i].x, p[i].y, last ? 0 : piece.bulge};
    if (length > 0) {
      moved.x += piece.outwards * dy / length / m.x;
      moved.y -= piece.outwards * dx / length / m.y;
    }
    out.push_back(moved);
  }
}

void turn_round(std::vector<Piece>& wire) {
  std::reverse(wire.begin(), wire.end());
  for (Piece& piece : wire) {
    std::reverse(piece.points.begin(), piece.points.end());
    piece.bulge = -piece.bulge;
  }
}

// Corners where they are in the file.
Loop plain_loop(std::vector<Piece> const& wire) {
  Loop loop;
  for (Piece const& piece : wire)
    for (std::size_t i = 0; i < piece.points.size(); ++i)
      loop.push_back({piece.points[i].x, piece.points[i].y, i + 1 < piece.points.size() ? piece.bulge : 0});
  return loop;
}

std::size_t edges_in(TopoDS_Wire const& wire) {
  std::size_t n = 0;
  for (TopExp_Explorer e(wire, TopAbs_EDGE); e.More(); e.Next()) ++n;
  return n;
}

// Empty when an edge has no place on the surface or the edges do not follow each other.
std::vector<Piece> pieces_of(TopoDS_Wire const& wire, TopoDS_Face const& face, Chart const& chart, double tolerance,
                             std::function<double(TopoDS_Edge const&)> const& room) {
  std::vector<Piece> pieces;
  for (BRepTools_WireExplorer e(wire, face); e.More(); e.Next()) {
    TopoDS_Edge const& edge = e.Current();
    EdgeWalk walk(edge, face, chart, tolerance);
    if (!walk.sound()) return {};
    Piece piece = walk.walk();
    bool const inner = BRep_Tool::Degenerated(edge) || BRep_Tool::IsClosed(edge, face);  // nothing lies beyond it
    double const loose = BRep_Tool::Tolerance(edge);  // mm, by which the file lets the edge be off the surface
    double const gap = loose > 1.001 * Precision::Confusion() ? loose * mm : 0;
    piece.outwards = inner ? 0 : piece.outwards + gap + room(edge);
    pieces.push_back(std::move(piece));
  }
  if (pieces.size() != edges_in(wire)) return {};
  return pieces;
}

// A face that goes all the way round ends where it began: nothing of it may reach beyond that.
void stay_within_turn(std::vector<Loop> const& plain, double Corner::*across, std::vector<Loop>& moved) {
  double low = plain[0][0].*across, high = low;
  for (Loop const& loop : plain)
    for (Corner const& c : loop) {
      low = std::min(low, c.*across);
      high = std::max(high, c.*across);
    }
  if (high - low < 1 - 1e-9) return;
  for (Loop& loop : moved)
    for (Corner& c : loop) c.*across = std::clamp(c.*across, low, high);
}

}  // namespace

double area_of(std::vector<Loop> const& loops) {
  double area = 0;
  for (Loop const& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      Corner const o = loop[0], p = loop[i], q = loop[(i + 1) % loop.size()];
      area += 0.5 * ((p.x - o.x) * (q.y - o.y) - (q.x - o.x) * (p.y - o.y));
      if (p.bulge == 0) continue;
      double const angle = 4 * std::atan(p.bulge), chord = std::hypot(q.x - p.x, q.y - p.y);
      area += 0.5 * std::pow(chord / (2 * std::sin(angle / 2)), 2) * (angle - std::sin(angle));
    }
  return area;
}

std::optional<std::vector<Loop>> loops_of(TopoDS_Face const& given, Chart const& chart, double tolerance,
                                          std::function<double(TopoDS_Edge const&)> const& room) {
  TopoDS_Face const face = TopoDS::Face(given.Oriented(TopAbs_FORWARD));
  std::vector<std::vector<Piece>> wires;
  std::vector<Loop> plain;
  for (TopExp_Explorer w(face, TopAbs_WIRE); w.More(); w.Next()) {
    wires.push_back(pieces_of(TopoDS::Wire(w.Current()), face, chart, tolerance, room));
    if (wires.back().empty()) return {};
    plain.push_back(plain_loop(wires.back()));
  }
  double const area = area_of(plain);
  if (wires.empty() || area == 0) return {};
  std::vector<Loop> out;
  for (auto& wire : wires) {
    if (area < 0) turn_round(wire);
    Loop& loop = out.emplace_back();
    for (Piece const& piece : wire) append_moved(piece, chart, loop);
  }
  if (chart.kind() != Kind::plane) stay_within_turn(plain, &Corner::x, out);
  if (chart.kind() == Kind::torus) stay_within_turn(plain, &Corner::y, out);
  return out;
}

}  // namespace straytrace::step
