// SPDX-License-Identifier: BSD-3-Clause
// Scenes with receivers, traced.
#pragma once

#include "base/every_module.hpp"
#include "results/receivers/receivers.hpp"
#include "support/test_backend.hpp"
#include "trace/importance/steering_tables.hpp"
#include "trace/run/trace.hpp"
#include "world/model/world.hpp"

namespace straytrace::testing {

inline constexpr char receiver_scene_head[] =
    "straytrace: 1\nmaterials:\n  black: {}\n  white: {scatter: {model: lambertian, tis: 100 %}}\n"
    "  mirror: {specular: {reflect: 99 %}}\n  half: {specular: {reflect: 50 %, transmit: 50 %}}\n  rough: {specular: "
    "{reflect: 50 %}, scatter: {model: lambertian, tis: 40 "
    "%}}\n"
    "bodies: {b: {motion: still}}\n";

inline World world_of(std::string const& text) {
  FileTexts const texts{{"a.yaml", receiver_scene_head + text}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}

struct Traced {
  World world;
  TraceResult result;
  RunContent content() const {
    RunContent c;
    c.receivers = world.receivers();
    for (Receiver const& r : c.receivers) c.map_areas.push_back(map_areas(world.view(), r.surface, r));
    c.beam_power = world.beam_power;
    c.main_file = "a.yaml";
    c.provenance.created = "2024-05-01T12:00:00Z";
    c.trace = &result;
    return c;
  }
  Estimate const& power(std::size_t i) const { return result.coupling.received_power.at(i); }
  double emitted() const { return result.total.emitted.sum / double(result.total.histories); }
  double all_received() const {
    double sum = 0;
    for (Estimate const& e : result.coupling.received_power) sum += e.mean;
    return sum;
  }
};
inline Traced traced(std::string const& text, std::uint64_t blocks, unsigned threads = 2, SumTree resume = {},
                     std::uint64_t seed = 1) {
  Traced t{world_of(text), {}};
  find_map_cells(t.world);
  TraceSettings settings;
  settings.histories = blocks * largest_block;
  settings.threads = threads;
  settings.seed = seed;
  settings.resume = std::move(resume);
  t.result = run_trace(SteeredWorld::as_given(t.world), settings, *test_backend());
  return t;
}

}  // namespace straytrace::testing
