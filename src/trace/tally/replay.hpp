// SPDX-License-Identifier: BSD-3-Clause
// Traces one history again for quantities that are not in the sums: route, phase sensitivities and optical length of a
// kept score (docs/theory/phase.md, eq. 2.2 to 2.5).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "trace/result.hpp"
#include "trace/steered_world.hpp"
#include "trace/step/step.hpp"
#include "world/model/world.hpp"

namespace straytrace::trace {

// One vertex of a path: its event, the unit vectors of the light before and after it, and the indices of the media on
// both sides. A free beam starts on no surface. On a receiver the outgoing leg is zero
// (C3.7).
struct PassedVertex {
  SurfaceId surface;
  Vec3 point, in, out;
  Event event = Event::scatter;
  double n_in = 1, n_out = 1;
  GroupId group{};
};

struct ReplayedPath {
  std::vector<PassedVertex> vertices;
  std::uint32_t source = 0, goal = 0;  // footprint it started from; footprint, or receiver after them, it ends on
  bool other = false;                  // route longer than the limit of route names
  double coupling = 0;                 // of the score
  double path_length = 0;              // optical, m
  std::vector<PhaseSensitivity> phase_sensitivities;  // relative to the main mode, by body
};

// Traces scores (history, event, connection) again; empty if the history has no such score.
class Replay {
 public:
  Replay(SteeredWorld const& world, std::uint64_t seed);  // refers to the world
  std::optional<ReplayedPath> operator()(std::uint64_t history, std::uint32_t event, std::uint32_t connection);

 private:
  World const& world_;
  WorldView view_;
  std::uint64_t seed_;
  std::unique_ptr<History> again_;
};
// One score.
std::optional<ReplayedPath> replay(SteeredWorld const& world, std::uint64_t seed, std::uint64_t history,
                                   std::uint32_t event, std::uint32_t connection);

// What a record keeps of the path of a score.
struct ReplayedScore {
  std::uint32_t source = 0, goal = 0;  // as of ReplayedPath
  double path_length = 0;              // optical, m
  std::vector<PhaseSensitivity> phase_sensitivities;
};
// In the order of the scores, the same for any number of threads (0: all cores). Throws NumericalError where a score is
// not the same to the bit.
std::vector<ReplayedScore> replay_scores(SteeredWorld const&, std::uint64_t seed, std::span<ScoreAddress const>,
                                         unsigned threads);

// Phase Jacobians of a path relative to the main mode (eq. 2.3, 2.5), with their moments over the delays (eq. N.29,
// N.30). k in rad/m.
std::vector<PhaseSensitivity> phase_sensitivities_of(World const& world, std::vector<PassedVertex> const& vertices,
                                                     std::uint32_t source, std::uint32_t goal);

// Whether the path adds in amplitude to a distinct reverse (eq. 1.5).
bool has_reverse(World const&, std::vector<PassedVertex> const&, std::uint32_t source, std::uint32_t goal);

}  // namespace straytrace::trace
