// SPDX-License-Identifier: BSD-3-Clause
// Parts of one run, and what speaks against making one of them.
#pragma once

#include <string>
#include <vector>

#include "results/run_file/run_part.hpp"

namespace straytrace::session {

// Sorted by their first block; those that hold none come last.
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

// What is missing, and the commands that trace it, a line each.
std::string missing_text(RunParts const&);

// Adds up one file after the other: at no time are more than one of them and the sums in memory.
SumTree merged_sums(RunParts const&);

}  // namespace straytrace::session
