// SPDX-License-Identifier: BSD-3-Clause
// Mie scatter of a sphere (Bohren and Huffman 1983, chapter 4). Host only.
#pragma once

#include <complex>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::optics {

struct MieSphere {
  double q_ext = 0, q_sca = 0;    // cross-sections over pi r^2
  double asymmetry = 0;           // mean cosine of the scattering angle
  std::vector<double> intensity;  // (|S1|^2 + |S2|^2)/2 at the given cosines; its integral over the sphere is
                                  // pi x^2 q_sca
};

// x = pi diameter/wavelength, index of the sphere over that of the medium, absorption by a positive imaginary part.
// Throws NumericalError when x is outside (0, 2e5].
MieSphere mie(double x, std::complex<double> index, std::vector<double> const& cosines);

struct SphereNumber {
  double x, number;
};
// Cosine series in the scattering angle, sum over l of series[l] cos(l Theta), of the sum of number times intensity.
// Exact: the intensity of a sphere is a polynomial in cos Theta. Throws as mie().
std::vector<double> mie_series(std::vector<SphereNumber> const&, std::complex<double> index);

}  // namespace straytrace::optics
