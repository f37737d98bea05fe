// SPDX-License-Identifier: BSD-3-Clause
// A driven line in witness and target: what `couple lines` and `couple ramp` begin with.
#pragma once

#include <string>
#include <vector>

#include "app/couple_data.hpp"

namespace straytrace {

struct LineOptions {
  DataOptions data;
  PairOptions pair;
  std::string window = "4 s", wavelength = "1064 nm", save;
  double multiplicity = 1, z_max = 20, significance = 3;
  int harmonics = 5;
};
void add_line_options(CLI::App&, LineOptions&);  // all but --harmonics, --save, --significance and outputs

struct Driven {
  ChannelPair pair;
  std::vector<LinePoint> drive, target;  // drive in `unit`
  double window = 0, wavelength = 0;     // s, m
  std::string unit, coupling_unit;

  double frequency() const;  // Hz, mean
};
Driven follow_drive(LineOptions const&);
// Frequency, drive and target against time.
CurveSheet line_sheet(Driven const&);

}  // namespace straytrace
