// SPDX-License-Identifier: BSD-3-Clause
// Strain with the control loops of other lengths acting (docs/theory/interferometer.md, eq. N.4 and N.5).
#pragma once

#include <Eigen/Core>

#include <functional>
#include <string>
#include <vector>

#include "base/input/table.hpp"
#include "ifo/network_model.hpp"
#include "ifo/stray_response.hpp"

namespace straytrace::ifo {

// The table `loops` of an interferometer, into the controlled lengths of the model; what it does not name is held.
void read_control_loops(Node const& interferometer, NetworkModel& model, Band const&);

// "CARM, MICH and SRCL held; PRCL by POP_I"
std::string describe(std::vector<ControlledLength> const&);

// Warns of loops that are close to instability or unstable in the band, and refuses sensors that do not respond to
// their length.
void check_control_loops(Node const& interferometer, NetworkModel const&, SteadyField const&, Band const&);

// Whether a degree of freedom appears in a read-out; otherwise its response there is rounding.
bool sees(Network const&, SteadyField const&, Readout const&, NamedFreedom const&, double hz);

// The read-out of strain with all loops acting. Without loops, common radiation pressure on both arms of a detector
// would dominate it below 10 Hz, through the dark-fringe offset: lengths are held by default.
class CalibratedStrain {
 public:
  CalibratedStrain(Network const&, SteadyField const&, StrainScale const&, std::vector<ControlledLength> const&,
                   double hz);
  CalibratedStrain(NetworkModel const& model, SteadyField const& field, double hz)  // of a model with `strain`
      : CalibratedStrain(model.network, field, *model.strain, model.controlled, hz) {}

  using Cause = std::function<Phasor(LinearResponse const&)>;  // response of any read-out to it
  Phasor to(Cause const&) const;                               // unit of the read-out
  StrayResponse to_stray(StrayWay const&) const;
  Phasor calibration() const { return per_metre_ * scale_.length; }  // read-out per unit of strain
  Phasor per_metre() const { return per_metre_; }                    // of the degree of freedom of strain

  // The response with all lengths held, and what the motion of each length adds to it, less its feed-forward; the sum
  // is to(cause). A held length adds nothing.
  struct Parts {
    Phasor held = 0;
    std::vector<Phasor> by_length{};
  };
  Parts parts(Cause const&) const;
  // Response of the read-out to a noise of the sensor of this closed loop, per unit of the sensor.
  Phasor to_sensor_noise(std::size_t loop) const { return -weight_[Eigen::Index(loop)]; }

 private:
  Eigen::MatrixXcd responses(std::vector<LinearResponse> const&, std::vector<ControlledLength> const&) const;

  Network const& network_;
  SteadyField const& field_;
  StrainScale scale_;
  double hz_;
  LinearResponse read_;
  std::vector<LinearResponse> lengths_, sensors_;  // the lengths themselves; what the loops sense
  Eigen::RowVectorXcd seen_, kept_;                // read-out per m of each actuator; less feed-forward
  Eigen::RowVectorXcd weight_;                     // of what the loops sense, in the read-out
  Eigen::RowVectorXcd per_length_;                 // read-out per m of each length
  Eigen::MatrixXcd actuate_;                       // m of each actuator per unit of what is sensed, negative
  Eigen::MatrixXcd move_;                          // m of each length per m of each actuator
  Phasor per_metre_ = 0;
};

// Of an open-loop gain in a band and around its corner frequencies.
struct LoopMargins {
  double unity_gain = not_a_number;                  // Hz, the highest; not a number: |G| does not cross 1
  double phase_margin = not_a_number;                // rad, there
  double least = infinity, least_at = not_a_number;  // |1 + G| and its frequency, Hz
  bool encircles = false;                            // G goes around -1: the closed loop is unstable
};
LoopMargins loop_margins(spectra::TransferFunction const& open_loop, Band const&);

// What the loops do at one Fourier frequency. Complex numbers for motion proportional to exp(+2 pi i f t).
struct LoopRow {
  std::string length, sensor{};                                // sensor: "held" or "free" without one
  Phasor plant = not_a_number;                                 // sensor per m of the actuator, with no loop acting
  Phasor open_loop = not_a_number, suppressed = not_a_number;  // G, 1/(1 + G)
  Phasor noise_to_strain = not_a_number;                       // strain per unit of noise of the sensor
  LoopMargins margins{};
};
// Strain per relative stray field at an entrance, by the ways it takes; their complex sum is `total`.
struct StrayByLoop {
  std::string entrance;
  bool phase = true;  // per Im s; else per Re s
  Phasor held = 0;    // with all lengths held
  std::vector<Phasor> by_length{};
  Phasor total = 0;
};
struct LoopTable {
  double hz = 0;
  std::vector<LoopRow> loops{};
  std::vector<std::string> lengths{};  // that move: the columns of by_length
  std::vector<StrayByLoop> stray{};    // of the entrances of the model that have light
};
LoopTable loop_table(NetworkModel const&, double hz, Band const&);

}  // namespace straytrace::ifo
