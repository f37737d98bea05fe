// SPDX-License-Identifier: BSD-3-Clause
// Parts of one run, and the reasons why they cannot be merged.
#pragma once

#include <string>
#include <vector>

#include "results/run_file/run_part.hpp"

namespace straytrace::session {

// Sorted by their first block; empty ones come last.
struct RunParts {
  std::vector<PartHead> heads;
  std::uint64_t all_blocks = 0;
  std::vector<BlockRange> missing;
};

// Reads the heads. Throws one InputError with all reasons why these files are not parts of one run that this program
// could have traced: another model, seed or program, or blocks that two of them hold.
RunParts read_parts(std::vector<std::string> const& files);

// Blocks of a run file that no part holds.
std::vector<BlockRange> lost_with(PartHead const& there, RunParts const&);

// Missing slices, and the commands to trace them, a line each.
std::string missing_text(RunParts const&);

// Adds up one file after the other: only one of them and the sums are in memory at a time.
SumTree merged_sums(RunParts const&);

}  // namespace straytrace::session
