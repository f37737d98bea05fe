// SPDX-License-Identifier: BSD-3-Clause
#include "world/mode_points.hpp"

#include <Eigen/QR>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "base/document.hpp"

namespace straytrace {
namespace {

class Points final : public ModeShape {
 public:
  Points(std::vector<ModePoint> points, std::size_t neighbours)
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

// Nothing and a problem at the line that is not six numbers.
std::vector<ModePoint> read_rows(Node const& file, std::string const& text, double unit) {
  std::vector<ModePoint> points;
  std::istringstream lines(text);
  std::string line;
  for (std::uint32_t number = 1; std::getline(lines, line); ++number) {
    line.resize(std::min(line.size(), line.find('#')));
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == ',' || c == ';' || c == '\t' || c == '\r'; }, ' ');
    if (line.find_first_not_of(' ') == std::string::npos) continue;
    std::istringstream words(line);
    double v[6];
    std::string rest;
    bool good = true;
    for (double& x : v) good = good && words >> x && std::isfinite(x);
    if (!good || words >> rest) {
      file.file_problem(file.text(), number, 1, "this line is not six numbers",
                        "write x, y, z of the point and the three components of its displacement");
      return {};
    }
    points.push_back({unit * Vec3{v[0], v[1], v[2]}, {v[3], v[4], v[5]}});
  }
  if (points.size() < 4) {
    file.file_problem(file.text(), 0, 0, "a shape needs four points at least", "give more lines");
    return {};
  }
  return points;
}

}  // namespace

std::shared_ptr<ModeShape const> mode_of_points(std::vector<ModePoint> points, std::size_t neighbours) {
  return std::make_shared<Points>(std::move(points), neighbours);
}

std::shared_ptr<ModeShape const> read_mode_points(Node const& shape, std::string& description) {
  Node const file = shape["points"];
  std::string const name = file.as_word(), unit_text = shape.word("unit");
  auto const unit = parse_unit(unit_text);
  if (!unit_text.empty() && (!unit || unit->dimension != dim::length))
    shape["unit"].problem(fmt::format("\"{}\" is not a unit of length", unit_text), "write 'm' or 'mm'");
  if (name.empty() || !unit || unit->dimension != dim::length) return {};
  std::string const text = file.data_file(name);
  if (text.empty() && !file.document()->optional_file(file, name)) return {};  // said by data_file()
  std::vector<ModePoint> points = read_rows(file, text, unit->si);
  if (points.empty()) return {};
  description += unit_text + text;
  return mode_of_points(std::move(points));
}

}  // namespace straytrace
