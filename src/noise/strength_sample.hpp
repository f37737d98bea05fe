// SPDX-License-Identifier: BSD-3-Clause
// Few paths drawn to stand for many, where no nodes of strength follow the spectra.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "noise/phase_spectra.hpp"
#include "noise/strengths.hpp"

namespace straytrace {

// Paths of one route and of like strengths are a stratum, from which two are drawn with the chance of their weights.
// Half of its weight times the spectrum of either is without bias, A and B; (A - B)^2 has the mean of the variance of
// A + B (Cochran, Sampling Techniques, 5A.1). Strata are halved across their widest coordinate, those with the largest
// width times root of noise (as in SpotChecks) first, until two times their number is `most`. Coordinates: ln |kappa|
// of each class, and four times ln of the mean-square fringe rate, by which the tails of wrapped fringes fall. Draws
// are a function of the paths alone.
class StrengthSample {
 public:
  struct Stratum {
    std::size_t first = 0, second = 0;  // drawn paths, which may be one; of a stratum of a single path, that path
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

}  // namespace straytrace
