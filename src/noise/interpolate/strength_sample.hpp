// SPDX-License-Identifier: BSD-3-Clause
// A few drawn paths represent many, where no grid of strengths interpolates the spectra.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "noise/wrapped/phase_spectra.hpp"

namespace straytrace::noise {

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

}  // namespace straytrace::noise
