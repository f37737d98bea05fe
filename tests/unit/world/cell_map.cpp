// SPDX-License-Identifier: BSD-3-Clause
// Cells of surface maps: they fill the chart, are fine where the light is, and hold a number of places in proportion to
// their area.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "base/every_module.hpp"
#include "base/math/functions.hpp"
#include "world/model/receiver.hpp"
#include "world/model/world.hpp"

namespace straytrace {
namespace {

using Places = std::vector<WeightedPlace>;

// Uniform in area on an annulus.
Places even(double inner, double outer, std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  Places all;
  for (std::size_t i = 0; i < count; ++i) {
    double const u = unit(random), v = unit(random);
    all.push_back({{std::sqrt(inner * inner + u * (outer * outer - inner * inner)), pi * (2 * v - 1)}});
  }
  return all;
}

// A Gaussian spot of 1/e^2 radius w about (x, y): each coordinate is normal with w/2.
Places spot(double x, double y, double w, std::size_t count, bool polar) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0, w / 2);
  Places all;
  for (std::size_t i = 0; i < count; ++i) {
    double const a = x + normal(random), b = y + normal(random);
    all.push_back({polar ? MapPlace{std::hypot(a, b), std::atan2(b, a)} : MapPlace{a, b}});
  }
  return all;
}

std::vector<std::size_t> counted(CellTree const& tree, Places const& places) {
  std::vector<std::size_t> count(tree.cells().size());
  for (WeightedPlace const& p : places) ++count[tree.at(p.place)];
  return count;
}

bool same(MapCell const& a, MapCell const& b) {
  return a.u_low == b.u_low && a.u_high == b.u_high && a.v_low == b.v_low && a.v_high == b.v_high;
}

struct Case {
  Chart chart;
  MapCell whole;
  Places places;
};
std::vector<Case> cases() {
  return {{Chart::plane, {-0.01, 0.01, -0.01, 0.01}, spot(0.003, -0.002, 1e-4, 4000, false)},
          {Chart::polar, {0.4, 0.5, -pi, pi}, even(0.4, 0.5, 4000)},
          {Chart::polar, {0, 0.01, -pi, pi}, spot(0.003, -0.002, 1e-4, 4000, true)},
          {Chart::unrolled, {0, 1e4, -pi, pi}, {{{1, 1}}, {{1, 1}}, {{1, 1}}, {{9e3, -3}}}}};
}

// Area of a surface from the filled parts of its cells: the closed form to 0.5 %. Control: whole cells, which reach
// beyond the rim.
TEST(CellMap, CellsEndAtTheRim) {
  World world;
  std::uint32_t const optic = world.add_optic({});
  Pose const pose{{0.3, -0.2, 5}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  auto const add = [&](auto shape) {
    shape.place(pose);
    return world.add_surface(shape, optic, optic, {}, world.add_group("g"));
  };
  Ellipse ellipse;
  ellipse.semi_x = 0.04;
  ellipse.semi_y = 0.03;
  Conic conic;
  conic.outer_radius = 0.05;
  conic.inner_radius = 0.02;
  Disk ring;
  ring.outer_radius = 0.05;
  ring.inner_radius = 0.02;
  Cylinder wall;
  wall.radius = 0.1;
  wall.to = 2;
  Cone cone;
  cone.inner_radius = 0.02;
  cone.outer_radius = 0.05;
  cone.half_angle = 0.1;
  double const annulus = pi * (0.05 * 0.05 - 0.02 * 0.02);
  struct Expected {
    SurfaceId id;
    double area;
    bool exact;  // whole cells are right already
  };
  double const length = 0.03 / std::tan(0.1);  // m, of the cone along its axis; unrolled without its slope
  for (auto const& [id, area, exact] :
       {Expected{add(ellipse), pi * 0.04 * 0.03, false}, Expected{add(conic), annulus, false},
        Expected{add(ring), annulus, true}, Expected{add(wall), 2 * pi * 0.1 * 2, true},
        Expected{add(cone), 2 * pi * 0.035 * length, false}}) {
    WorldView const view = world.view();
    auto const [chart, whole] = chart_of(view, std::span(&id, 1));
    CellTree tree(chart, whole);
    Places everywhere;
    for (int i = 0; i < 64; ++i)
      for (int k = 0; k < 64; ++k)
        everywhere.push_back({{whole.u_low + (i + 0.5) / 64 * (whole.u_high - whole.u_low),
                               whole.v_low + (k + 0.5) / 64 * (whole.v_high - whole.v_low)}});
    tree.refine(everywhere, 16, 256);
    double filled = 0, all = 0;
    std::size_t beyond = 0;
    for (MapCell const& c : tree.cells()) {
      double const share = filled_share(view, id, chart, c);
      filled += share * area_of(chart, c);
      all += area_of(chart, c);
      beyond += share == 0;
    }
    EXPECT_NEAR(filled / area, 1, 5e-3);
    EXPECT_EQ(std::fabs(all / area - 1) < 5e-3, exact) << "control: whole cells";
    EXPECT_EQ(beyond > 0, !exact);
  }
}

}  // namespace

TEST(CellMap, FillsTheChartAndHoldsEveryPlaceOnce) {
  for (Case const& c : cases()) {
    CellTree tree(c.chart, c.whole);
    tree.refine(c.places, 24, 300);
    double area = 0;
    for (MapCell const& cell : tree.cells()) area += area_of(c.chart, cell);
    EXPECT_NEAR(area / area_of(c.chart, c.whole), 1, 1e-12);
    for (auto const& [p, weight] : c.places) {
      MapCell const& cell = tree.cells()[tree.at(p)];
      EXPECT_TRUE(cell.u_low <= p.u && p.u <= cell.u_high && cell.v_low <= p.v && p.v <= cell.v_high);
    }
    EXPECT_LE(tree.cells().size(), 300u);
  }
}

TEST(CellMap, IsAFunctionOfThePlacesAlone) {
  for (Case c : cases()) {
    CellTree one(c.chart, c.whole), other(c.chart, c.whole);
    one.refine(c.places, 24, 1000);
    std::reverse(c.places.begin(), c.places.end());
    other.refine(c.places, 24, 1000);
    ASSERT_EQ(one.cells().size(), other.cells().size());
    for (std::size_t i = 0; i < one.cells().size(); ++i) EXPECT_TRUE(same(one.cells()[i], other.cells()[i]));
  }
}

TEST(CellMap, IsBoundedWhereAllPlacesAreOne) {
  CellTree tree(Chart::plane, {-1, 1, -1, 1});
  tree.refine(Places(100000, WeightedPlace{{0.3, 0.7}}), 24, 1000);
  EXPECT_EQ(tree.cells().size(), 25u);
}

// One strong place among many faint ones is a single event: a cell that contains it is not full.
TEST(CellMap, CountsPlacesByTheirWeight) {
  Places all = even(0.4, 0.5, 1000);
  all[0].weight = 1e6;
  CellTree tree(Chart::polar, {0.4, 0.5, -pi, pi}), control(Chart::polar, {0.4, 0.5, -pi, pi});
  tree.refine(all, 24, 512);
  EXPECT_EQ(tree.cells().size(), 1u);
  all[0].weight = 1;
  control.refine(all, 24, 512);
  EXPECT_GT(control.cells().size(), 40u);
}

// Even light on an annulus: density N / (pi (b^2 - a^2)) in every cell, those at the rims too. Chi-squared of n cells
// has mean n - 1 and variance 2 (n - 1); the cells are made by other places than those that fill them.
TEST(CellMap, UniformLightIsUniformUpToTheEdge) {
  double const inner = 0.2, outer = 0.5;
  Places all = even(inner, outer, 60000), pilot(all.begin(), all.begin() + 12000);
  all.erase(all.begin(), all.begin() + 12000);
  CellTree tree(Chart::polar, {inner, outer, -pi, pi});
  tree.refine(pilot, 100, 1024);
  std::vector<std::size_t> const count = counted(tree, all);
  ASSERT_GT(count.size(), 100u);
  auto const chi_squared = [&](std::function<double(MapCell const&)> const& area) {
    double sum = 0, whole = 0;
    for (MapCell const& c : tree.cells()) whole += area(c);
    for (std::size_t i = 0; i < count.size(); ++i) {
      double const expected = double(all.size()) * area(tree.cells()[i]) / whole;
      sum += (double(count[i]) - expected) * (double(count[i]) - expected) / expected;
    }
    auto const free = double(count.size() - 1);
    return (sum - free) / std::sqrt(2 * free);
  };
  EXPECT_LT(std::fabs(chi_squared([](MapCell const& c) { return area_of(Chart::polar, c); })), 5);
  EXPECT_GT(chi_squared([](MapCell const& c) { return area_of(Chart::plane, c); }), 20);  // negative control: squares
}

// A spot of 0.1 mm on a sensor of 2 cm: within r of its centre is 1 - exp(-2 r^2/w^2) of the light (eq. 0.6), and cells
// say so to the binomial error and their own width. Negative control: the squares of an even grid of 13 by 13.
TEST(CellMap, SmallSpotIsSeen) {
  double const w = 1e-4, x = 0.003, y = -0.002;
  Places const places = spot(x, y, w, 4000, false);
  CellTree tree(Chart::plane, {-0.01, 0.01, -0.01, 0.01});
  tree.refine(places, 24, 1024);
  auto const within = [&](double r, auto const& centre_of) {
    double inside = 0;
    for (WeightedPlace const& p : places) {
      MapPlace const c = centre_of(p.place);
      inside += std::hypot(c.u - x, c.v - y) < r ? 1 : 0;
    }
    return inside / double(places.size());
  };
  auto const cell_centre = [&](MapPlace p) {
    MapCell const& c = tree.cells()[tree.at(p)];
    return MapPlace{0.5 * (c.u_low + c.u_high), 0.5 * (c.v_low + c.v_high)};
  };
  auto const square_centre = [](MapPlace p) {
    double const side = 0.02 / 13;
    auto const middle = [&](double u) { return (std::floor((u + 0.01) / side) + 0.5) * side - 0.01; };
    return MapPlace{middle(p.u), middle(p.v)};
  };
  for (double const r : {0.5 * w, w}) {
    double const expected = 1 - std::exp(-2 * r * r / (w * w));
    EXPECT_NEAR(within(r, cell_centre), expected, 0.05);
    EXPECT_GT(std::fabs(within(r, square_centre) - expected), 0.3);
  }
}

}  // namespace straytrace
