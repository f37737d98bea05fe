// SPDX-License-Identifier: BSD-3-Clause
// Equality of results to the last bit: -0 is not 0, and NaN equals itself.
#pragma once

#include <algorithm>
#include <cstring>
#include <vector>

#include "base/every_module.hpp"
#include "results/results.hpp"

namespace straytrace::test {

inline bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }
inline bool same_bits(std::vector<double> const& a, std::vector<double> const& b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return same_bits(x, y); });
}

inline bool same(ImportanceMap const& a, ImportanceMap const& b) {
  return same_bits(a.adjoint, b.adjoint) && same_bits(a.law_share, b.law_share) &&
         std::equal(a.strips.begin(), a.strips.end(), b.strips.begin(), b.strips.end(),
                    [](auto const& x, auto const& y) {
                      return x.group == y.group && x.patch == y.patch && same_bits(x.low, y.low) &&
                             same_bits(x.high, y.high) && same_bits(x.area, y.area);
                    });
}

inline bool same(Moments const& a, Moments const& b) {
  return same_bits(a.sum, b.sum) && same_bits(a.sum2, b.sum2) && same_bits(a.sum3, b.sum3) &&
         same_bits(a.sum4, b.sum4) && same_bits(a.block_sum2, b.block_sum2) && same_bits(a.largest, b.largest) &&
         a.largest_history == b.largest_history && a.scored == b.scored && same_bits(a.first_sum, b.first_sum) &&
         same_bits(a.tail, b.tail);
}

inline bool same(std::vector<PhaseSensitivityProduct> const& a, std::vector<PhaseSensitivityProduct> const& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](PhaseSensitivityProduct const& p, PhaseSensitivityProduct const& q) {
                      return p.replica == q.replica && p.first == q.first && p.second == q.second && p.sum == q.sum;
                    });
}

inline bool same(ClassSums const& a, ClassSums const& b) {
  bool equal = a.port == b.port && same(a.moments, b.moments) && a.replica_sum == b.replica_sum &&
               same_bits(a.threshold, b.threshold) && same_bits(a.off_list, b.off_list) &&
               a.kept.size() == b.kept.size() && a.phase_sensitivities.paths == b.phase_sensitivities.paths &&
               a.phase_sensitivities.weight == b.phase_sensitivities.weight &&
               a.phase_sensitivities.given_up == b.phase_sensitivities.given_up &&
               same(a.phase_sensitivities.products, b.phase_sensitivities.products);
  for (std::size_t i = 0; equal && i < a.kept.size(); ++i)
    equal = a.kept[i].history == b.kept[i].history && a.kept[i].event == b.kept[i].event &&
            a.kept[i].connection == b.kept[i].connection && same_bits(a.kept[i].coupling, b.kept[i].coupling) &&
            same_bits(a.kept[i].priority, b.kept[i].priority);
  return equal;
}

inline bool same(BlockSums const& a, BlockSums const& b) {
  bool equal = a.histories == b.histories && a.blocks == b.blocks && a.bounces == b.bounces && a.rays == b.rays &&
               a.lost == b.lost && same(a.emitted, b.emitted) && a.arrived.size() == b.arrived.size() &&
               a.absorbed.size() == b.absorbed.size() && a.classes.size() == b.classes.size();
  for (std::size_t i = 0; i < balance_term_count; ++i) equal = equal && same(a.energy_balance[i], b.energy_balance[i]);
  for (std::size_t i = 0; equal && i < a.arrived.size(); ++i) equal = same(a.arrived[i], b.arrived[i]);
  for (std::size_t i = 0; equal && i < a.absorbed.size(); ++i) equal = same(a.absorbed[i], b.absorbed[i]);
  for (auto const& [hash, sums] : a.classes)
    equal = equal && b.classes.contains(hash) && same(sums, b.classes.at(hash));
  return equal;
}

inline bool same(SumTree const& a, SumTree const& b) {
  bool equal = a.nodes().size() == b.nodes().size();
  for (auto const& [place, node] : a.nodes())
    equal = equal && b.nodes().contains(place) && same(node, b.nodes().at(place));
  return equal;
}

inline bool same(PathRecord const& a, PathRecord const& b) {
  bool equal = a.history == b.history && a.event == b.event && a.connection == b.connection &&
               same_bits(a.coupling, b.coupling) && same_bits(a.weight, b.weight) &&
               same_bits(a.path_length, b.path_length) && a.field == b.field && a.member == b.member &&
               a.beam == b.beam && a.phase_sensitivities.size() == b.phase_sensitivities.size() &&
               a.amplitude_levers.size() == b.amplitude_levers.size();
  for (std::size_t i = 0; equal && i < a.amplitude_levers.size(); ++i)
    equal = a.amplitude_levers[i].body == b.amplitude_levers[i].body &&
            std::ranges::equal(a.amplitude_levers[i].d, b.amplitude_levers[i].d);
  for (std::size_t i = 0; equal && i < a.phase_sensitivities.size(); ++i)
    equal =
        a.phase_sensitivities[i].body == b.phase_sensitivities[i].body &&
        std::memcmp(a.phase_sensitivities[i].d, b.phase_sensitivities[i].d, sizeof a.phase_sensitivities[i].d) == 0 &&
        std::ranges::equal(a.phase_sensitivities[i].moment, b.phase_sensitivities[i].moment,
                           [](double x, double y) { return same_bits(x, y); });
  return equal;
}

inline bool same(FoldedRoute const& a, FoldedRoute const& b) {
  return a.hash == b.hash && a.steps == b.steps && same_bits(a.mean, b.mean) && same_bits(a.std_error, b.std_error) &&
         a.trusted == b.trusted && a.why == b.why;
}

inline bool same(CouplingClass const& a, CouplingClass const& b) {
  bool equal = a.hash == b.hash && a.port == b.port && a.steps == b.steps && a.kind == b.kind &&
               a.statement == b.statement && same_bits(a.reverse, b.reverse) && a.by_reverse == b.by_reverse &&
               same_bits(a.coupling.mean, b.coupling.mean) && same_bits(a.coupling.std_error, b.coupling.std_error) &&
               same_bits(a.coupling.variance_of_variance, b.coupling.variance_of_variance) &&
               same_bits(a.coupling.largest_share, b.coupling.largest_share) &&
               same_bits(a.coupling.effective_scores, b.coupling.effective_scores) &&
               a.coupling.scored == b.coupling.scored && a.coupling.trusted == b.coupling.trusted &&
               a.coupling.why_not == b.coupling.why_not && same_bits(a.coupling.tail_slope, b.coupling.tail_slope) &&
               same_bits(a.coupling.halves, b.coupling.halves) && a.replica_sum == b.replica_sum &&
               a.records.size() == b.records.size() && a.folded_routes == b.folded_routes &&
               a.folded.size() == b.folded.size() && a.members.size() == b.members.size() &&
               same(a.phase_sensitivities, b.phase_sensitivities);
  for (std::size_t i = 0; equal && i < a.folded.size(); ++i) equal = same(a.folded[i], b.folded[i]);
  for (std::size_t i = 0; equal && i < a.members.size(); ++i) equal = a.members[i].steps == b.members[i].steps;
  for (std::size_t i = 0; equal && i < a.records.size(); ++i) equal = same(a.records[i], b.records[i]);
  return equal;
}

inline bool same(CouplingTable const& a, CouplingTable const& b) {
  bool equal = a.groups == b.groups && a.bodies == b.bodies && a.ports == b.ports && a.histories == b.histories &&
               a.seed == b.seed && same_bits(a.wavelength, b.wavelength) && a.reverse_routes == b.reverse_routes &&
               a.block_size == b.block_size && a.replica_histories == b.replica_histories &&
               a.classes.size() == b.classes.size();
  for (std::size_t i = 0; equal && i < a.classes.size(); ++i) equal = same(a.classes[i], b.classes[i]);
  return equal;
}

inline bool same(NoiseBands const& a, NoiseBands const& b) {
  bool equal = same_bits(a.input_low, b.input_low) && same_bits(a.input_high, b.input_high) &&
               same_bits(a.speckle_05, b.speckle_05) && same_bits(a.speckle_50, b.speckle_50) &&
               same_bits(a.speckle_95, b.speckle_95) && same_bits(a.coherent, b.coherent) &&
               a.taken_as_exact == b.taken_as_exact && a.sources.size() == b.sources.size();
  for (std::size_t i = 0; equal && i < a.sources.size(); ++i)
    equal = a.sources[i].name == b.sources[i].name && a.sources[i].statement == b.sources[i].statement &&
            same_bits(a.sources[i].low, b.sources[i].low) && same_bits(a.sources[i].high, b.sources[i].high) &&
            same_bits(a.sources[i].share, b.sources[i].share);
  return equal;
}

inline bool same(NoiseTrace const& a, NoiseTrace const& b) {
  return a.name == b.name && same_bits(a.linear_share, b.linear_share) && a.hash == b.hash && same_bits(a.asd, b.asd) &&
         same_bits(a.sigma, b.sigma) && same_bits(a.phase_asd, b.phase_asd) &&
         same_bits(a.amplitude_asd, b.amplitude_asd) && same_bits(a.mean_square_phase, b.mean_square_phase) &&
         same_bits(a.input_low, b.input_low) && same_bits(a.input_high, b.input_high) && a.resolved == b.resolved &&
         a.why_not == b.why_not;
}

inline bool same(NoiseBudget const& a, NoiseBudget const& b) {
  bool equal = same_bits(a.grid.edges, b.grid.edges) && same(a.total, b.total) && same(a.bands, b.bands) &&
               a.routes.size() == b.routes.size() && a.unresolved == b.unresolved &&
               same_bits(a.unresolved_hint, b.unresolved_hint) && a.design.size() == b.design.size() &&
               same_bits(a.margin, b.margin) && same_bits(a.seconds, b.seconds) && a.scanned_body == b.scanned_body &&
               a.positions.size() == b.positions.size();
  for (std::size_t i = 0; equal && i < a.positions.size(); ++i)
    equal = same_bits(a.positions[i].phase, b.positions[i].phase) && same_bits(a.positions[i].asd, b.positions[i].asd);
  for (std::size_t i = 0; equal && i < a.routes.size(); ++i) equal = same(a.routes[i], b.routes[i]);
  for (std::size_t i = 0; equal && i < a.design.size(); ++i)
    equal = a.design[i].name == b.design[i].name && same_bits(a.design[i].asd, b.design[i].asd);
  return equal;
}

}  // namespace straytrace::test
