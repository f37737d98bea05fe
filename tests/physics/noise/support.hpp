// SPDX-License-Identifier: BSD-3-Clause
// Small couplings, motions and detectors with known answers.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "base/every_module.hpp"
#include "noise/noise.hpp"
#include "noise/wrapped/phase_spectra.hpp"
#include "spectra/spectrum.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {

constexpr double wavelength = 1064e-9;
constexpr double two_k = 4 * pi / wavelength;  // rad/m, one bounce at normal incidence

// h = Im s: the strain spectrum is that of the fringes themselves.
class UnitDetector final : public Interferometer {
 public:
  std::complex<double> strain_per_phase(PortId, double) const override { return 1; }
  std::complex<double> strain_per_amplitude(PortId, double) const override { return 0; }
  double copies(PortId) const override { return 1; }
  std::string description() const override { return "h = Im s"; }
};

inline PhaseSensitivity phase_sensitivity(std::uint32_t body, int axis, double value) {
  PhaseSensitivity l{BodyId{body}, {}};
  l.d[axis] = value;
  return l;
}

// Half of a Gaussian of width 1 Hz around 0 Hz.
inline Spectrum around_zero(double rms) {
  std::vector<double> hz, psd;
  for (double f = 5e-4; f < 8; f += 0.02) {
    hz.push_back(f);
    psd.push_back(std::exp(-f * f / 2));
  }
  Spectrum const shape(hz, psd);
  return shape.scaled(rms * rms / shape.total());
}

// Bodies that move along z, each by its own input.
inline MotionSet moving(std::vector<Spectrum> const& spectra) {
  MotionSet set;
  for (std::uint32_t b = 0; b < spectra.size(); ++b) {
    set.bodies.push_back("body " + std::to_string(b));
    set.inputs.push_back({set.bodies.back() + " z", spectra[b], 0, {{BodyId{b}, 2, 1}}});
  }
  return set;
}

// A tone of the given peak along z of body 0.
inline MotionInput tone(double hz, double peak) { return {"tone", {}, hz, {{BodyId{0}, 2, peak}}}; }

inline PathRecord record(std::uint64_t history, double weight, std::vector<PhaseSensitivity> phase_sensitivities) {
  PathRecord r;
  r.history = history;
  r.weight = r.coupling = weight;
  r.phase_sensitivities = std::move(phase_sensitivities);
  return r;
}

// One class with exactly known mean: the same sum in all replicas.
inline CouplingClass known_class(std::uint64_t hash, double mean, std::vector<PathRecord> records) {
  CouplingClass c;
  c.hash = hash;
  c.port = PortId{0};
  c.coupling.mean = mean;
  c.coupling.trusted = true;
  c.coupling.scored = 1;
  c.replica_sum.fill(mean * 4096);
  c.records = std::move(records);
  return c;
}

inline CouplingTable known_table(std::vector<CouplingClass> classes) {
  CouplingTable t;
  t.classes = std::move(classes);
  t.ports = {"port"};
  t.replica_histories.fill(4096);
  t.histories = 4096 * replica_count;
  t.wavelength = wavelength;
  return t;
}

inline NoiseSettings on(std::vector<double> edges) {
  NoiseSettings s;
  s.grid.edges = std::move(edges);
  return s;
}

// Fringe spectrum [1/Hz] of one path of unit power with phase sensitivity 2k along z of body 0.
inline std::vector<double> fringe_psd(MotionSet const& motion, std::vector<double> edges) {
  CouplingTable const table = known_table({known_class(1, 1, {record(0, 1, {phase_sensitivity(0, 2, two_k)})})});
  std::vector<double> psd = project_noise(table, motion, UnitDetector(), on(std::move(edges))).total.asd;
  for (double& x : psd) x *= x;
  return psd;
}

// The same with the power of the unmoved light; kappa of the first input is (2k)^2.
inline PhaseSpectrum fringes(MotionSet const& motion, std::vector<double> edges) {
  PhaseSpectra const spectra(group_by_shape(motion), FrequencyGrid{std::move(edges)});
  std::vector<PhaseSensitivity> const phase_sensitivities = {phase_sensitivity(0, 2, two_k)};
  return spectra(kappa_of(motion, spectra.classes(), phase_sensitivities));
}

}  // namespace straytrace::testing
