// SPDX-License-Identifier: BSD-3-Clause
#include "trace/backend/backend.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "trace/backend/cpu.hpp"
#include "trace/backend/device/device_backend.hpp"

namespace straytrace {

std::unique_ptr<Backend> make_backend(std::string_view name) {
  if (name == "cpu") return cpu_backend();
  if (name == "cuda") return device_backend("cuda", cuda_engine());
  throw InputError(fmt::format("there is no backend '{}'", name),
                   "write cpu or cuda; mpi is for trace alone, under mpirun");
}

}  // namespace straytrace
