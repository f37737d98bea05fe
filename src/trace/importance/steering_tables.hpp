// SPDX-License-Identifier: BSD-3-Clause
// The steps that make the steering tables (docs/theory/sampling.md): patches, exchange of light between them, targets,
// share of the BSDF model, pilot run, cells of maps.
#pragma once

#include <cstdint>
#include <vector>

#include "world/model/world.hpp"

namespace straytrace::trace {

// Exchange of light between patches, by quadrature over pairs of points with visibility.

// Light leaving one side of a patch, by sides of arrival.
struct Arriving {
  std::vector<float> share;
  std::vector<float> peak;  // mean square over mean of the share, over the pairs of points
  bool empty() const { return share.empty(); }
};
struct Exchange {              // of one side of one patch
  Arriving diffuse, by_law;    // F, per unit of power that leaves; and of the beams that start here, by their true BSDF
  std::vector<double> direct;  // score per unit of power arriving here, per goal
  double albedo = 0, emitted = 0;  // emitted: approximate total of which `by_law` is a part
};

// Goals: footprints of ports, then receivers, numbered as in scores.
std::vector<std::uint32_t> goals_of(WorldView const&);

// For every side of every patch. Sides without scatter have no lists; sides without a beam have no `by_law`.
std::vector<Exchange> exchanges(World const&, SteeringTables const&, std::vector<std::uint32_t> const& goals,
                                unsigned samples, unsigned threads);

// Importance with respect to one goal.
struct Worth {
  std::vector<double> adjoint;  // by sides
  std::vector<double> hops;     // still to come from each side, on average over the score
};

// Share alpha of the BSDF model in the mixture at one side of a patch, at least `least`, that keeps the variance low;
// the rest goes to `targets`. Of the light `emitted`, the share F_j arrives on side j (`arriving`). With q_j the
// probability of the target and A_j the adjoint, the relative second moment of the score, for the scene and for every
// part of it, is
//   R = sum_j F_j^2 A_j^2 / (alpha F_j + (1 - alpha) q_j) / (sum_j F_j A_j)^2        (within patches by quadrature)
// R - 1 of the scene is paid at every hop still to come; R of a part is paid once, by a path through a part that the
// BSDF model rarely samples. The share chosen minimises
//   sum over goals of  ln(1 + hops (R - 1)) + 1/4 mean over parts of ln R_part
double best_law_share(Arriving const& arriving, double emitted, std::vector<Target> const& targets,
                      std::vector<Worth> const& worths, std::size_t side, std::vector<std::uint32_t> const& part_of,
                      double least);

// Parts of the scene: groups of bodies, numbered.
struct Parts {
  std::vector<std::uint32_t> of_patch, body;  // part of each patch, body of each part
};
Parts parts_of(World const&, SteeringTables const&);

// Patches to aim at from one side of a patch, with probabilities that sum to 1, sorted by patch. transfer: share of the
// light that arrives on each side of each patch.
std::vector<Target> targets_of(Parts const&, std::vector<float> const& transfer, std::vector<Worth> const& worths,
                               std::size_t most);

// For scenes with more strips than the tables have rows: joins neighbours until there are at most `most` patches.
// Strips of one patch belong to one body and group and have one finish, and strips of lit surfaces and of receivers
// are not joined with other surfaces, as far as `most` allows. Patches are small where beams and receivers are near and
// may be large where they are far.
void merge_strips(World const&, std::size_t most, SteeringTables&);

// Scores of paths after they arrived on each side of each patch, from a short separate run. It includes mirrors and
// glass, which the diffuse exchange does not. Its histories never enter results.
struct Pilot {
  std::vector<std::uint64_t> visits;        // by side
  std::vector<double> arrived;              // power, by side
  std::vector<std::vector<double>> scored;  // by goal (footprints, then receivers), then by side
};

// Histories are numbered from 2^63, apart from those of the trace. The world must have steering tables.
Pilot run_pilot(World const&, std::uint64_t histories);

// Sets the cells of maps without stated pixels, as small as the light of a short separate run allows, for receivers
// with such maps in a world with steering tables. The histories of that run never enter results, so the contents of the
// cells are independent of the cells. A function of the scene only.
void find_map_cells(World&);

}  // namespace straytrace::trace
