// SPDX-License-Identifier: BSD-3-Clause
// Backends outside this process: GPUs, and ranks started by mpirun.
#pragma once

#include <string>

#include "noise/time_domain/phase_sum.hpp"
#include "trace/run/ranks.hpp"

namespace straytrace::session {

// Only straytrace-mpi.so, next to the program, depends on MPI.
// Loads the library and joins the job, once in a program. Throws InputError with the reason and the remedy when the
// library is missing or cannot be loaded.
Transport& open_mpi();

// Leaves the job, if it was joined, as the last thing that the program does: a job that has lost a rank ends here with
// this exit code, and output not written by then is lost.
void close_mpi(int exit_code);

// Sums of moving phases on this backend. Throws InputError for an unknown name, and when no device is available.
DirectSum phase_summer(std::string const& backend);

// "cuda: NVIDIA H100, 80 GB", or why there is none; for --version.
std::string devices_text();

}  // namespace straytrace::session
