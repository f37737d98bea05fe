// SPDX-License-Identifier: BSD-3-Clause
// The way of the light once around a cavity, linear, folded or ring, and the modes that come back to themselves
// (docs/theory/wave.md, eq. W.8, W.9, W.24, W.53 to W.55).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "wave/krylov.hpp"
#include "wave/passages.hpp"
#include "wave/plane.hpp"
#include "wave/wave_device.hpp"

namespace straytrace::wave {

// What the light meets at the end of a leg: an opening, or a mirror with this outline. Coordinates are those of the
// light that comes; a mirror leaves them as they are, so that behind it they are those of the image of the frame.
struct TripStop {
  double leg = 0;     // from the stop before it, m
  RoundHole opening;  // of a mirror: its outline
  std::optional<WaveMirror> mirror;
  double scale = 1;  // pitch of the grid over that at the last stop, where it is 1 (eq. W.54)
  double lit = 0;    // m, distance from the axis up to which light beside the opening is wanted
};
struct Trip {
  double wavelength = 0;        // m
  Grid grid;                    // at the last stop
  std::vector<TripStop> stops;  // the last is the mirror where the round trip begins
  bool mirrored = false;        // x of the frame that comes back is -x of that of the start (eq. W.53)
};

// A Gaussian beam along one axis across it: 1/e^2 radius [m], and curvature of the wavefront [1/m], positive where it
// diverges; centre [m] and direction of travel [rad].
struct AxisBeam {
  double radius = 0, curvature = 0, centre = 0, slope = 0;
};

// Where the power of a field of unit power goes in one round trip (eq. W.24).
struct TripLosses {
  std::vector<double> taken;  // by each stop; by a mirror: beyond its outline, and scattered beyond the crossover angle
  double beyond_band = 0;     // at angles that reach no opening
  double total() const;
};

// A mode of the cavity without the transmission of its mirrors: after the reflection by the last mirror of the round
// trip, in the plane of it.
struct WaveMode {
  Complex eigenvalue;                                        // of the round trip, without exp(ikL) of its length
  double residual = 0;                                       // norm of G E - gamma E (eq. W.9)
  int round_trips = 0;                                       // that the search took
  Field spectrum;                                            // of unit power
  double loss() const { return 1 - std::norm(eigenvalue); }  // of power per round trip
};

struct SolveOptions {
  int most_round_trips = 60;
  double loss_error = 1e-3;  // relative, or of 1e-9 per round trip: ten times what two more round trips change
  std::function<void(int round_trips, double residual)> progress;  // after each round trip
};

class RoundTrip {
 public:
  // InputError: eq. W.6, as Leg; or the field does not fit into the memory of the device.
  explicit RoundTrip(Trip, Computing = {});
  ~RoundTrip();
  RoundTrip(RoundTrip&&) noexcept;
  Trip const& trip() const;
  Transform const& transform() const;
  int threads() const;
  Computing computing() const;
  Mask const& mask(std::size_t stop) const;
  SpectrumDisc const& band() const;  // frequencies at the start of the fields of which modes are made
  // Another surface of the mirror at a stop, as WaveMirror::height.
  void set_height(std::size_t stop, std::vector<double>);

  // Spectrum of a Hermite-Gauss mode after the last mirror, n quanta along x and m along y. Unit power.
  Field hermite_gauss(AxisBeam x, AxisBeam y, int n = 0, int m = 0) const;
  // eq. W.8, in place. The fields that arrive at a stop before its mask are shown in order of the way. Multiplied by
  // exp(i pi curvature rho^2/lambda) and divided by the scale they are those of the light, on a grid of pitch times
  // scale (eq. W.54).
  void travel(Field& spectrum, Watch const& = {}) const;
  // The mode that shares most with `start`, a spectrum after the last mirror. NumericalError if none is found.
  WaveMode mode(Field const& start, SolveOptions const& = {}) const;
  TripLosses losses(WaveMode const&) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace straytrace::wave
