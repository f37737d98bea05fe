// SPDX-License-Identifier: BSD-3-Clause
// Many paths by few spectra: a sample of drawn paths, and a lattice of mixtures of strengths.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/namespaces.hpp"
#include "noise/wrapped/phase_spectra.hpp"

namespace straytrace::noise {

// A few drawn paths represent many, where no grid of strengths interpolates the spectra.

// Strengths of phase modulation of many paths.

// One number kappa per path and class of motion, path by path.
struct Strengths {
  std::size_t classes = 0;
  std::vector<double> kappa;
  std::vector<double> weight;        // power of each path; empty: all equal
  std::vector<std::size_t> first{};  // path of each route, increasing; empty: one route
  std::span<double const> of(std::size_t path) const { return std::span(kappa).subspan(path * classes, classes); }
  std::size_t size() const { return classes ? kappa.size() / classes : weight.size(); }
  double weight_of(std::size_t path) const { return weight.empty() ? 1 : weight[path]; }
};

// Paths of one route and of like strengths are a stratum, from which two are drawn with the chance of their weights.
// Half of its weight times the spectrum of either is unbiased, A and B; (A - B)^2 has the mean of the variance of
// A + B (Cochran, Sampling Techniques, 5A.1). Strata are halved across their widest coordinate, those with the largest
// width times root of noise (as in SpotChecks) first, until two times their number is `most`. Coordinates: ln |kappa|
// of each class, and four times ln of the mean-square fringe rate, by which the tails of wrapped fringes fall. Draws
// are a function of the paths alone.
class StrengthSample {
 public:
  struct Stratum {
    std::size_t first = 0, second = 0;  // drawn paths, possibly equal; of a stratum of a single path, that path
    bool single = false;
  };
  StrengthSample(PhaseSpectra const&, Strengths const&, std::size_t most);

  std::vector<Stratum> const& strata() const { return strata_; }
  std::uint32_t stratum(std::size_t path) const { return of_[path]; }

 private:
  struct Part {
    std::size_t begin, end;  // in `order_`
    double urgency = 0, middle = 0;
    std::size_t axis = 0;
    bool operator<(Part const& other) const { return urgency < other.urgency; }
  };
  void place(PhaseSpectra const&, Strengths const&);
  Part part(std::size_t begin, std::size_t end) const;
  std::vector<Part> parts(Strengths const&, std::size_t most);
  void draw(Strengths const&, Part const&);

  std::size_t axes_;
  std::vector<double> at_;     // coordinates, path by path
  std::vector<double> noise_;  // per path
  std::vector<std::size_t> order_;
  std::vector<std::uint32_t> of_;
  std::vector<Stratum> strata_;
};

// Separate spectra of some paths, compared with the spectra that they share with others.

// Result for one path.
struct SpotCheck {
  std::size_t path = 0;
  // Largest over the bins: |shared - own| over the larger of its own PSD and the mean over the checked paths of its
  // route. Only bins that are fringes within twelve decades of the highest, or mostly first order.
  double error = 0;
  std::size_t bin = 0;
};

// Selection: the path of most noise of each of the routes with most of it, the most moved one of all, and paths at
// equal steps of the sum of noise over all paths. Noise of a path: weight times s/(1 + s), s its mean-square phase.
class SpotChecks {
 public:
  SpotChecks(PhaseSpectra const&, Strengths const&, std::size_t count);
  // `shared`: PSD of a path as it is shared. Increasing numbers of paths.
  std::vector<SpotCheck> compared(std::function<std::vector<double>(std::size_t path)> const& shared) const;

 private:
  struct Own {
    std::size_t path, route;
    bool at_random;  // represents its route
    PhaseSpectrum spectrum;
  };
  std::vector<double> mean(std::size_t route) const;

  std::vector<Own> own_;
};

// Nodes for paths that motion of several shapes moves strongly at once.

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
