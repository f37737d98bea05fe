// SPDX-License-Identifier: BSD-3-Clause
// The steps that make the steering tables (docs/theory/sampling.md): patches, exchange of light between them, targets,
// share of the BSDF model, pilot run, cells of maps.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "world/model/world.hpp"

namespace straytrace::trace {

// Exchange of light between patches, by lines between points of both (docs/theory/sampling.md, eq. 1.22 and 1.23).

// Shares of light along the lines from one side of a patch to one side of another.
struct LineSum {
  double first = 0, second = 0;  // mean share, and mean of its square
  void add(double share, unsigned lines) {
    first += share;
    second += share * share * lines;
  }
};
// Light leaving one side of a patch, by sides of arrival.
class Arriving {
 public:
  Arriving() = default;
  explicit Arriving(std::size_t sides) : on_(sides) {}
  bool empty() const { return on_.empty(); }
  std::size_t size() const { return on_.size(); }
  // `hidden`: the one line traced was.
  void set(std::size_t side, LineSum const& sum, bool hidden) {
    if (empty()) return;
    on_[side] = {hidden ? -float(sum.first) : float(sum.first), sum.first > 0 ? float(sum.second / sum.first) : 0};
  }
  double share(std::size_t side) const { return std::max(on_[side].share, 0.0f); }
  // Of two functions of the sides.
  std::array<double, 2> sums_of(std::vector<double> const& a, std::vector<double> const& b) const {
    double of_a[2] = {}, of_b[2] = {};  // fronts and backs
    for (std::size_t i = 0; i < on_.size(); i += 2)
      for (std::size_t k = 0; k < 2; ++k) {
        of_a[k] += share(i + k) * a[i + k];
        of_b[k] += share(i + k) * b[i + k];
      }
    return {of_a[0] + of_a[1], of_b[0] + of_b[1]};
  }
  // What light is aimed by: where the one line traced was hidden, `unseen` of what would arrive without obstacles
  // (docs/theory/sampling.md, eq. 1.24).
  double possible(std::size_t side, double unseen) const {
    double const share = on_[side].share;
    return share > 0 ? share : -unseen * share;
  }
  // Mean square over mean of the share, over the lines.
  double peak(std::size_t side) const { return on_[side].peak; }

 private:
  struct OneSide {
    float share = 0, peak = 0;  // share negative: hidden, and what would arrive otherwise
  };
  std::vector<OneSide> on_;
};
struct Exchange {              // of one side of one patch
  Arriving diffuse, by_law;    // F, per unit of power that leaves; and of the beams that start here, by their true BSDF
  std::vector<double> direct;  // score per unit of power arriving here, per goal
  double albedo = 0, emitted = 0;  // emitted: approximate total of which `by_law` is a part
};

// Goals: footprints of ports, then receivers, numbered as in scores.
std::vector<std::uint32_t> goals_of(WorldView const&);

// For every side of every patch. Sides without scatter have no lists; sides without a beam have no `by_law`.
// With more patches than this one line from side to side is traced, otherwise every line.
constexpr std::size_t patches_with_every_line = 256;
std::vector<Exchange> exchanges(World const&, SteeringTables const&, std::vector<std::uint32_t> const& goals,
                                unsigned samples, unsigned threads);
// Traces all lines between pairs of patches: a list for each patch.
void trace_every_line(World const&, SteeringTables const&, std::vector<std::vector<std::uint32_t>> const& pairs,
                      unsigned samples, unsigned threads, std::vector<Exchange>&);

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
  std::vector<std::uint32_t> of_patch, body;  // part of each patch, body of each part; both numbered by appearance
  std::size_t bodies = 0;
};
Parts parts_of(World const&, SteeringTables const&);

// Effort to spend on each patch from one side of a patch; 1 in all, or none.
std::vector<double> efforts_of(Parts const&, Arriving const&, std::vector<Worth> const& worths, double unseen);
// The patches of most effort, with probabilities that sum to 1, sorted by patch.
std::vector<Target> targets_of(std::vector<double> const& efforts, std::size_t most);

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
