// SPDX-License-Identifier: BSD-3-Clause
// The tree of beams that one launched beam makes: at every surface it is reflected and transmitted with the real
// amplitudes there, and each part is followed as a Gaussian mode to the next surface, which is searched as for the rays
// of the trace. Nothing is drawn and nothing is merged. docs/theory/ghosts.md.
//
// Order: the way that carries the main part of the light at a surface goes on in the order it has; a way that carries
// less than half of what the other one does is a departure and adds 1. So is a reflection of less than a tenth of what
// arrives; transmission behind it is none, however faint (an attenuator). The main beam is order 0. Where neither way
// is a departure (a splitter) both go on. A ghost that returns into the cavity it comes from keeps its order; the main
// beam then is a ghost of order 1. Light that goes round inside glass is a ghost: where it meets a face from inside as
// it has done k times on its way, its order is k at least.
//
// A beam of which less than 1 % falls on the surface that its chief ray meets is no Gaussian beam behind it, and ends.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "beams/spot.hpp"
#include "world/ghosts/screens.hpp"
#include "world/model/vertex.hpp"
#include "world/model/world.hpp"

namespace straytrace {

// What is launched, with power 1.
struct BeamLaunch {
  std::string name;             // of the beam
  std::uint32_t footprint = 0;  // of World::footprints() that says so
  std::uint32_t beam = 0;       // number of the beam
  Mode mode;                    // at the plane of the launch
  BeamField field;
  SurfaceId arrives_at;           // it starts where it meets this surface, at the origin of the mode; invalid: in space
  std::uint32_t piece = 0;        // of that surface
  std::vector<SurfaceId> cavity;  // it stands between these mirrors, and what is reflected at `arrives_at` is the mode
                                  // itself; what passes into the cavity has rejoined it
  double passes = 1;              // share of the power that leaves the cavity through `arrives_at`; 1: no cavity

  // Behind an input mirror the light interferes with what comes from the splitter (docs/theory/interferometer.md),
  // which is not launched: end mirrors pass some ppm, input mirrors of detectors 0.4 % and more.
  bool through_input_mirror() const { return !cavity.empty() && passes > 1e-3; }
};
// Every Gaussian beam of the scene in its order; a cavity is launched once through each of its mirrors.
std::vector<BeamLaunch> launches(World const&);

struct TreeLimits {
  double floor = 1e-15;  // of the launched power; what leaves a surface with less is not followed, but for what
                         // returns into the cavity
  std::uint32_t order = 0xffffffffu;
  std::uint32_t longest = 1000;             // surfaces on one way
  std::uint64_t beams = ~0ull;              // after so many have ended the rest is not followed
  std::atomic<bool> const* stop = nullptr;  // once true, the same
};

// One surface on the way of a beam.
struct BeamStep {
  SurfaceId surface;
  Vec3 point, in, out;            // m; unit directions of the chief ray before and behind
  double n_in = 1, n_out = 1;     // of the media there
  double path_length = 0;         // optical, from the launch to the surface, m
  std::uint32_t spot = 0;         // number of the spot
  bool front = true;              // met on the side the normal points to
  Event event = Event::transmit;  // or reflect
  bool departure = false;
  bool split = false;  // the other way goes on too
};

// A beam behind the last step of its way.
struct LeavingBeam {
  Mode mode;  // its origin is on the surface left, or in the plane of the launch
  BeamField field;
  double path_length = 0, gouy = 0;  // m, rad; there
  std::uint32_t order = 0;
};

// Light of a beam on a screen beside its chief ray.
struct ScreenSpot {
  Screened screen;
  bool front = true;       // lit on the side its normal points to
  double power = 0;        // of the beam before any screen of this flight, over the launched power
  double path_length = 0;  // optical, from the launch to where the chief ray passes, m
  double index = 1;        // of the medium there
  BeamField field;         // |.|^2 = power
  std::uint32_t order = 0;
};

enum class BeamEnd : std::uint8_t {
  landed,    // no way goes on in the order it has
  escaped,   // met nothing
  rejoined,  // back in the cavity it was launched from
  faint,     // what goes on is below the floor
  longest,   // too many surfaces
  wide       // far wider than the surface
};
char const* name_of(BeamEnd);

// Listens to the tree. `way`: all surfaces passed so far; the last one is left by `beam`. Ways are followed depth
// first, the stronger one at a surface before the other.
class BeamSink {
 public:
  virtual ~BeamSink() = default;
  virtual void left(LeavingBeam const& /*beam*/, std::span<BeamStep const> /*way*/) {}
  virtual void screened(ScreenSpot const&, std::span<BeamStep const> /*way*/) {}
  virtual void arrived(BeamSpot const&, std::uint32_t /*number*/, std::span<BeamStep const> /*way*/) {}
  // A beam is over: on the surface of `spot`, or behind the last step of its way (null: escaped, rejoined, faint).
  virtual void ended(BeamEnd, BeamSpot const* /*spot*/, LeavingBeam const&, std::span<BeamStep const> /*way*/) {}
};

// A sum of millions of small terms whose error does not grow with their number (Neumaier).
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

// Where the launched power has gone, in shares of it.
struct BeamEnergyBalance {
  struct Object {
    LongSum landed;     // neither reflected nor transmitted there: absorbed or scattered; all that a screen takes
    LongSum scattered;  // part of `landed`
    LongSum beside;     // passed beside the rim (docs/theory/beams.md, eq. 5.5, 5.6)
    LongSum ghosts;     // part of landed + beside that ghosts brought
  };
  std::vector<Object> objects;  // by group
  LongSum media, escaped, rejoined, floor, order, longest, wide, stopped;
  std::uint64_t spots = 0, beams = 0;  // met; ended
  double total() const;                // 1 to rounding
};

// Grows the tree of one launch. The memory needed is that of the longest way.
BeamEnergyBalance grow_tree(World const&, BeamLaunch const&, TreeLimits const&, BeamSink&);

}  // namespace straytrace
