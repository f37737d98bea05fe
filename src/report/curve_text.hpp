// SPDX-License-Identifier: BSD-3-Clause
// The formats of report/curve_file.hpp, as bytes. Inside the room.
#pragma once

#include <string>

#include "report/curve_file.hpp"

namespace straytrace::curve_format {

std::string text(CurveSheet const&);
std::string csv(CurveSheet const&);
std::string json(CurveSheet const&);
std::string hdf5(CurveSheet const&, std::string const& file);  // InputError for an irregular axis
std::string text(MapSheet const&);
std::string csv(MapSheet const&);
std::string json(MapSheet const&);
std::string hdf5(MapSheet const&, std::string const& file);
// One page: title, notes, picture inline, table.
std::string html(CurveSheet const&, std::string const& png);
std::string html(MapSheet const&, std::string const& png);

// The step of an axis, or 0 where it is not regular to 1e-6 of a step.
double regular_step(std::vector<double> const& axis);

}  // namespace straytrace::curve_format
