// SPDX-License-Identifier: BSD-3-Clause
// Recursive filters as second-order sections (conventions of scipy.signal). Inside the room.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace straytrace {

// (b0 + b1/z + b2/z^2)/(1 + a1/z + a2/z^2)
struct Section {
  std::array<double, 3> b{1, 0, 0};
  std::array<double, 2> a{0, 0};
};

// Butterworth by the bilinear transform; edges as shares of half the sample rate, 0 <= low < high <= 1. low = 0: low
// pass, high = 1: high pass, otherwise a band pass of twice the order. Throws InputError for an order outside 1 to 12.
std::vector<Section> butterworth(int order, double low, double high);
// Unit gain but at `share` of half the sample rate, with width share/quality at -3 dB.
Section notch(double share, double quality);

std::vector<double> once(std::vector<Section> const&, std::vector<double> x);  // causal, from rest
// Forwards and backwards, the record continued by odd reflection and the filter settled on its ends
// (scipy.signal.sosfiltfilt). Throws InputError for a record shorter than that takes.
std::vector<double> both_ways(std::vector<Section> const&, std::vector<double> const& x);

}  // namespace straytrace
