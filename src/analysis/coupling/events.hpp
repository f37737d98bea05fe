// SPDX-License-Identifier: BSD-3-Clause
// When was something injected? Stretches of a record whose spectrum rises above that of a quiet one (R6.01).
#pragma once

#include <vector>

#include "spectra/series.hpp"
#include "spectra/welch.hpp"

namespace straytrace {

struct LoudStretch {
  double from = 0, to = 0;  // GPS s
  double hz = 0;            // where it is surest
  double ratio = 0;         // of ASDs there, event over quiet
  double significance = 0;  // there, of one bin and stretch
  double overall = 0;       // with all bins and stretches that were looked at: what noise alone would show
  std::size_t bins = 0;     // that pass
};

struct EventSettings {
  WelchSettings welch;
  std::size_t averages = 20;        // segments of each stretch
  double overall_significance = 3;  // of an event: one false one in 740 records
  double low = 0, high = 1e300;     // Hz, bins that are looked at
};

// Neighbouring stretches that pass are one event. Throws InputError when the record is shorter than a stretch.
std::vector<LoudStretch> find_events(TimeSeries const& record, TimeSeries const& quiet, EventSettings const&);

}  // namespace straytrace
