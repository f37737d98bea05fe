// SPDX-License-Identifier: BSD-3-Clause
// Ranks that mpirun started. The program does not need MPI: what knows it is straytrace-mpi.so beside the program.
#pragma once

#include <memory>

#include "trace/ranks.hpp"

namespace straytrace {

// Loads the library and joins the job; leaves it when the transport is destroyed. Throws InputError with the reason
// and what to do when the library is not there or cannot be loaded.
std::unique_ptr<Transport> open_mpi();

}  // namespace straytrace
