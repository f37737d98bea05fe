// SPDX-License-Identifier: BSD-3-Clause
// Unit strings of files: those of astropy and gwpy ("m / Hz(1/2)", "ct", "") and those that parse_unit reads.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/namespaces.hpp"

namespace straytrace::spectra {

// The same unit for parse_unit: "m / s2" -> "m/s^2", "ct" -> "count", "" and "strain" -> "1". Empty when it is valid
// in neither notation.
std::optional<std::string> unit_of_file(std::string_view);
// The same unit in astropy's generic format: "m/sqrt(Hz)" -> "m / Hz(1/2)", "1" -> "".
std::string gwpy_unit(std::string_view unit);

// "m" -> "m/sqrt(Hz)" and "m^2/Hz"; "1" -> "1/sqrt(Hz)" and "1/Hz"; "m/s^2" -> "m^2/s^4/Hz".
std::string asd_unit(std::string const& unit);
std::string psd_unit(std::string const& unit);
// Of a transfer function: "V/m" for V above and m below, "1" where they are equal.
std::string ratio_unit(std::string const& above, std::string const& below);

}  // namespace straytrace::spectra
