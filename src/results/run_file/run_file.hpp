// SPDX-License-Identifier: BSD-3-Clause
// The groups of a run file, each written and read in one place. Paths and columns: schema/run-2.txt.
#pragma once

#include <string>
#include <vector>

#include "io/hdf5/read_write.hpp"
#include "results/results.hpp"

namespace straytrace::results {

// Run files as parts of a larger run: properties that must agree, and their sums, without the rest; and sums as bytes.

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

void write_classes(hdf5::Writer&, CouplingTable const&);  // /names, /classes, /records
CouplingTable read_classes(hdf5::Reader const&);

void write_nodes(hdf5::Writer&, SumTree const&);  // /nodes
SumTree read_nodes(hdf5::Reader const&);
std::vector<BlockRange> read_done(hdf5::Reader const&);  // which blocks they hold, ascending

void write_node_maps(hdf5::Writer&, SumTree const&);  // the receivers in /nodes
void read_node_maps(hdf5::Reader const&, std::vector<BlockSums>&);

void write_receivers(hdf5::Writer&, RunContent const&);  // /receivers
void read_receivers(hdf5::Reader const&, std::size_t count, RunContent&);
void write_maps_of(hdf5::Writer&, BlockSums const& total);  // /maps

void write_importance(hdf5::Writer&, ImportanceMap const&);              // /importance
ImportanceMap read_importance(hdf5::Reader const&, std::size_t groups);  // empty in files before schema 1.3

void write_projection(hdf5::Writer&, ProjectionInputs const&);  // /projection
// The file has the group; `table`: names of bodies and ports, and the wavelength.
ProjectionInputs read_projection(hdf5::Reader const&, CouplingTable const& table);

void write_energy_balance(hdf5::Writer&, TraceResult const&);  // /energy_balance, /arrived

void write_wave(hdf5::Writer&, wave::WaveRecord const&);  // /wave
wave::WaveRecord read_wave(hdf5::Reader const&);          // the file has the group
void write_ring(hdf5::Writer&, wave::RingRecord const&);  // /wave_ring
wave::RingRecord read_ring(hdf5::Reader const&);          // the file has the group
void write_seam(hdf5::Writer&, SeamCheck const&);         // /seam
SeamCheck read_seam(hdf5::Reader const&);                 // the file has the group

void write_noise(hdf5::Writer&, NoiseBudget const&);  // /noise
NoiseBudget read_noise(hdf5::Reader const&);

// Offsets of lists laid end to end: n + 1 numbers that begin with 0, never fall and end with `total`.
std::vector<std::uint64_t> read_offsets(hdf5::Reader const&, std::string const& path, std::size_t lists,
                                        std::size_t total);
// Content of the HDF5 file behind the checksum; `file` names it in messages.
RunFile run_of(hdf5::Contents, std::string const& file);
inline constexpr char const* make_again = "copy it again from where it was made, or make the run again";
[[noreturn]] void damaged_run(std::string const& what);

// The first 512 bytes of a run file: a readable line with the sha256 of all that follows (an HDF5 user block). Damaged
// files are rejected before the HDF5 library, which can crash on them, sees a byte.

std::string checksum_header(std::string_view hdf5_image);
// The HDF5 image of a run file; throws InputError when `bytes` are not one, or damaged. `name` for the message.
std::string unsealed(std::string bytes, std::string const& name);

}  // namespace straytrace::results
