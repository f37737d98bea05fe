// SPDX-License-Identifier: BSD-3-Clause
// Run files as parts of a larger run: properties that must agree, and their sums, without the rest; and sums as bytes.
#pragma once

#include <string>
#include <vector>

#include "results/results.hpp"

namespace straytrace::results {

// Properties of a part, before its sums are read.
struct PartHead {
  std::string file;
  Provenance provenance;
  std::string model_hash, texts_hash;  // texts: files, overrides and motion
  std::uint64_t seed = 0, all_blocks = 0, block_size = 0;
  double seconds = 0;
  Slice slice;
  std::vector<BlockRange> done;  // ascending
};
// Both read the whole file and check its seal. Throw InputError as read_run() does.
PartHead read_part_head(std::string const& run_file);
SumTree read_part_sums(std::string const& run_file);

// As bytes: an HDF5 image of sums with /nodes alone, or of the field of a cavity with /wave alone.
std::string nodes_image(SumTree const&);
SumTree nodes_of_image(std::string const&);
std::string wave_image(wave::WaveRecord const&);
wave::WaveRecord wave_of_image(std::string const&);

}  // namespace straytrace::results
