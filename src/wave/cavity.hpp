// SPDX-License-Identifier: BSD-3-Clause
// The field of a linear cavity with real mirrors and with openings in between, by Fourier propagation
// (docs/theory/wave.md, eq. W.8, W.9, W.11, W.24).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "wave/round_trip.hpp"

namespace straytrace::wave {

struct WaveBaffle {
  double place = 0;  // m from mirror 1
  RoundHole rim;
  double lit = 0;  // m, distance from the axis up to which light on its screen is wanted; 0: of the opening alone
};
struct WaveCavity {
  double wavelength = 0, length = 0;  // m
  WaveMirror mirror1, mirror2;
  std::vector<WaveBaffle> baffles;  // in order of place
  Grid grid;
};

// The axis of a cavity is the line through the centres of curvature of both mirrors. Its place and slope, across the
// axis that it had, by the motion of one mirror: its displacement across times its curvature, plus the slope of its
// normal for mirror 1 or less it for mirror 2.
struct AxisShift {
  double at_mirror1;  // m
  double slope;       // rad
  double at(double z) const { return at_mirror1 + slope * z; }
};
// eq. W.23; the cavity is stable.
std::array<AxisShift, 2> axis_shifts(double curvature1, double curvature2, double length);

// Where it meets the mirrors when these are tilted, m.
struct CavityAxis {
  double x1 = 0, y1 = 0, x2 = 0, y2 = 0;
};
CavityAxis axis_of(WaveCavity const&);

// Fields that arrive at plane `plane` (0: mirror 1, 1 to n: baffles, n + 1: mirror 2) before its own mask.
enum class Travel { towards_mirror2, towards_mirror1 };
struct Arrival {
  int plane = 0;
  Travel travel = Travel::towards_mirror2;
  Field const& field;
};
using Observer = std::function<void(Arrival const&)>;
using Looks = std::function<bool(int plane, Travel)>;  // where somebody looks; empty: everywhere

// Where the power of a field of unit power goes in one round trip (eq. W.24).
struct PowerLedger {
  std::vector<double> towards_mirror2, towards_mirror1;  // on each baffle
  double mirror1 = 0, mirror2 = 0;  // beyond their outlines, and scattered beyond the crossover angle
  double beyond_band = 0;           // at angles that reach no opening
  double total() const;
};

class CavityWaves {
 public:
  explicit CavityWaves(WaveCavity, Computing = {});  // InputError: as RoundTrip
  ~CavityWaves();
  WaveCavity const& cavity() const;
  RoundTrip const& trip() const;
  Transform const& transform() const;
  int threads() const;
  Mask const& mask(std::size_t baffle) const;
  // Other heights of both mirrors, on the grid; empty: none.
  void set_heights(std::array<std::vector<double>, 2>);

  // Frequencies at mirror 1 of the fields of which modes are made.
  SpectrumDisc const& band() const;

  // Spectrum of a Hermite-Gauss mode of the mirrors alone about the axis that their tilts give, n quanta along x and m
  // along y, after the reflection by mirror 1. Unit power. NumericalError if the cavity is not stable.
  Field hermite_gauss(int n = 0, int m = 0) const;
  // eq. W.8, in place. Calls the observer for each arrival where it looks, in order of the way.
  void round_trip(Field& spectrum, Observer const& = {}, Looks const& = {}) const;
  // The mode that shares most with `start`, a spectrum after mirror 1. NumericalError if none is found.
  WaveMode mode(Field const& start, SolveOptions const& = {}) const;
  // B of eq. W.11 of the field after mirror 1 and that which arrives there.
  Complex overlap(Field const& departing, Field const& arriving) const;
  PowerLedger ledger(WaveMode const&) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace straytrace::wave
