// SPDX-License-Identifier: BSD-3-Clause
// Batch jobs: files to submit, and merging of the parts that they trace.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/namespaces.hpp"
#include "results/run_file/run_file.hpp"

namespace straytrace::session {

// Files for batch systems: texts to read and edit. From the user they contain only the program and the account; scene
// and parameters are in input.h5, so that no name of a file can become a command.

struct Jobs {
  std::uint64_t slices = 1;
  std::string program;     // absolute path
  std::string scene;       // for a comment
  std::string accounting;  // empty: none
  double seconds = 3600;   // limit of a job
  unsigned threads = 1;
  bool noise = true;  // the scene has an interferometer
};

using NamedTexts = std::vector<std::pair<std::string, std::string>>;  // file, content

// slices.sbatch, finish.sbatch, submit.sh: an array whose tasks that end with 85 are requeued.
NamedTexts slurm_files(Jobs const&);
// slices.sub, merge.sub, noise.sub, report.sub, run.dag, submit.sh. Throws InputError when a submit file cannot
// contain the path of the program.
NamedTexts condor_files(Jobs const&);

// "part007.h5" of 200: as many digits as the largest number has.
std::string part_name(std::uint64_t number, std::uint64_t of);

// Quotes any words for a POSIX shell.

// As one literal word of the shell: plain words are unchanged, others are put in single quotes.
inline std::string shell_word(std::string_view text) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
  if (!text.empty() && text.front() != '-' && text.find_first_not_of(plain) == text.npos) return std::string(text);
  std::string quoted = "'";
  for (char const c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

// Parts of one run, and the reasons why they cannot be merged.

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
