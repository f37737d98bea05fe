// SPDX-License-Identifier: BSD-3-Clause
// Signals of stray light without an interferometer (photodiodes, local oscillators, quadrants), and the response of h
// to one coordinate.
#pragma once

#include <algorithm>
#include <complex>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "noise/noise.hpp"
#include "noise/time_domain/time_domain.hpp"
#include "spectra/series.hpp"

namespace straytrace::noise {

// Photodiodes, local oscillators and quadrants on the beams of ports: their signals by stray light, without an
// interferometer (docs/theory/time_domain.md, eq. N.22 to N.24).

// What a sensor reads, relative to its main light.
enum class SensorKind : std::uint8_t {
  power,    // dP/P = 2 Re s
  phase,    // rad: Im s, by a local oscillator
  quadrant  // X/P: 2 Re of the stray field in the mode with one half reversed: of diffuse light as strong as s
};

// A sensor as the only thing that stray light reaches: "strain" is its signal.
class SensorResponse final : public ifo::Interferometer {
 public:
  SensorResponse(PortId port, SensorKind kind) : port_(port), kind_(kind) {}
  std::complex<double> strain_per_phase(PortId port, double) const override {
    return port.value == port_.value && kind_ == SensorKind::phase ? 1 : 0;
  }
  std::complex<double> strain_per_amplitude(PortId port, double) const override {
    return port.value == port_.value && kind_ != SensorKind::phase ? 2 : 0;
  }
  double copies(PortId) const override { return 1; }
  std::string description() const override { return "a sensor on the beam of a port"; }

 private:
  PortId port_;
  SensorKind kind_;
};

// A sensor on the beam of a port.
struct Sensor {
  std::string name;
  PortId port;
  double caught = 1;                           // eta of eq. N.22: share of its main light that falls on it
  std::optional<std::uint32_t> receiver = {};  // where its watts are counted, by position
  double share = 1;  // its main light, as far as the mode reaches, over that of the main mode of the table
};

// The table with |s_D|^2 as couplings (eq. N.22, N.23). Couplings of the table hold the share of the beam at the port
// (eq. 1.2), as light that returns into a tapped beam does; over the main light of the sensor it counts as 1/share^2.
// That of scattered light is over eta too, which is exact for a radiance that is the same all over the sensor. Computed
// routes keep it, as light in the mode of the main light does.
CouplingTable cut_by(std::span<Sensor const>, CouplingTable const&);

// Light on a receiver that does not overlap with the main light (P_in of eq. N.22) is as steady as its sources: with
// tones a of the amplitude of their fields it has those of 2a. By frequency [Hz], in the unit of the coupling: the
// power of these routes varies by Re(line exp(2 pi i f t)).
using SourceLines = std::map<double, std::complex<double>>;
SourceLines source_lines(std::span<CouplingClass const* const> received, LightModulation const&);
std::vector<double> asd_of(SourceLines const&, FrequencyGrid const&);  // one-sided, averaged over bins
void add_lines(TimeSeries&, SourceLines const&, double factor);        // tones begin with the record

struct SensorNoise {
  PortId port;
  std::vector<std::uint32_t> routes;  // of this port, positions in CouplingTable::classes
  NoiseBudget budget;                 // of these routes, in their order: relative ASD of the signal, 1/sqrt(Hz)
  // Routes of rims, whose light that passes reaches the sensor in other modes too, and on a quadrant all computed
  // routes, whose pattern is not known.
  std::size_t left_out = 0;
};
// The mean over static phases, where power and phase differ by the factor 2 only.
SensorNoise sensor_noise(CouplingTable const&, MotionSet const&, NoiseSettings, PortId, SensorKind);

// One realisation, four channels per port: "PORT power", "PORT phase", "PORT X", "PORT Y". The fields of X and Y have
// static phases of their own and no computed routes (eq. N.24); the motion is the same.
struct SensorSeries {
  std::vector<TimeSeries> channels;
  FastestFringe fastest;
  SampleTimes times;
};
SensorSeries sensor_series(CouplingTable const&, MotionSet const&, TimeDomainSettings const&);

// Response of h to one coordinate of one body, from the coupling table: the coupling function of small motion, and the
// response to a large one (docs/theory/spectra.md, eq. 7.2, 7.4, 7.9).

struct BodyAxis {
  BodyId body;
  int axis = 0;  // 0..2 translations x, y, z; 3..5 rotations about them
};

struct PredictedRoute {
  std::string name;
  std::vector<double> factor, sigma;  // strain per m (per rad for rotations); one standard error, Monte Carlo
  double phase = 0;         // rms of the phase per m (per rad), |J|: over its paths by power, of a row `other` by noise
  double multiplicity = 0;  // |J| lambda/4 pi: equivalent number of normal-incidence bounces; translations only
  bool resolved = true;
  bool upper_bound = false;
  std::string why_not;
  double share = 0;  // of the coupling power of all resolved routes, summed over the band
};

struct PredictedCoupling {
  FrequencyGrid grid;
  std::vector<double> factor, sigma;   // as the total of a budget: mean over static phases of small motion
  std::vector<double> bound_share;     // of factor^2, by routes computed as upper bounds
  std::vector<PredictedRoute> routes;  // those that move with the body, the largest share first
  std::vector<std::string> unresolved;
  // Smallest peak motion at which a route with 1 % of the observed coupling power has a phase of 1 rad: 1/|J|,
  // lambda/4 pi over its multiplicity. Beyond it coupling is not linear; m (rad).
  double linear_to = 0;
  bool has_bounds() const { return std::ranges::any_of(routes, &PredictedRoute::upper_bound); }
};

// h^2(f)/x^2(f) = sum over paths of f_p |J_p|^2/2 (|T_phase|^2 + |T_amplitude|^2): exact for motion so small that no
// phase reaches 1e-3 rad. The other bodies are at rest.
PredictedCoupling predict_coupling(CouplingTable const&, std::vector<std::string> const& bodies, Interferometer const&,
                                   FrequencyGrid const&, BodyAxis);

struct DrivenRoute {
  std::string name;
  double phase_peak = 0;  // rad, rms over its paths: z
  double cutoff = 0;      // Hz, z f_m: the edge of its shelf; of its first line where z is below 1
  bool resolved = true;
};
struct DrivenResponse {
  NoiseBudget budget;  // with the sine alone: averages over bins, 1/sqrt(Hz)
  std::vector<DrivenRoute> routes;
  double phase_peak = 0, cutoff = 0;  // the largest of the routes
};
// The same body driven by a sine of this peak amplitude (m, rad) at f_m, others at rest: exact at any amplitude.
DrivenResponse drive_body(CouplingTable const&, std::vector<std::string> const& bodies, Interferometer const&,
                          FrequencyGrid const&, BodyAxis, double peak, double hz);

// The body's own motion along this coordinate, of a scene: its input spectra, through their transfer functions. Other
// bodies and coordinates are at rest.
MotionSet motion_along(MotionSet const&, BodyAxis);
double rms_of(MotionSet const&, BodyAxis);  // m (rad); tones with their rms, drifts left out

}  // namespace straytrace::noise
