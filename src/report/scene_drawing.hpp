// SPDX-License-Identifier: BSD-3-Clause
// What a drawing of a scene shows: the world as triangles, and paths of rays through it.
#pragma once

#include <string>
#include <vector>

#include "results/results.hpp"
#include "trace/coupling.hpp"
#include "trace/steered_world.hpp"
#include "world/model/world.hpp"

namespace straytrace::report {

// A world as triangles, for pictures and exports: equal shapes are stored once, meshes of millions of triangles are
// simplified and marked.

// Light as lines in space: kept paths of routes traced again from their addresses, sample histories with their terms of
// the energy balance, and one history event by event.

struct PathPoint {
  Vec3 point;  // m
  Event event = Event::scatter;
  GroupId group;
  BodyId body;
  SurfaceId surface;  // invalid: the start of a free beam
};

struct DrawnPath {
  std::uint64_t route = 0;  // hash of its class
  std::uint64_t history = 0;
  std::uint32_t event = 0, connection = 0;
  double weight = 0;       // recoupled power fraction that it represents; of received light W per W
  double path_length = 0;  // optical, m
  bool reversed = false;   // the route was sampled on its reverse
  bool computed = false;   // a way of a deterministic route: it has no history
  std::vector<PathPoint> points;
};

// Paths of one route: all that were kept, or, of more, at most so many, spread evenly over its coupling, whose weights
// sum to that of all; none for routes that were computed, not sampled.
std::vector<DrawnPath> paths_of(SteeredWorld const&, std::uint64_t seed, CouplingClass const&, std::size_t most);

// A straight piece of light of a sample history.
struct RaySegment {
  enum class End : std::uint8_t { met, escaped } end = End::met;
  Vec3 from, to;            // m; an escaped one ends where it leaves the box
  double power = 0;         // relative to the main mode, carried on this piece
  std::uint32_t order = 0;  // surface events before it
  GroupId on;               // the group it meets
  std::uint64_t history = 0;
};
std::vector<RaySegment> sample_rays(SteeredWorld const&, Box const&, std::uint64_t seed, std::uint64_t histories);

// Every event of one history, in order. Its terms sum to the emitted power, the power scattered out
// of the mode.
struct HistoryEvent {
  std::string what;  // emit, arrive, rejoin, receive, or a term of the energy balance
  std::uint32_t event = 0, order = 0;
  std::string where, body;  // of a surface
  Vec3 point;               // m; NaN without a place
  double power = 0;         // relative to the main mode
};
std::vector<HistoryEvent> replay_history_events(SteeredWorld const&, std::uint64_t seed, std::uint64_t history);

struct DrawnMesh {
  std::vector<float> points;           // m, three per corner, from the place of the part
  std::vector<std::uint32_t> corners;  // three per triangle
  std::size_t of_triangles = 0;        // that the shape has; more than are drawn: thinned out
  double moved = 0;                    // m, at most, where it was
  std::size_t triangles() const { return corners.size() / 3; }
};

// Surfaces of one name with one shape, body and material on either side.
struct DrawnPart {
  std::string name, body, front, back, shape;  // front, back: material; shape: its key
  std::uint32_t mesh = 0;
  std::vector<Vec3> places;  // m
  bool clear = false;        // a measuring plane
};

struct SceneDrawing {
  std::vector<DrawnMesh> meshes;
  std::vector<DrawnPart> parts;
  Box box;                                              // m
  std::size_t triangles() const, of_triangles() const;  // of all parts: drawn, and of their shapes
};

constexpr std::size_t most_drawn_triangles = 200000;  // in all different meshes together
SceneDrawing scene_drawing(World const&, std::size_t most_triangles = most_drawn_triangles);

}  // namespace straytrace::report
