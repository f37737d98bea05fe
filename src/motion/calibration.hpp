// SPDX-License-Identifier: BSD-3-Clause
// From the numbers of a sensor to displacement or angle.
#pragma once

#include <optional>

#include "base/input/table.hpp"
#include "motion/chain.hpp"

namespace straytrace {

// x = factor value / (-2 pi i f)^derivatives, and through `response` where the sensor is not flat.
struct Calibration {
  double factor = 1;    // SI; of the ASD
  bool is_psd = false;  // the value is a power density: sqrt first
  int derivatives = 0;  // 1: velocity, 2: acceleration (docs/theory/motion.md, eq. 11.3)
  Transfer response;
};

// What a number in this unit, `written` so in the scene or the file, is: `of_density`: the unit is that of a spectrum
// (m/sqrt(Hz), m^2/Hz, count/sqrt(Hz)), otherwise of samples (m, m/s, count, V). `spec` may hold `calibration: 6.1
// um/s^2/count`, or a table with that as `unit` beside a transfer function: {unit: um/s^2/count, file: sensor.txt,
// columns: [Hz, re, im]}. Nothing, and a problem at `unit_at`, when it is neither displacement, velocity nor
// acceleration then (of an angle for rotations).
std::optional<Calibration> read_calibration(Node const& spec, Quantity const& unit, std::string const& written,
                                            bool of_density, bool rotation, Node const& unit_at);

}  // namespace straytrace
