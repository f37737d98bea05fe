// SPDX-License-Identifier: BSD-3-Clause
// The noise stage on a device: the sum of moving phases with the bits of the host (noise/time_domain/phase_sum.hpp).
#include <gtest/gtest.h>

#include "base/math/rng.hpp"
#include "device/blocks.hpp"
#include "noise/time_domain/phase_sum.hpp"

namespace straytrace::testing {
namespace {

PhaseOrder order_of(PhaseTerms const& terms, std::vector<double>& position) {
  for (auto const& samples : terms.coordinate) position.insert(position.end(), samples.begin(), samples.end());
  return {terms.amplitude,           terms.turns, terms.phase_sensitivity, position, terms.coordinate.size(),
          terms.coordinate[0].size()};
}

TEST(DevicePhases, LeaveTheBitsOfTheHost) {
  constexpr std::size_t paths = 50, samples = 3001, coordinates = 4;
  Rng rng(5, 0, 0, Stream::motion);
  std::vector<std::vector<double>> motion(coordinates, std::vector<double>(samples));
  for (auto& one : motion)
    for (double& x : one) x = 2e-5 * rng.uniform() - 1e-5;
  PhaseTerms terms;
  for (auto const& one : motion) terms.coordinate.emplace_back(one);
  for (std::size_t j = 0; j < paths; ++j) {
    terms.amplitude.push_back(1e-6 * rng.uniform());
    terms.turns.push_back(rng.uniform());
    for (std::size_t c = 0; c < coordinates; ++c)
      terms.phase_sensitivity.push_back(c == j % 5 ? 0 : 2e6 * rng.uniform());
  }
  std::vector<double> position;
  auto const device = load_engine(engine_tested())->phase_sum(order_of(terms, position));
  EXPECT_TRUE(device == direct_phase_sum(terms));
  terms.turns[7] = std::nextafter(terms.turns[7], 2.0);  // control: one bit of one path
  EXPECT_FALSE(device == direct_phase_sum(terms));
}

// As `project` asks for it: tables for paths that one coordinate moves, the device for what they are made of.
TEST(DevicePhases, ServeTheTablesOfTheHost) {
  constexpr std::size_t paths = 400, samples = 5000;
  Rng rng(6, 0, 0, Stream::motion);
  std::vector<double> motion(samples);
  for (double& x : motion) x = 2e-5 * rng.uniform() - 1e-5;
  PhaseTerms terms;
  terms.coordinate = {motion};
  for (std::size_t j = 0; j < paths; ++j) {
    terms.amplitude.push_back(1e-6 * rng.uniform());
    terms.turns.push_back(rng.uniform());
    terms.phase_sensitivity.push_back(2e6 * rng.uniform());
  }
  auto const engine = load_engine(engine_tested());
  std::size_t asked = 0;
  auto const on_device = phase_sum(terms, 0, [&](PhaseTerms const& some) {
    asked += some.coordinate[0].size();
    std::vector<double> position;
    return engine->phase_sum(order_of(some, position));
  });
  EXPECT_TRUE(on_device == phase_sum(terms));
  EXPECT_GT(asked, 0u);
  EXPECT_LT(asked, samples);  // a table, not the samples
}

}  // namespace
}  // namespace straytrace::testing
