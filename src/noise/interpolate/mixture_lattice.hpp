// SPDX-License-Identifier: BSD-3-Clause
// Nodes for paths that motion of several shapes moves strongly at once.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::noise {

// Far from linear coupling a spectrum falls as exp(-f^2 / 2 sigma^2), sigma the rms fringe rate: decades for a small
// change of any strength, but little as long as sigma stays. So the coordinates are u = ln of the square fringe rate T
// = sum K_c, K_c = rate_c kappa_c, and shares of it, q_i = K_i / (T - K_1 - ... - K_(i-1)), which lie between 0 and 1
// and in which kappa is a polynomial. Nodes: a lattice of constant step in u, of which a path uses the nine nearest,
// times Chebyshev-Lobatto points between the least and the largest q_i of all paths, of which it uses all.
class MixtureLattice {
 public:
  struct Share {
    std::uint32_t node;
    double weight;
  };
  // rate: per class, positive for those that count, of which there are at least two; kappa: path by path, one per
  // class, not negative. Paths whose T is below `least` are left out.
  // `most`: nodes, unless two points on each axis are more.
  MixtureLattice(std::vector<double> rate, std::span<double const> kappa, double least, double step, std::size_t most);

  std::size_t size() const { return kappa_.size(); }
  std::vector<std::vector<double>> const& kappa() const { return kappa_; }  // of the nodes, zero in other classes
  bool holds(std::span<double const> kappa) const { return square_rate(kappa) >= least_; }
  void shares(std::span<double const> kappa, std::vector<Share>& out) const;  // replaces `out`; of a path that it holds
  double step() const { return step_; }
  std::size_t across() const { return across_; }  // nodes of one u; those of the next follow, unless no path needs it

 private:
  struct Axis {
    std::size_t of;                 // class
    double low = 1, high = 0;       // of q
    std::vector<double> at, scale;  // points and their barycentric weights
    void place(int points);
    void weights(double q, std::vector<double>& out) const;
  };
  static constexpr int reach = 4, most_points = 9;
  double square_rate(std::span<double const> kappa) const;
  void coordinates(std::span<double const> kappa, std::vector<double>& q) const;
  void place_points(std::size_t most);  // of all axes, for one u
  void add_nodes(int level);

  std::vector<double> rate_;
  double least_, step_;
  std::size_t main_ = 0;  // class with the largest share
  std::vector<Axis> axes_;
  std::size_t across_ = 1;               // nodes of one u
  int lowest_ = 0;                       // level of u
  std::vector<std::uint32_t> of_level_;  // first node of each level from the lowest
  std::vector<std::vector<double>> kappa_;
};

// Interpolation on a lattice of constant step.

// Lagrange polynomials of the points -m...m at x; m <= 4.
inline std::array<double, 9> lagrange(double x, int m) {
  std::array<double, 9> out{};
  int const n = 2 * m + 1;
  std::array<double, 10> left{};
  left[0] = 1;
  for (int k = 0; k < n; ++k) left[k + 1] = left[k] * (x - (k - m));
  double right = 1;
  for (int k = n; k-- > 0;) {
    double denominator = 1;
    for (int j = 1; j <= k; ++j) denominator *= j;
    for (int j = 1; j < n - k; ++j) denominator *= -j;
    out[k] = left[k] * right / denominator;
    right *= x - (k - m);
  }
  return out;
}

}  // namespace straytrace::noise
