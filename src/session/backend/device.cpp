// SPDX-License-Identifier: BSD-3-Clause
#include "session/backend/device.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "trace/backend/device/device_backend.hpp"

namespace straytrace {

DirectSum phase_summer(std::string const& backend) {
  if (backend == "cpu") return {};
  if (backend != "cuda") throw InputError(fmt::format("'{}' does not sum phases", backend), "write cpu or cuda");
  std::shared_ptr<DeviceEngine> const engine = cuda_engine();
  return [engine](PhaseTerms const& terms) {
    std::size_t const samples = terms.coordinate.empty() ? 0 : terms.coordinate.front().size();
    std::vector<double> position;
    for (auto const& one : terms.coordinate) position.insert(position.end(), one.begin(), one.end());
    return engine->phase_sum(
        {terms.amplitude, terms.turns, terms.phase_sensitivity, position, terms.coordinate.size(), samples});
  };
}

std::string devices_text() {
  if (!has_cuda_engine()) return "cuda: not built";
  try {
    DeviceFacts const facts = cuda_engine()->facts();
    return fmt::format("cuda: {}, {:.0f} GB", facts.name, double(facts.memory) / 1e9);
  } catch (InputError const&) {
    return "cuda: built; no device here";
  }
}

}  // namespace straytrace
