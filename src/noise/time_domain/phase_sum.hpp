// SPDX-License-Identifier: BSD-3-Clause
// Sum of many fields whose phases move: the coherent mode (docs/develop/performance.md).
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

namespace straytrace {

// What a sum over paths needs; phases in turns (1 turn = 2 pi).
struct PhaseTerms {
  std::vector<double> amplitude, turns;             // of each path: root of its power, static phase
  std::vector<double> phase_sensitivity;            // [path * coordinates + c], turns per metre or radian
  std::vector<std::span<double const>> coordinate;  // samples of each, m or rad; all as long

  std::size_t paths() const { return amplitude.size(); }
};

// s_n = sum_j a_j exp(2 pi i (turns_j + sum_c lever_jc x_c(t_n))), exact to 1e-15 of each term times the turns it has
// gone. Paths that one coordinate alone moves are a function of that coordinate: where that is less work they come from
// a table over its range, good to 2e-11 of sum |a_j|. The same bits for any number of threads (0: all cores).
// `direct`: what sums without tables, for example on a device; none: direct_phase_sum. `told`: the share that is done,
// 0 to 1, now and then, by the calling thread; not of what `direct` does.
using DirectSum = std::function<std::vector<std::complex<double>>(PhaseTerms const&)>;
using SumProgress = std::function<void(double share)>;
std::vector<std::complex<double>> phase_sum(PhaseTerms const&, unsigned threads = 0, DirectSum const& direct = {},
                                            SumProgress const& told = {});

// The same without tables.
std::vector<std::complex<double>> direct_phase_sum(PhaseTerms const&, unsigned threads = 0,
                                                   SumProgress const& told = {});

}  // namespace straytrace
