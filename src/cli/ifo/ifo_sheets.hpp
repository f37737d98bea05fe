// SPDX-License-Identifier: BSD-3-Clause
// Answers about a network as tables. Inside the module.
#pragma once

#include "ifo/control_loops.hpp"
#include "ifo/layout/operating_point.hpp"
#include "ifo/layout/signals.hpp"
#include "ifo/network_interferometer.hpp"
#include "results/text/table.hpp"

namespace straytrace::cli {

std::vector<Sheet> point_sheets(OperatingPoint const&);
std::vector<Sheet> mode_sheets(ModeTable const&);
Sheet scan_sheet(NetworkModel const&, NetworkScan const&);
Sheet errors_sheet(std::vector<ErrorSignal> const&);
Sheet slopes_sheet(NamedReadout const&, std::vector<ParameterSlope> const&);
Sheet transfer_sheet(NetworkCause const&, std::string const& effect, std::string const& effect_unit,
                     std::vector<double> const& hz, std::vector<Phasor> const& response);
Sheet sensing_sheet(SensingMatrix const&);
Sheet noise_sheet(NamedReadout const&, NamedFreedom const* referred, ReadoutNoise const&);
std::vector<Sheet> loop_sheets(LoopTable const&);
Sheet suppression_sheet(std::vector<double> const& hz, std::vector<LoopCurve> const&);
Sheet strain_noise_sheet(StrainNoise const&);
Sheet stray_sheet(NetworkModel const&, std::vector<StrayRow> const&);         // at one frequency
Sheet stray_curve(std::vector<StrayRow> const&, std::string const& readout);  // of one entrance

}  // namespace straytrace::cli
