// SPDX-License-Identifier: BSD-3-Clause
// Runs histories; independent of the number of blocks or workers.
#pragma once

#include <memory>
#include <string_view>

#include "trace/result.hpp"
#include "trace/steered_world.hpp"

namespace straytrace::trace {

// It may cache data of a world: a world must not change after its first use while the backend lives.
class Backend {
 public:
  virtual ~Backend() = default;
  virtual std::string_view name() const = 0;
  // Traces histories [block * block_size, (block + 1) * block_size) with the size of the world. Called from several
  // threads at once.
  virtual BlockSums run_block(SteeredWorld const&, std::uint64_t seed, std::uint64_t block) const = 0;
  virtual unsigned callers() const { return 0; }  // threads that should call run_block; 0: as many as there are cores
};

std::unique_ptr<Backend> make_backend(std::string_view name);  // "cpu", "cuda"; InputError for any other

std::unique_ptr<Backend> cpu_backend();

}  // namespace straytrace::trace
