// SPDX-License-Identifier: BSD-3-Clause
#include "noise/interpolate/mixture_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/math/constants.hpp"
#include "noise/interpolate/mixture_lattice.hpp"

namespace straytrace::noise {

void MixtureLattice::Axis::place(int points) {
  if (!(high > low + 1e-9)) points = 1;
  for (int k = 0; k < points; ++k) {
    double const cosine = points == 1 ? 0 : std::cos(pi * k / (points - 1));
    at.push_back((low + high) / 2 - (high - low) / 2 * cosine);
    scale.push_back((k % 2 ? -1 : 1) * (k == 0 || k == points - 1 ? 0.5 : 1));
  }
}

void MixtureLattice::Axis::weights(double q, std::vector<double>& out) const {
  out.assign(at.size(), 0);
  double sum = 0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (at.size() == 1 || q == at[k]) {
      out.assign(at.size(), 0);
      out[k] = 1;
      return;
    }
    sum += out[k] = scale[k] / (q - at[k]);
  }
  for (double& w : out) w /= sum;
}

double MixtureLattice::square_rate(std::span<double const> kappa) const {
  double sum = 0;
  for (std::size_t c = 0; c < rate_.size(); ++c) sum += rate_[c] * kappa[c];
  return sum;
}

// Of each axis; 0 where no strength remains.
void MixtureLattice::coordinates(std::span<double const> kappa, std::vector<double>& q) const {
  q.clear();
  double left = rate_[main_] * kappa[main_];
  for (std::size_t i = axes_.size(); i-- > 0;) {
    double const own = rate_[axes_[i].of] * kappa[axes_[i].of];
    left += own;
    q.push_back(left > 0 ? own / left : 0);
  }
  std::ranges::reverse(q);
}

MixtureLattice::MixtureLattice(std::vector<double> rate, std::span<double const> kappa, double least, double step,
                               std::size_t most)
    : rate_(std::move(rate)), least_(least), step_(step) {
  std::size_t const classes = rate_.size();
  std::vector<double> share(classes);
  double low = infinity, high = -infinity;
  for (std::size_t i = 0; i + classes <= kappa.size(); i += classes) {
    double const t = square_rate(kappa.subspan(i, classes));
    if (t < least_) continue;
    for (std::size_t c = 0; c < classes; ++c) share[c] += rate_[c] * kappa[i + c] / t;
    low = std::min(low, t);
    high = std::max(high, t);
  }
  main_ = static_cast<std::size_t>(std::ranges::max_element(share) - share.begin());
  for (std::size_t c = 0; c < classes; ++c)
    if (c != main_ && rate_[c] > 0) axes_.emplace_back().of = c;
  if (!(low <= high)) return;
  lowest_ = static_cast<int>(std::lround(std::log(low) / step_)) - reach;
  std::vector<bool> used(static_cast<std::size_t>(std::lround(std::log(high) / step_)) + 1 + reach - lowest_);
  std::vector<double> q;
  for (std::size_t i = 0; i + classes <= kappa.size(); i += classes) {
    auto const one = kappa.subspan(i, classes);
    double const t = square_rate(one);
    if (t < least_) continue;
    auto const level = std::lround(std::log(t) / step_) - lowest_;
    std::fill(used.begin() + level - reach, used.begin() + level + reach + 1, true);
    coordinates(one, q);
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      axes_[a].low = std::min(axes_[a].low, q[a]);
      axes_[a].high = std::max(axes_[a].high, q[a]);
    }
  }
  place_points(most / static_cast<std::size_t>(std::ranges::count(used, true)));
  for (std::size_t level = 0; level < used.size(); ++level) {
    of_level_.push_back(static_cast<std::uint32_t>(kappa_.size()));
    if (used[level]) add_nodes(lowest_ + static_cast<int>(level));
  }
}

// Fewer on the narrowest axes when there would be more than `most` together.
void MixtureLattice::place_points(std::size_t most) {
  std::vector<Axis*> by_width;
  for (Axis& axis : axes_) by_width.push_back(&axis);
  std::ranges::sort(by_width, [](auto* a, auto* b) { return a->high - a->low < b->high - b->low; });
  std::vector<int> points;
  for (Axis const* axis : by_width)
    points.push_back(std::max(4, 3 + static_cast<int>(std::ceil((most_points - 3) * (axis->high - axis->low)))));
  auto const together = [&] {
    return std::accumulate(points.begin(), points.end(), 1.0, [](double n, int p) { return n * p; });
  };
  for (int fewer = most_points - 1; fewer >= 2; --fewer)
    for (std::size_t a = 0; a < points.size() && together() > static_cast<double>(most); ++a)
      points[a] = std::min(points[a], fewer);
  for (std::size_t a = 0; a < points.size(); ++a) {
    by_width[a]->place(points[a]);
    across_ *= by_width[a]->at.size();
  }
}

// The first axis varies fastest.
void MixtureLattice::add_nodes(int level) {
  for (std::size_t n = 0; n < across_; ++n) {
    std::vector<double>& node = kappa_.emplace_back(rate_.size());
    double left = std::exp(level * step_);
    std::size_t rest = n;
    for (Axis const& axis : axes_) {
      double const own = left * axis.at[rest % axis.at.size()];
      rest /= axis.at.size();
      node[axis.of] = own / rate_[axis.of];
      left -= own;
    }
    node[main_] = std::max(0.0, left) / rate_[main_];
  }
}

void MixtureLattice::shares(std::span<double const> kappa, std::vector<Share>& out) const {
  thread_local std::vector<double> q, one, product;
  double const u = std::log(square_rate(kappa)) / step_;
  auto const level = std::lround(u);
  auto const along = lagrange(u - static_cast<double>(level), reach);
  coordinates(kappa, q);
  product.assign(1, 1);
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    axes_[a].weights(q[a], one);
    std::size_t const inner = product.size();
    product.resize(inner * one.size());
    for (std::size_t k = one.size(); k-- > 0;)
      for (std::size_t i = 0; i < inner; ++i) product[k * inner + i] = product[i] * one[k];
  }
  out.clear();
  for (int k = -reach; k <= reach; ++k) {
    std::uint32_t const first = of_level_[static_cast<std::size_t>(level + k - lowest_)];
    for (std::size_t i = 0; i < across_; ++i)
      out.push_back({first + static_cast<std::uint32_t>(i), along[static_cast<std::size_t>(k + reach)] * product[i]});
  }
}

}  // namespace straytrace::noise
