// SPDX-License-Identifier: BSD-3-Clause
// The field that an input beam builds up in a cavity, at any detuning from one Krylov space (docs/theory/wave.md, eq.
// W.50 to W.52).
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "beams/mode.hpp"
#include "wave/cavity.hpp"

namespace straytrace::wave {

struct MirrorCoating {
  double transmission = 0, loss = 0;  // of power; the loss is absorbed or scattered where the grid does not follow
  double reflectivity() const { return 1 - transmission - loss; }
};

// Powers for an input beam of unit power.
struct DrivenPowers {
  double detuning = 0;         // of the light from the resonance of the fundamental mode, in free spectral ranges
  double circulating = 0;      // that leaves mirror 1 towards mirror 2
  double reflected = 0;        // that leaves mirror 1 outwards: prompt reflection and leakage
  double transmitted = 0;      // by mirror 2
  std::vector<double> orders;  // share of `circulating` in the Gaussian modes of each order, 0, 1, ...
  double error = 0;            // of the field, relative to it, at most: eq. W.51
};

struct DrivenOptions {
  int most_round_trips = 60;
  double error = 1e-4;  // of `DrivenPowers`, at the worst of the detunings
  int highest_order = 2;
  std::function<void(int round_trips, double error)> progress;
};

class DrivenCavity {
 public:
  // `resonance`: eigenvalue of the fundamental mode, whose phase is that of zero detuning; `input`: spectrum of a field
  // of unit power behind mirror 1, which the outline of the mirror clips. Round trips until the error at all
  // `detunings` is small enough, or most_round_trips.
  DrivenCavity(CavityWaves const&, std::array<MirrorCoating, 2>, Complex resonance, Field const& input,
               std::vector<double> const& detunings, DrivenOptions const& = {});

  DrivenPowers at(double detuning) const;
  Field field(double detuning) const;  // its spectrum after mirror 1
  int round_trips() const { return krylov_.steps(); }
  double entered() const { return entered_ * entered_; }  // power of the input within the outline of mirror 1

 private:
  DrivenCavity(CavityWaves const&, std::array<MirrorCoating, 2>, Complex resonance, Eigen::VectorXcd const& entering,
               std::vector<double> const& detunings, DrivenOptions const&);
  struct Solution {
    Eigen::VectorXcd y;
    double error = 0;
  };
  Complex factor(double detuning) const;  // r1 r2 exp(i delta)
  Solution solution(double detuning) const;
  double worst(std::vector<double> const& detunings) const;
  void advance();
  void add_transmitted(Field const& arriving);
  void triangularise();
  void find_orders(int highest_order);

  CavityWaves const& waves_;
  std::array<MirrorCoating, 2> coatings_;
  Complex resonance_;
  double entered_ = 0;  // norm of the input
  Krylov krylov_;
  Eigen::MatrixXcd triangle_, basis_;     // Schur form of the matrix of the Krylov space
  std::vector<Eigen::VectorXcd> behind_;  // fields that arrive at mirror 2, where its mask passes them
  Eigen::MatrixXcd passed_;               // their products: power within the outline of mirror 2
  std::vector<Eigen::MatrixXcd> orders_;  // amplitudes of the Gaussian modes of each order in the vectors
};

// A Gaussian beam as a spectrum behind mirror 1, in the frame of the cavity.
Field gaussian_field(CavityWaves const&, beams::Mode const&);

}  // namespace straytrace::wave
