// SPDX-License-Identifier: BSD-3-Clause
// The field that an input beam builds up in a cavity, linear, folded or ring, at any detuning from one Krylov space
// (docs/theory/wave.md, eq. W.50 to W.52).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "base/memory/ids.hpp"
#include "beams/mode.hpp"
#include "wave/cavity.hpp"

namespace straytrace::wave {

// Higher modes of a cavity, order by order, and what they share with Hermite-Gauss and Laguerre-Gauss modes
// (docs/theory/wave.md, Higher modes).

// A mode of the cavity. Modes with one eigenvalue, to the error of the losses, share a span, in which any combination
// is a mode as well: `shared` is what the named mode has in that span, and as many are named as the span has
// dimensions.
struct ModeLine {
  struct Named {
    int one = 0, two = 0;  // HG: n, m; LG: p, l
    double shared = 0;     // power
  };
  int order = 0;
  Named hermite, laguerre;
  double in_order = 0;  // power that it shares with the Gaussian modes of its order
  double loss = 0;      // of power per round trip
  double phase = 0;     // of the round trip, less that of the fundamental mode; turns, -0.5 to 0.5
  double residual = 0;
  int alike = 1;  // modes of this order with its eigenvalue
};

// The modes of all orders up to the highest, by order and loss. An order of which rims take so much that no mode shares
// half of its power with it is left out.
// `hermite_gauss`: spectra of the modes about the axis after the last mirror, by n and m.
std::vector<ModeLine> mode_table(RoundTrip const&, std::function<Field(int n, int m)> const& hermite_gauss,
                                 int highest_order, SolveOptions const& = {});
inline std::vector<ModeLine> mode_table(CavityWaves const& waves, int highest_order, SolveOptions const& options = {}) {
  return mode_table(
      waves.trip(), [&](int n, int m) { return waves.hermite_gauss(n, m); }, highest_order, options);
}

struct MirrorCoating {
  double transmission = 0, loss = 0;  // of power; the loss is absorbed or scattered where the grid does not follow
  double reflectivity() const { return 1 - transmission - loss; }
};

// A mirror with its coating, where the light meets it on its round trip.
struct DrivenMirror {
  std::size_t stop = 0;
  MirrorCoating coating;
};

// Powers for an input beam of unit power.
struct DrivenPowers {
  double detuning = 0;         // of the light from the resonance of the fundamental mode, in free spectral ranges
  double circulating = 0;      // that leaves the input mirror into the cavity
  double reflected = 0;        // that leaves the input mirror outwards: prompt reflection and leakage
  double transmitted = 0;      // by all other mirrors
  std::vector<double> ports;   // of that, by each where the light meets it
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
  using HermiteGauss = std::function<Field(int n, int m)>;  // spectra of the modes behind the input mirror
  // `mirrors`: all of the round trip in the order of the light; the last is the input mirror. `resonance`: eigenvalue
  // of the fundamental mode, whose phase is that of zero detuning; `input`: spectrum of a field of unit power behind
  // the input mirror, whose outline clips it. Round trips until the error at all `detunings` is small enough, or
  // most_round_trips.
  DrivenCavity(RoundTrip const&, std::vector<DrivenMirror> mirrors, HermiteGauss const&, Complex resonance,
               Field const& input, std::vector<double> const& detunings, DrivenOptions const& = {});
  // Through mirror 1 of a linear one.
  DrivenCavity(CavityWaves const&, std::array<MirrorCoating, 2> const&, Complex resonance, Field const& input,
               std::vector<double> const& detunings, DrivenOptions const& = {});

  DrivenPowers at(double detuning) const;
  Field field(double detuning) const;  // its spectrum after the input mirror
  int round_trips() const { return krylov_.steps(); }
  double entered() const { return entered_ * entered_; }  // power of the input within the outline of the input mirror

 private:
  DrivenCavity(RoundTrip const&, std::vector<DrivenMirror>, HermiteGauss const&, Complex resonance,
               Eigen::VectorXcd const& entering, std::vector<double> const& detunings, DrivenOptions const&);
  struct Solution {
    Eigen::VectorXcd y;
    double error = 0;
  };
  // Where light leaves by transmission: the fields that arrive there, where the outline of the mirror passes them, and
  // their products, power within that outline.
  struct Port {
    std::size_t stop = 0;
    double passes = 0;  // of the power that would arrive between perfect mirrors
    std::vector<Eigen::VectorXcd> arriving;
    Eigen::MatrixXcd power;
  };
  Complex factor(double detuning) const;  // product of all r, times exp(i delta)
  Solution solution(double detuning) const;
  double worst(std::vector<double> const& detunings) const;
  void advance();
  void add_transmitted(Port&, Field const& arriving);
  void triangularise();
  void find_orders(int highest_order, HermiteGauss const&);

  RoundTrip const& trip_;
  MirrorCoating input_;
  double size_ = 1;  // product of all r
  Complex resonance_;
  double entered_ = 0;  // norm of the input
  Krylov krylov_;
  Eigen::MatrixXcd triangle_, basis_;  // Schur form of the matrix of the Krylov space
  std::vector<Port> ports_;
  std::vector<Eigen::MatrixXcd> orders_;  // amplitudes of the Gaussian modes of each order in the vectors
};

// What a scan of the detuning gives.
struct DrivenScan {
  // The input mirror, then those that light leaves through, in the order of the light; a folded cavity has some twice.
  std::vector<SurfaceId> surfaces;
  std::vector<MirrorCoating> coatings;
  double free_spectral_range = 0;       // Hz
  double entered = 0;                   // power of the input within the input mirror
  std::vector<double> input_orders;     // its shares in the modes of each order of the mirrors alone; empty: the mode
                                        // of the cavity is the input
  std::vector<DrivenPowers> detunings;  // in the order given
  double error = 0;                     // of the field, at the worst of them, at most
  int round_trips = 0;
  std::vector<std::string> warnings;

  void take(DrivenCavity const&, std::vector<double> const& detunings, DrivenOptions const&);  // with a warning
};

// A Gaussian beam as a spectrum behind mirror 1, in the frame of the cavity.
Field gaussian_field(CavityWaves const&, beams::Mode const&);

}  // namespace straytrace::wave
