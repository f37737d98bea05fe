// SPDX-License-Identifier: BSD-3-Clause
// The noise stage on a device: the sum of moving phases with the bits of the host (noise/phase_sum.hpp).
#include <gtest/gtest.h>

#include "base/rng.hpp"
#include "device/blocks.hpp"
#include "noise/phase_sum.hpp"

namespace straytrace::testing {
namespace {

PhaseOrder order_of(PhaseTerms const& terms, std::vector<double>& position) {
  for (auto const& samples : terms.coordinate) position.insert(position.end(), samples.begin(), samples.end());
  return {terms.amplitude, terms.turns, terms.lever, position, terms.coordinate.size(), terms.coordinate[0].size()};
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
    for (std::size_t c = 0; c < coordinates; ++c) terms.lever.push_back(c == j % 5 ? 0 : 2e6 * rng.uniform());
  }
  std::vector<double> position;
  auto const device = load_engine(engine_tested())->phase_sum(order_of(terms, position));
  EXPECT_TRUE(device == direct_phase_sum(terms));
  terms.turns[7] = std::nextafter(terms.turns[7], 2.0);  // twin: one bit of one path
  EXPECT_FALSE(device == direct_phase_sum(terms));
}

}  // namespace
}  // namespace straytrace::testing
