// SPDX-License-Identifier: BSD-3-Clause
#include "world/mode_points.hpp"

#include <Eigen/QR>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/number_rows.hpp"

namespace straytrace {
namespace {

class PointsShape final : public ModeShape {
 public:
  PointsShape(std::vector<ModePoint> points, std::size_t neighbours)
      : points_(std::move(points)), neighbours_(std::min(neighbours, points_.size())) {}

  Vec3 at(Vec3 r) const override {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < points_.size(); ++i) order.emplace_back(length2(points_[i].place - r), i);
    std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(neighbours_), order.end());
    double const farthest = order[neighbours_ - 1].first;
    auto const n = Eigen::Index(neighbours_);
    Eigen::MatrixXd a(n, 4), b(n, 3);
    double const size = farthest > 0 ? std::sqrt(farthest) : 1;
    for (Eigen::Index i = 0; i < n; ++i) {
      auto const& [distance2, at] = order[std::size_t(i)];
      double const w = 1 / std::sqrt(distance2 / (size * size) + 1e-12);
      Vec3 const d = (1 / size) * (points_[at].place - r), psi = points_[at].displacement;
      a.row(i) << w, w * d.x, w * d.y, w * d.z;
      b.row(i) << w * psi.x, w * psi.y, w * psi.z;
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-9);
    solver.compute(a);
    Eigen::RowVector3d const value = solver.solve(b).row(0);
    return {value[0], value[1], value[2]};
  }

 private:
  std::vector<ModePoint> points_;
  std::size_t neighbours_;
};

}  // namespace

std::shared_ptr<ModeShape const> mode_of_points(std::vector<ModePoint> points, std::size_t neighbours) {
  return std::make_shared<PointsShape>(std::move(points), neighbours);
}

std::shared_ptr<ModeShape const> read_mode_points(Node const& shape, std::string& description) {
  Node const file = shape["points"];
  std::string const name = file.as_word(), unit_text = shape.word("unit");
  auto const unit = parse_unit(unit_text);
  if (!unit_text.empty() && (!unit || unit->dimension != dim::length))
    shape["unit"].problem(fmt::format("\"{}\" is not a unit of length", unit_text), "write 'm' or 'mm'");
  if (name.empty() || !unit || unit->dimension != dim::length) return {};
  auto const table =
      read_number_rows(file, 6, "write x, y, z of the point and the three components of its displacement");
  if (!table) return {};
  if (table->rows.size() < 4) {
    file.file_problem(name, 0, 0, "a shape needs four points at least", "give more lines");
    return {};
  }
  std::vector<ModePoint> points;
  for (std::vector<double> const& v : table->rows)
    points.push_back({unit->si * Vec3{v[0], v[1], v[2]}, {v[3], v[4], v[5]}});
  description += unit_text + file.data_file(name);
  return mode_of_points(std::move(points));
}

}  // namespace straytrace
