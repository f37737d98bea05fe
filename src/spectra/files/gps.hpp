// SPDX-License-Identifier: BSD-3-Clause
// GPS time and UTC: seconds since 1980-01-06 00:00:00 UTC, without leap seconds.
#pragma once

#include <optional>
#include <string>

#include "base/namespaces.hpp"

namespace straytrace::spectra {

// "2019-02-01T12:00:00", with a space for T, with fractions, with Z; a date alone is its midnight. 23:59:60 only at
// leap seconds. Empty for other texts and before 1980-01-06.
std::optional<double> gps_of_utc(std::string const&);
// "2019-02-01T12:00:00Z", to the microsecond where it is not a whole second. Knows the leap seconds announced until
// 2026.
std::string utc_of_gps(double gps);
// To 0.1 us, without trailing zeros: "1234567890.5".
std::string gps_text(double gps);

}  // namespace straytrace::spectra
