// SPDX-License-Identifier: BSD-3-Clause
// Chains of transfer functions between the ground and a body, and files of measured motion.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "base/input/table.hpp"
#include "spectra/filters.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::motion {

// Files of measured motion, and the warnings about their ends: outside its range a file gives no motion.

// Transfer functions between a carrier and a body: structures with resonances, suspensions, measured tables.

// Shared by bodies that move alike; null: 1.
using Transfer = std::shared_ptr<TransferFunction const>;
// First `a`, then `b`.
Transfer chained(Transfer const& a, Transfer const& b);

// Whether a chain is valid from `low` to `high` Hz; a problem at `where` otherwise.
bool covers(Transfer const&, double low, double high, Node const& where);
// Factor on the amplitude of a tone, for exp(+2 pi i f t). 1 and a problem outside the range of the chain.
std::complex<double> at_tone(Transfer const&, double hz, Node const& where);

// `through` of a motion: one link or a list of them, from the carrier to the body. A link is {resonance: {frequency:,
// quality:}}, {mode: {...}} for the motion relative to its carrier, {pendulum: STAGES}, {zeros:, poles:, gain:} or
// {file: FILE, columns: [Hz, re, im]}, with `beyond: hold` as an option. Problems go to the document.
Transfer read_chain(Node const& through);

// Stages of a suspension, from its support to the last mass: {frequency: 0.6 Hz, quality: 10} or a list of them, one
// for each NORMAL MODE, or {masses: [...], lengths: [...], quality: 10} from the top down. The transfer function from
// the support to the last of a chain of point masses has no zeros: it is the product of one low pass for each normal
// mode.
TransferFunction read_stages(Node const& stages);

// Normal modes of a chain of pendulums, Hz, rising: masses [kg] and lengths [m] from the top down.
std::vector<double> pendulum_modes(std::vector<double> const& masses, std::vector<double> const& lengths);

// One coordinate whose motion comes from a file without `beyond: zero`.
struct MotionFile {
  std::string name, coordinate;  // as written; "tube z"
  Band known;                    // Hz, of the file
  Band covered;                  // Hz, extended by other motion of the coordinate without a gap
  double asd_low = 0;            // m/sqrt(Hz) of the coordinate at known.low; 0 for rotations
  Place place = {};
};

// `a` extended by all bands that touch it, directly or through others.
Band joined(Band a, std::span<Band const> others);

// Highest frequency that fringes of one reflection would reach by the motion below f_0 = known.low, extrapolated as
// f^-2 down to 0.1 Hz: 4 times the rms fringe frequency 2 v/lambda (docs/theory/spectra.md, eq. 7.8), with
// v^2 = (2 pi)^2 asd_low^2 f_0^4 (1/0.1 Hz - 1/f_0). Hz; 0 for files that begin at 0.1 Hz or below.
double reach_of_missing(MotionFile const&, double wavelength_m);

// One warning for each file that does not cover the band of the noise, or begins so high that the missing motion below
// it may affect fringe wrapping in that band.
std::vector<Problem> warnings_of_gaps(std::span<MotionFile const>, Band noise, double wavelength_m);

// Measured motion spectra in text files.

// {asd: FILE, columns: [Hz, m/sqrt(Hz)], use: [1, 3]}: two columns of text as a displacement PSD [m^2/Hz], or an angle
// PSD [rad^2/Hz] for rotations. The units are those of the two columns, or of all columns of the file when `use` picks
// two of them. The unit decides between ASD and PSD and between displacement, velocity and acceleration; readings of a
// sensor need `calibration`.
Spectrum read_spectrum_file(Node const& spec, bool rotation);

// From the numbers of a sensor to displacement or angle.

// x = factor value / (-2 pi i f)^derivatives, and through `response` where the response of the sensor is not flat.
struct Calibration {
  double factor = 1;    // SI; of the ASD
  bool is_psd = false;  // the value is a power density: sqrt first
  int derivatives = 0;  // 1: velocity, 2: acceleration (docs/theory/motion.md, eq. 11.3)
  Transfer response;
};

// Calibration of a number in this unit, `written` so in the scene or the file. `of_density`: the unit is that of a
// spectrum
// (m/sqrt(Hz), m^2/Hz, count/sqrt(Hz)), otherwise of samples (m, m/s, count, V). `spec` may hold `calibration: 6.1
// um/s^2/count`, or a table with that as `unit` beside a transfer function: {unit: um/s^2/count, file: sensor.txt,
// columns: [Hz, re, im]}. Empty, and a problem at `unit_at`, when the result is neither displacement, velocity nor
// acceleration (of an angle for rotations).
std::optional<Calibration> read_calibration(Node const& spec, Quantity const& unit, std::string const& written,
                                            bool of_density, bool rotation, Node const& unit_at);

}  // namespace straytrace::motion
