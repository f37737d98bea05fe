// SPDX-License-Identifier: BSD-3-Clause
// Coupling functions as CSV of pemcoupling: frequency, factor, factor_counts, flag. Ours add columns behind these.
#pragma once

#include <string>
#include <string_view>

#include "analysis/coupling/coupling.hpp"

namespace straytrace {

// Read tolerantly: columns in any order, further columns, flags in any case, "Measured" for "Real", a header with a
// comma missing. The unit of the factor, the unit and names of channels come from our own columns; pemcoupling's have
// none, so `unit` ("m/m", "1/m", ...) and `witness_unit` must say them then. Throws InputError with file and line.
CouplingFunction parse_coupling(std::string_view csv, std::string const& file, std::string const& unit = "",
                                std::string const& witness_unit = "");

// Upper limits stand in the column of factors with their flag; what is unknown is empty.
std::string coupling_csv(CouplingFunction const&);

}  // namespace straytrace
