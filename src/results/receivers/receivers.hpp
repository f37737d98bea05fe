// SPDX-License-Identifier: BSD-3-Clause
// Light in watts: tables of receivers, their routes, the census of objects met by the light, and their maps.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <complex>
#include <string_view>

#include "results/results.hpp"

namespace straytrace::results {

// Mean per history of each cell of a map, W per W of the main mode, and its standard error from the blocks. NaN, NaN:
// no light was seen there; error NaN: not resolved. A single block has no spread, and the squares of the faintest light
// underflow. Of equal blocks the error is the light of one of them.
struct CellEstimates {
  std::vector<double> mean, error;
};
CellEstimates cell_estimates(MapSums const&, std::uint64_t histories, std::uint64_t blocks);

// Coherent field of one pixel row by row: sum over routes of sqrt(P/area) e^(i phase) (R4.02), in
// sqrt(W)/m per sqrt(W) of the main mode. `coherence`: smallest share of a route's power in a pixel that is in phase
// with its mean; far below 1 the pixels are too coarse for the phase. `areas`: of the pixels within the rim, m^2.
struct FieldMap {
  std::vector<std::complex<double>> field;
  std::vector<double> coherence;
};
FieldMap field_map(Receiver const&, ReceiverSums const&, std::uint64_t histories, std::vector<double> const& areas);

// Names of a chart of cells in files and pages, by Chart.
inline constexpr std::string_view chart_names[] = {"plane", "polar", "unrolled"};

struct ReceivedRoute {
  std::size_t rank = 0;  // resolved ones first, by power
  std::uint64_t hash = 0;
  std::string sequence;
  Estimate power;                    // W per W of the main mode
  WithError share;                   // of the light of the receiver [1]
  std::vector<std::string> objects;  // groups passed, each once, without the receiver; none for `other`
  std::size_t folded_routes = 0;     // of `other`: how many it sums
  std::vector<FoldedRow> folded;     // the largest of them, descending
};

// A named object met by the light of a receiver, including the source.
struct CensusRow {
  std::string object;               // empty: routes without names (too long, or too faint for a row of their own)
  WithError power;                  // of all routes that touch it; NaN error below 32 blocks
  std::vector<std::size_t> routes;  // ranks
};

struct ReceiverEntry {
  std::string name;
  Estimate power;
  std::vector<ReceivedRoute> routes;
  std::vector<CensusRow> census;  // by power
  CellEstimates quadrants;        // lower left, lower right, upper left, upper right, gap; empty without quadrants
};

struct ReceiverTable {
  std::vector<ReceiverEntry> receivers;
  double beam_power = 0;  // W, 0: not stated
};

ReceiverTable receiver_table(RunContent const&);

std::string receiver_text(ReceiverTable const&, std::size_t show);
std::string census_text(ReceiverTable const&, std::size_t show);
std::string source_text(ReceiverTable const&);  // sources by receivers; rows by power
std::string source_csv(ReceiverTable const&);   // one row per source and receiver, all digits
std::string receiver_csv(ReceiverTable const&, RunContent const&);
std::string census_csv(ReceiverTable const&, RunContent const&);
std::string receiver_json(ReceiverTable const&, RunContent const&);
nlohmann::ordered_json receiver_page_list(ReceiverTable const&);  // of each its light and the table of its routes

// Maps of all receivers as NAME_image.csv, .npy and so on in a folder that exists; returns the names of the files.
// `areas`: of the pixels or cells of each receiver within the rim of its surface, m^2 (world/model/world.hpp).
std::vector<std::string> write_maps(std::string const& folder, RunContent const&,
                                    std::vector<std::vector<double>> const& areas);

}  // namespace straytrace::results
