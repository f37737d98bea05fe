// SPDX-License-Identifier: BSD-3-Clause
// A coupling function from stretches with an injection and one without: their spectra, the witness in metres, all
// injections together (R6.01).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/coupling/band_coupling.hpp"
#include "analysis/coupling/coupling.hpp"
#include "analysis/coupling/lines.hpp"

namespace straytrace::analysis {

// A stretch as found in a record. Two stretches must not overlap: quiet data would contain the injection, or one
// injection would count twice. Records of different files share their time only where that is GPS.
struct FoundStretch {
  std::string name, file;   // "--quiet 0..24"
  double from = 0, to = 0;  // GPS s
};
void refuse_overlaps(std::vector<FoundStretch> const&);

// Conversion of a witness to metres: divide by (2 pi f)^times.
struct ToMetres {
  int times = 0;
  double scale = 1;  // of its unit to SI
  std::string unit;  // "m", or the original unit
};
ToMetres to_metres(bool displacement, std::string const& unit);
void in_metres(ToMetres const&, std::vector<LinePoint>&);
void in_metres(ToMetres const&, std::vector<RidgePoint>&);

// Cross spectra of witness and target in one stretch.
struct StretchSpectra {
  CrossSpectra cross;
  std::string witness, target, witness_unit, target_unit;
  WelchSettings welch;
};

// One witness over all injections.
struct InjectionCoupling {
  CouplingFunction coupling;
  CrossSpectra quiet;                 // witness in the unit of the coupling
  TransferEstimate linear;            // H1 of all injections
  std::optional<BandCoupling> whole;  // where single lines are not linear

  std::size_t line_at(double hz) const;
  // Contribution of the quiet witness to the quiet target, as a share of amplitudes.
  double share(CouplingPoint const&) const;
};
// On the lines from low to high, Hz. `displacement`: the witness becomes metres.
InjectionCoupling couple_injections(StretchSpectra const& quiet, std::span<StretchSpectra const> injections,
                                    bool displacement, CouplingThresholds const&, double low, double high);

// Positions of values above zero that no neighbour exceeds.
std::vector<std::size_t> peaks_of(std::span<double const> heights);

}  // namespace straytrace::analysis
