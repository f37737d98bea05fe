// SPDX-License-Identifier: BSD-3-Clause
// Effective motion from the edge of the fringe-noise shelf (requirements R2.40, R2.41): edge = factor * 2
// v_max/lambda (docs/theory/spectra.md, eq. 7.1, 7.2), stride by stride. Only powers are compared, so that static
// phase, drift and delays below a segment do not matter.
#pragma once

#include <Eigen/Core>

#include <vector>

#include "analysis/fringes/fringe_fit.hpp"

namespace straytrace::analysis {

struct ShelfEdgeSettings {
  double low = 0, high = 0;  // Hz, band: the edge is searched inside
  double wavelength = 1064e-9;
  double stride = 10, segment = 1;  // s: one edge each; one periodogram each (Hann, half overlap)
  SearchRange factor{0.2, 3};       // on the motion, in units of 2k: 1 is a single bounce at normal incidence
  SearchRange ratio;                // of the second witness; free: the same for all strides
  double false_alarm = 1e-3;
};

struct EdgeStride {
  double start = 0;      // GPS s
  double predicted = 0;  // Hz, 2 v_max/lambda in the stride
  Fitted factor;         // measured edge over predicted one
  double gain = 0;       // of twice the log-likelihood over a floor without shelf
  double amplitude = 0;  // G of h = G sin(phi) at the edge, in units of the target
  bool significant = false;
};

struct ShelfEdgeFit {
  std::vector<EdgeStride> strides;
  Fitted factor;  // weighted mean, error by repetition; it grows with the scatter of the strides when that is larger,
                  // and with the error of a free ratio
  Fitted of_likelihood;  // weighted mean and error of the likelihood alone, which assumes a shelf of Gaussian noise
  Fitted ratio;
  double chi2 = 0;       // of the strides about the mean
  std::size_t used = 0;  // significant strides
};

// Whittle likelihood of Welch spectra; model: |T(f)|^2 of a port times the spectrum of sin(phi + theta), mean over the
// static phase, plus a floor n_0 + n_2 f^-2 + n_4 f^-4 with no negative part; |T|^2 is any smooth positive function.
// Errors and offsets follow from the same fit to simulated records of the fitted model (docs/theory/fit.md). Throws
// InputError as fit_fringes.
ShelfEdgeFit fit_shelf_edge(FringeRecords const&, ShelfEdgeSettings const&);

// The shelf of one stride as a spectrum, and its likelihood (docs/theory/fit.md, shelf edge).

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
// Averaged over factors 1 % to either side: a power contains no interference between arches.
Eigen::MatrixXd shelf_shapes(ShelfStride const&, std::vector<double> const& motion, FactorGrid const&,
                             double wavelength);

// S(f) = sum of n_i f^p_i (floor) plus the shape times |T|^2, the response of a port: Bernstein polynomials of ln(f) of
// degree 4 across the band, which follow the shape of a response and are too broad to form an edge. No coefficient
// is negative.
class ShelfSpectrum {
 public:
  explicit ShelfSpectrum(ShelfStride const&);

  struct Best {
    double twice_log = 0;  // 2 ln L
    Eigen::VectorXd share, model;
  };
  // Largest likelihood of `psd`, from a nearby model or an empty one; with an empty shape that of the floor alone.
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

// A stride and its edge.
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

}  // namespace straytrace::analysis
