// SPDX-License-Identifier: BSD-3-Clause
// Paths share spectra: the weighted histogram of ln kappa (requirement R4.08).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "noise/interpolate/strength_sample.hpp"
#include "noise/wrapped/phase_spectra.hpp"

namespace straytrace::noise {

// The spectrum of every path is a sum of a few spectra of nodes. Several strong classes of Gaussian motion:
// MixtureLattice, of at most five times `most` nodes. Else nodes lie on a lattice in ln |kappa| of the strong classes:
// Lagrange polynomials of 9 points for one strong class; for several (tones and drifts among them) polynomials of 5
// points along each and the bilinear cross term of each pair. A drift, whose line moves through the bins, is shared
// between its two neighbours. Weak classes are first order: each path adds kappa times the response of its nodes. That
// step is halved until the spectra of neighbours differ by less than a factor e^0.8 (several classes e^0.4) in every
// bin within twelve decades of the highest and spot checks hold, or the nodes are `most`. When the paths have fewer
// different strengths than that, these are the nodes.
//
// Where spot checks then still fail, up to `direct` different strengths are all computed. Of more, a StrengthSample of
// `direct` paths is: in bins where it has the smaller variance, the draws estimate the residual of the interpolation,
// in the others the spectrum itself. Both are unbiased; the variance is `add_variance`.
class SpectrumInterpolator {
 public:
  struct Options {
    double step = 0.25;         // of ln kappa, at first
    std::size_t most = 400;     // nodes
    bool refine = true;         // false: nodes stay as first placed, even when checks fail
    std::size_t checks = 24;    // paths whose own spectra are computed
    std::size_t direct = 2000;  // paths that are computed individually where checks fail; 0: none are
  };
  // Of SpotCheck::error: above it nodes are refined, then paths computed individually.
  static constexpr double tolerance = 1e-3;
  SpectrumInterpolator(PhaseSpectra const&, Strengths const&, Options);
  SpectrumInterpolator(PhaseSpectra const& spectra, Strengths const& paths)
      : SpectrumInterpolator(spectra, paths, Options()) {}

  // The spectrum of a path is the sum of weight times basis spectrum.
  struct Share {
    std::uint32_t basis;
    double weight;
  };
  void shares(std::size_t path, std::vector<Share>& out) const;  // overwrites `out`

  struct Basis {
    std::vector<double> psd, linear;  // as in PhaseSpectrum
  };
  std::vector<Basis> const& basis() const { return basis_; }
  double step() const { return lattice_.step; }  // that was used; `same`: the strengths themselves
  static constexpr double same = 1e-6;           // strengths whose logarithms agree within this are one
  std::size_t nodes() const { return kappa_.size(); }
  std::vector<SpotCheck> const& checks() const { return found_; }  // empty where paths are their own nodes
  // checks() is then why, or empty where a node was beyond reach of a transform.
  bool sampled() const { return sample_.has_value(); }
  std::size_t drawn() const;  // spectra of single paths that represent all
  // Variance of the PSD by the draws, in the sum of basis spectra with these weights, those of whole routes.
  void add_variance(std::span<double const> weights, std::vector<double>& variance) const;

 private:
  // Per class the rounded position on the lattice times two, plus one where kappa is negative.
  using Address = std::vector<std::int32_t>;
  static constexpr std::int32_t none = INT32_MIN;  // not strong
  struct Hash {
    std::size_t operator()(Address const&) const;
  };
  struct Cell {
    Address at;
    std::vector<std::size_t> strong;   // classes
    std::vector<std::uint32_t> nodes;  // in the order of `offsets`
  };
  struct Lattice {
    double step = 0, drift_step = 0;
    std::vector<Cell> cells;
    std::vector<std::uint32_t> of;  // per path
    double step_of(MotionClass const& c) const { return c.drift ? drift_step : step; }
  };
  bool sort_into(Lattice&, std::size_t most) const;  // false: more cells than that
  void place_nodes(Lattice&);
  std::uint32_t node_at(Lattice const&, Address const&);
  void start(double step, std::size_t most, bool stencils);
  bool halve(std::size_t most);
  bool use_strengths();  // if they are no more than the nodes
  void use_means(Lattice);
  bool any_negative() const;
  // False unless several classes are strong in some path, all of them Gaussian and of no negative kappa.
  bool use_mixture(Options const&);
  bool try_mixture(std::vector<double> const& rate, double least, double step, std::size_t most);
  std::vector<double> square_rates() const;  // per class, 0 where never strong; empty: no mixture
  bool is_mixed(std::size_t c) const { return mixture_ && mixed_[c]; }
  void mixed_shares(std::size_t path, std::vector<Share>& out) const;
  void weigh(Cell const&, std::span<double const> kappa, std::vector<double>& weight) const;
  void compute();
  void forget_nodes();  // but keeps their bases as known
  bool smooth() const;
  bool accurate();  // whether all checks are within the tolerance
  void refine_cells(std::size_t most);
  double position(Cell const&, std::size_t c, double kappa) const;  // in steps from the cell's centre
  void interpolate(Options const&);
  void compute_paths(std::size_t most);
  void use_sample(std::size_t most);
  std::vector<bool> interpolated_bins(std::vector<Basis> const& own, std::vector<Basis> const& shared) const;
  Basis own_spectrum(std::size_t path) const;
  Basis shared_spectrum(std::size_t path) const;

  PhaseSpectra const& spectra_;
  Strengths const& paths_;
  SpotChecks checks_;
  std::vector<SpotCheck> found_;
  std::vector<bool> weak_;  // per class: some path is weak in it
  Lattice lattice_;
  std::unordered_map<Address, std::uint32_t, Hash> node_;
  std::vector<std::vector<double>> kappa_;  // per node, of strong classes
  std::vector<std::uint32_t> first_basis_;  // per node: its own; those of the weak classes follow
  std::vector<Basis> basis_;
  std::map<std::vector<double>, std::vector<Basis>> known_;  // by kappa: bases of nodes of a coarser mixture
  std::optional<MixtureLattice> mixture_;
  std::vector<bool> mixed_;                           // per class
  std::size_t still_ = static_cast<std::size_t>(-1);  // node of paths that are weak in all of them
  std::optional<StrengthSample> sample_;
  bool unshared_ = false;             // no spectra of nodes: drawn ones alone
  std::vector<std::uint32_t> drawn_;  // per stratum: basis of its first draw; that of the second follows
};

}  // namespace straytrace::noise
