// SPDX-License-Identifier: BSD-3-Clause
// Ranks that mpirun started. The program does not need MPI: what knows it is straytrace-mpi.so beside the program.
#pragma once

#include "trace/run/ranks.hpp"

namespace straytrace {

// Loads the library and joins the job, once in a program. Throws InputError with the reason and what to do when the
// library is not there or cannot be loaded.
Transport& open_mpi();

// Leaves the job, if it was joined, as the last thing that the program does: a job that has lost a rank ends here with
// this exit code, and what was not written by then is not seen.
void close_mpi(int exit_code);

}  // namespace straytrace
