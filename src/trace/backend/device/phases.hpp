// SPDX-License-Identifier: BSD-3-Clause
// The sum over many paths of fields whose phases move, on the device: one thread per sample, path after path, in the
// operations and the order of noise/time_domain/phase_sum.hpp, so that the bits are its bits.
#pragma once

#include <complex>

#include "base/math/simd.hpp"
#include "trace/backend/device/engine.hpp"
#include "trace/backend/device/ordered.hpp"

namespace straytrace::device {

struct SumPhases {
  double const *amplitude, *turns, *phase_sensitivity, *position;
  std::size_t paths, coordinates, samples;
  double *real, *imaginary;
  STRAY_HD void operator()(std::uint32_t i) const {
    double re = 0, im = 0;
    for (std::size_t j = 0; j < paths; ++j) {
      double phase = turns[j];
      for (std::size_t c = 0; c < coordinates; ++c) {
        double const by = phase_sensitivity[j * coordinates + c];
        if (by != 0) phase += by * position[c * samples + i];
      }
      add_turned(phase, amplitude[j], re, im);
    }
    real[i] = re;
    imaginary[i] = im;
  }
};

inline std::vector<std::complex<double>> summed_phases(PhaseOrder const& o) {
  Array<double> const amplitude(o.amplitude.begin(), o.amplitude.end()), turns(o.turns.begin(), o.turns.end()),
      phase_sensitivity(o.phase_sensitivity.begin(), o.phase_sensitivity.end()),
      position(o.position.begin(), o.position.end());
  Array<double> real(o.samples), imaginary(o.samples);
  for_each_number(std::uint32_t(o.samples),
                  SumPhases{data_of(amplitude), data_of(turns), data_of(phase_sensitivity), data_of(position),
                            o.amplitude.size(), o.coordinates, o.samples, data_of(real), data_of(imaginary)});
  std::vector<double> re(o.samples), im(o.samples);
  thrust::copy(real.begin(), real.end(), re.begin());
  thrust::copy(imaginary.begin(), imaginary.end(), im.begin());
  std::vector<std::complex<double>> sum(o.samples);
  for (std::size_t i = 0; i < o.samples; ++i) sum[i] = {re[i], im[i]};
  return sum;
}

}  // namespace straytrace::device
