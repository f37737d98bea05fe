// SPDX-License-Identifier: BSD-3-Clause
// Records made periodic, so that linear systems act on them by one transform.
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

namespace straytrace {

// The least n' >= n that is a power of two times 3^a 5^b, with all the factors two of n: twice the samples have twice
// the period. Transforms of other lengths are slow.
std::size_t quick_length(std::size_t n);

// `period` samples: x, then a smooth way from its last value back to its first.
std::vector<double> made_periodic(std::span<double const> x, std::size_t period);

// Linear system on one period of a real series: `response` in the convention of the tree, exp(-2 pi i f t), at k * rate
// / n for k > 0; at f = 0 it is `at_zero`. `n` even.
std::vector<double> filtered(std::vector<double> const& x, double rate,
                             std::function<std::complex<double>(double hz)> const& response, double at_zero = 0);

// Series of n samples from the coefficients c_k of exp(+2 pi i k i/n), 0 < k < n/2: x = 2 Re sum c_k exp(...).
std::vector<double> synthesised(std::vector<std::complex<double>> const& coefficients, std::size_t n);

}  // namespace straytrace
