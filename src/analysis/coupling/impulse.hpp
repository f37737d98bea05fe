// SPDX-License-Identifier: BSD-3-Clause
// Response of a target to impulse excitation, divided by the force, in frequency and in time, and the modes that ring
// (R6.02, R6.03).
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "base/namespaces.hpp"
#include "spectra/series.hpp"
#include "spectra/welch.hpp"

namespace straytrace::analysis {

// First samples of impulses, GPS s: where the force leaves its median by `threshold` times its usual deviation (1.4826
// times the median one). The search for the next resumes `length` s later.
std::vector<double> find_taps(TimeSeries const& force, double threshold, double length);

struct ImpulseSettings {
  double before = 0.01;      // s of silence taken in front of each start
  double length = 2;         // s of each stretch
  double low = 0, high = 0;  // Hz, search range of modes
  int modes = 3;             // at most
  // The stretch ends while the target still rings, as after an impulse; false: the response has decayed by the end (a
  // sweep and silence), so it is not truncated.
  bool cut = true;
};

struct RingDown {
  double hz = 0, hz_sigma = 0;
  double quality = 0, quality_sigma = 0;  // Q = pi f tau
  double tau = 0;                         // s, of the amplitude
  double amplitude = 0,
         amplitude_sigma = 0;  // of a exp(-t/tau) cos(2 pi f t + phase): target unit per (force unit x s)
  double phase = 0;            // rad
  double chi_square = 0;
  int degrees = 0;
};

struct ImpulseResponse {
  std::size_t stretches = 0;
  std::vector<double> hz;
  std::vector<std::complex<double>> response;  // sum conj(F) Y/sum |F|^2: target unit per force unit, exp(+2 pi i f t)
  std::vector<double> sigma, coherence;        // of |response|; coherence less the chance coherence
  std::vector<double> time, value;             // s after the impulse; target unit per (force unit x s)
  double value_sigma = 0;                      // from the noise of the target
  std::vector<RingDown> modes;                 // the strongest first

  std::vector<double> ringing() const;  // all modes together at `time`, as they were fitted
};

// Stretches at `starts` (GPS s) without a window, which would distort the ringing. In time the response is damped by
// the coherence, so that frequencies without force or answer do not fill it with noise. Ringing left by earlier
// impulses is subtracted from the amplitudes of modes. Throws InputError with fewer than two stretches inside the data:
// without repeats there is no error.
ImpulseResponse impulse_response(TimeSeries const& force, TimeSeries const& target, std::span<double const> starts,
                                 ImpulseSettings const&);

// a exp(-t/tau) cos(2 pi f t + phase) from t = 0 to `length`, as a line of the transform around f, with a constant for
// the background; the line at -f is included. `from`, `to`: bins that are fitted. Errors are scaled by the
// residuals: times the root of chi^2 per degree of freedom.
RingDown fit_ring_down(ImpulseResponse const&, std::size_t from, std::size_t to, double length);

// Finds injections: stretches of a record whose spectrum rises above that of a quiet one (R6.01).

struct LoudStretch {
  double from = 0, to = 0;  // GPS s
  double hz = 0;            // of largest significance
  double ratio = 0;         // of ASDs there, event over quiet
  double significance = 0;  // there, of one bin and stretch
  double overall = 0;       // corrected for all bins and stretches searched: probability in noise alone
  std::size_t bins = 0;     // that pass
};

struct EventSettings {
  WelchSettings welch;
  std::size_t averages = 20;        // segments of each stretch
  double overall_significance = 3;  // of an event: one false one in 740 records
  double low = 0, high = 1e300;     // Hz, bins searched
};

// Neighbouring stretches that pass are one event. Throws InputError when the record is shorter than a stretch.
std::vector<LoudStretch> find_events(TimeSeries const& record, TimeSeries const& quiet, EventSettings const&);

}  // namespace straytrace::analysis
