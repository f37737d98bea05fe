// SPDX-License-Identifier: BSD-3-Clause
// Windows of spectral estimates.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::spectra {

// Periodic: they repeat after the segment, as scipy.signal.get_window gives them.
enum class Window : std::uint8_t { rectangular, hann, hamming, blackman, blackman_harris, flat_top, tukey, kaiser };

// `parameter`: tapered share of a Tukey window, beta of a Kaiser window; others have none.
std::vector<double> window_weights(Window, double parameter, std::size_t samples);

struct NamedWindow {
  Window window = Window::hann;
  double parameter = 0;
};
// "hann", "tukey(0.25)", "kaiser(14)"; Tukey alone is 0.5. Throws InputError with the known names.
NamedWindow parse_window(std::string const&);
std::string window_text(NamedWindow);

}  // namespace straytrace::spectra
