// SPDX-License-Identifier: BSD-3-Clause
// The shelf of one stride as a spectrum, and its likelihood (docs/theory/fit.md, shelf edge).
#pragma once

#include <Eigen/Core>

#include <vector>

#include "analysis/fringes/shelf_edge.hpp"

namespace straytrace {

struct ShelfStride {
  double start = 0;
  std::vector<double> hz, psd;  // of the target, one-sided, on the lines of the band
  double weight = 0;            // independent numbers in each line: averages times the share of independent lines
  std::vector<double> x, y;     // witnesses at the model's rate
  double rate = 0;
  std::size_t segment = 0, first = 0;  // samples of the model; first line in the band
};

// x - ratio y.
std::vector<double> motion_of(ShelfStride const&, double ratio);
double fastest(std::vector<double> const& motion, double rate);

// Factors at equal steps of their logarithm.
struct FactorGrid {
  double low = 0, step = 0;  // ln
  int count = 0;
  double at(double place) const { return low + step * place; }
};

// One-sided PSD of sin(phi + factor 4 pi u/lambda), mean over phi, on the lines of the band; a column for each factor.
// Averaged over factors 1 % to either side: how one arch interferes with the next is not told by a power.
Eigen::MatrixXd shelf_shapes(ShelfStride const&, std::vector<double> const& motion, FactorGrid const&,
                             double wavelength);

// S(f) = sum of n_i f^p_i (floor) plus the shape times |T|^2, the response of a port: Bernstein polynomials of ln(f) of
// degree 4 across the band, which rise, fall and bend as responses do and are too broad to make an edge. No coefficient
// is negative.
class ShelfSpectrum {
 public:
  explicit ShelfSpectrum(ShelfStride const&);

  struct Best {
    double twice_log = 0;  // 2 ln L
    Eigen::VectorXd share, model;
  };
  // Largest likelihood of `psd`, from a model that is near it or empty; with an empty shape that of the floor alone.
  Best best(Eigen::Ref<Eigen::VectorXd const> const& psd, Eigen::VectorXd const& shape,
            Eigen::VectorXd model = {}) const;

  double floor(Best const&, double hz) const;     // PSD
  double response(Best const&, double hz) const;  // G^2: PSD of the shelf over its shape

 private:
  Eigen::RowVectorXd floor_terms(double hz) const;
  Eigen::RowVectorXd response_terms(double hz) const;
  Eigen::VectorXd hz_;
  double middle_ = 0, weight_ = 0;
  Eigen::MatrixXd floors_, responses_;  // terms of each line
};

// Errors of a shelf edge by repetition (docs/theory/fit.md, shelf edge).

constexpr double factor_step = 0.005;  // of ln(factor) in a profile

// 2 ln L over ln(factor), best floor and response at each.
struct ShelfProfile {
  FactorGrid grid;
  std::vector<double> twice_log;
  double without = 0;  // shelf
  ShelfSpectrum::Best best;
  std::size_t top() const;
};

// Top of a parabola through the best place and those where the profile has fallen by about 2 to either side.
struct ProfileTop {
  double log_factor = 0, sigma = 0;  // as if the shelf were Gaussian noise
  bool at_end = false;               // of the grid
};
ProfileTop top_of(ShelfProfile const&);

ShelfProfile profile_on(ShelfStride const&, Eigen::Ref<Eigen::VectorXd const> const& psd, Eigen::MatrixXd const& shapes,
                        FactorGrid const&);

// A stride with the edge that was found in it.
struct FoundEdge {
  ShelfStride const* stride = nullptr;
  ProfileTop top;
  ShelfSpectrum::Best best;
};

// Offset and standard deviation of ln(factor), found less true, of each edge and of their weighted mean.
struct RepeatedEdges {
  std::vector<double> offset, sigma;
  double mean = 0, mean_offset = 0, mean_sigma = 0;
};
RepeatedEdges repeated(std::vector<FoundEdge> const&, double ratio, double wavelength);

}  // namespace straytrace
