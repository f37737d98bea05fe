// SPDX-License-Identifier: BSD-3-Clause
// The tree of beams from one launched beam (docs/theory/ghosts.md). At every surface the beam splits with the
// amplitudes of reflection and transmission there, and each part propagates as a Gaussian mode to the next surface,
// which the search of the trace finds. Nothing is sampled and nothing is merged.
//
// Order: at a surface the stronger of the two beams keeps its order. A beam with less than half of the power of the
// other one is a departure and adds 1; so is a reflection of less than a tenth of the arriving power, but the
// transmission behind it is not, at any power (an attenuator). The main beam has order 0. Where neither way is a
// departure (a splitter) both keep their order. A ghost that returns into the cavity that it left keeps its order; the
// main beam then is a ghost of order 1. Light that circulates inside glass is a ghost: where it meets a face from
// inside for the k-th time after the first, its order is at least k.
//
// A beam of which less than 1 % falls on the surface that its chief ray meets is no longer Gaussian, and ends.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/memory/ids.hpp"
#include "beams/mode.hpp"
#include "optics/polarisation.hpp"
#include "world/ghosts/screens.hpp"
#include "world/model/diffraction.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

// Field along the chief ray without the phase of the flight, for light of one state of polarisation, or for two states
// at right angles of which unpolarised light is the even mixture. Power: the mean over the states of |a|^2 + |b|^2.
struct BeamField {
  Vec3 axis{1, 0, 0};  // unit vector across the travel: `a` lies along it, `b` along travel x axis
  std::array<Jones, 2> state;
  int states = 1;
  double power() const {
    double sum = 0;
    for (int i = 0; i < states; ++i) sum += norm(state[i].a) + norm(state[i].b);
    return sum / states;
  }
};

// Where a rim has cut a beam. Of the mode u that comes, K u passes, and a screen reflects (1 - K) u.
struct RimCut {
  SurfaceId by;            // of several screens on one flight, the one that took most
  Mode mode;               // that comes, at the rim
  std::size_t steps = 0;   // surfaces passed before
  double at = 0;           // m, optical, from the launch
  double taken = 0;        // share of the power that does not pass
  bool reflected = false;  // the beam is what the screen reflects
  bool again = false;      // by the same screen before its shadow has washed out: K^2 = K
  // Whether the same screen cuts a beam with this shadow again in a spot of about the same size, before it has washed
  // out.
  bool repeats_in(RimCut const& later, double path) const;  // path: m, optical, between
};

struct BeamSpot {
  static constexpr std::uint32_t none = 0xffffffffu;
  SurfaceId surface;
  std::uint32_t piece = 0;  // of a surface made of pieces
  bool front = true;        // met on the side the normal points to
  Vec3 normal;              // unit, towards the side the light comes from
  Mode mode;           // arriving; its origin is where the chief ray meets the surface; wavelength in the medium there
  double index = 1;    // of that medium
  double power = 0;    // arriving, over that of the launched beam, before the rim clips it
  double clipped = 0;  // share of `power` that misses the surface (docs/theory/beams.md, eq. 5.5, 5.6)
  std::vector<RimCut> cuts;     // on its way, in order
  double path_length = 0;       // optical, from the plane where the beam is launched, m
  double gouy = 0;              // lag of the phase behind that of a plane wave since there, rad
  BeamField field;              // arriving: |.|^2 = power
  std::uint32_t parent = none;  // number of the spot it came from, in the order of the tree
  Event event = Event::start;   // what happened there: start (launched), reflect, transmit
  std::uint32_t order = 0;      // departures from the main beam
  // Phase of the arriving field on the chief ray without that of `field`, rad.
  double phase(double vacuum_wavelength) const { return 2 * pi / vacuum_wavelength * path_length - gouy; }
};

// The launched beam, with power 1.
struct BeamLaunch {
  std::string name;             // of the beam
  std::uint32_t footprint = 0;  // in World::footprints()
  std::uint32_t beam = 0;       // number of the beam
  Mode mode;                    // at the plane of the launch
  BeamField field;
  SurfaceId arrives_at;           // starts on this surface, at the origin of the mode; invalid: in space
  std::uint32_t piece = 0;        // of that surface
  Departure leaves;               // leaves this surface, at the origin of the mode; invalid: from space
  std::vector<SurfaceId> cavity;  // between these mirrors: the light reflected at `arrives_at` is the mode itself, and
                                  // light that passes into the cavity has rejoined it
  double passes = 1;              // share of the power that leaves the cavity through `arrives_at`; 1: no cavity
  // Light of the network of an interferometer behind a mirror of the cavity: its power is that behind the mirror, and
  // light that runs where the network continues ends there.
  NetworkSpan const* span = nullptr;

  // Behind an input mirror the light interferes with light from the splitter (docs/theory/interferometer.md), which is
  // not launched. End mirrors transmit some ppm, input mirrors of detectors 0.4 % and more.
  bool through_input_mirror() const { return !span && !cavity.empty() && passes > 1e-3; }
};
// Every Gaussian beam of the scene in its order, which lives as long as the world; a cavity is launched once through
// each of its mirrors.
std::vector<BeamLaunch> launches(World const&);

struct TreeLimits {
  double floor = 1e-15;  // of the launched power: weaker beams end, except those that return into the cavity
  std::uint32_t order = 0xffffffffu;
  std::uint32_t longest = 1000;             // surfaces on one way
  std::uint64_t beams = ~0ull;              // the tree stops after this number have ended
  std::atomic<bool> const* stop = nullptr;  // stops it once true
};

// One surface on the path of a beam.
struct BeamStep {
  SurfaceId surface;
  std::uint32_t piece = 0;
  Vec3 point, in, out;            // m; unit directions of the chief ray before and behind
  double n_in = 1, n_out = 1;     // of the media there
  double path_length = 0;         // optical, from the launch to the surface, m
  std::uint32_t spot = 0;         // number of the spot
  bool front = true;              // met on the side the normal points to
  Event event = Event::transmit;  // or reflect, diffract
  int diffracted = 0;             // order of a grating
  bool departure = false;
  bool split = false;       // both ways keep their order
  bool weaker = false;      // of these, not the strongest
  bool off_screen = false;  // reflected by a screen; `point` is on the chief ray in its hole
};

// A beam after the last step of its path.
struct LeavingBeam {
  Mode mode;  // its origin is on the surface left, or in the plane of the launch
  BeamField field;
  double path_length = 0, gouy = 0;  // m, rad; there
  std::uint32_t order = 0;
  std::vector<RimCut> cuts{};
};

// Light of a beam on a screen.
struct ScreenSpot {
  Screened screen;
  bool front = true;         // lit on the side its normal points to
  double power = 0;          // of the beam before the screens of this flight, over the launched power
  double path_length = 0;    // m, optical, from the launch to the point of the chief ray beside it
  double gouy = 0;           // as of a spot, there
  double index = 1;          // of the medium there
  BeamField field;           // |.|^2 = power
  std::vector<RimCut> cuts;  // of the beam before
  std::uint32_t order = 0;
};

enum class BeamEnd : std::uint8_t {
  landed,    // no beam keeps its order
  escaped,   // meets nothing
  rejoined,  // back in the cavity it was launched from, or where the network of the interferometer continues
  faint,     // below the floor
  longest,   // too many surfaces
  wide       // far wider than the surface
};
char const* name_of(BeamEnd);

// Receives the events of the tree. `way`: all surfaces passed so far; `beam` leaves the last one. The tree grows depth
// first, the stronger way at a surface before the other.
class BeamSink {
 public:
  virtual ~BeamSink() = default;
  virtual void left(LeavingBeam const& /*beam*/, std::span<BeamStep const> /*way*/) {}
  virtual void screened(ScreenSpot const&, std::span<BeamStep const> /*way*/) {}
  virtual void arrived(BeamSpot const&, std::uint32_t /*number*/, std::span<BeamStep const> /*way*/) {}
  // A beam ends on the surface of `spot`, or after the last step of its way (null: escaped, rejoined, faint).
  virtual void ended(BeamEnd, BeamSpot const* /*spot*/, LeavingBeam const&, std::span<BeamStep const> /*way*/) {}
};

// Compensated sum (Neumaier): the error does not grow with the number of terms.
class LongSum {
 public:
  LongSum& operator+=(double x) {
    double const next = sum_ + x;
    rest_ += std::fabs(sum_) >= std::fabs(x) ? (sum_ - next) + x : (x - next) + sum_;
    sum_ = next;
    return *this;
  }
  operator double() const { return sum_ + rest_; }

 private:
  double sum_ = 0, rest_ = 0;
};

// Energy balance, in shares of the launched power.
struct BeamEnergyBalance {
  struct Object {
    LongSum landed;     // neither reflected nor transmitted: absorbed or scattered; on screens also what they transmit
    LongSum scattered;  // part of `landed`
    LongSum beside;     // passed beside the rim (docs/theory/beams.md, eq. 5.5, 5.6)
    LongSum ghosts;     // part of landed + beside from ghosts
  };
  std::vector<Object> objects;  // by group
  LongSum media, escaped, rejoined, floor, order, longest, wide, stopped;
  std::uint64_t spots = 0, beams = 0;  // met; ended
  double total() const;                // 1 to rounding
};

// Grows the tree of one launch. It needs memory only for the longest path.
BeamEnergyBalance grow_tree(World const&, BeamLaunch const&, TreeLimits const&, BeamSink&);

}  // namespace straytrace::world
