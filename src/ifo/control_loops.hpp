// SPDX-License-Identifier: BSD-3-Clause
// Strain with the control loops of other lengths acting (docs/theory/interferometer.md, eq. N.4 and N.5).
#pragma once

#include <Eigen/Core>

#include <functional>
#include <string>
#include <vector>

#include "base/input/table.hpp"
#include "ifo/network_interferometer.hpp"
#include "ifo/network_model.hpp"

namespace straytrace::ifo {

// The table `loops` of an interferometer, into the controlled lengths of the model; what it does not name is held.
void read_control_loops(Node const& interferometer, NetworkModel& model, Band const&);

// The list `subtract`: channels that are filtered and added to the read-out of strain.
void read_subtracted_channels(Node const& interferometer, NetworkModel& model, Band const&);

// "CARM, MICH and SRCL held, PRCL controlled by POP_I, REFL subtracted"
std::string describe(NetworkModel const&);

// Warns of loops that are close to instability or unstable in the band, and refuses sensors that do not respond to
// their length.
void check_control_loops(Node const& interferometer, NetworkModel const&, SteadyField const&, Band const&);

Phasor to_freedom(LinearResponse const&, NamedFreedom const&);  // per m

// Whether a degree of freedom appears in a read-out; otherwise its response there is rounding.
bool sees(Network const&, SteadyField const&, Readout const&, NamedFreedom const&, double hz);

// The read-out of strain with all loops acting. Without loops, common radiation pressure on both arms of a detector
// would dominate it below 10 Hz, through the dark-fringe offset: lengths are held by default.
class CalibratedStrain {
 public:
  CalibratedStrain(NetworkModel const&, SteadyField const&, double hz);  // of a model with `strain`

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
  // Filters of the subtracted channels, read-out of strain per unit of each, for exp(-2 pi i f t) (eq. N.33).
  Eigen::RowVectorXcd const& filters() const { return filters_; }

  SmallSignals const& signals() const { return signals_; }

  // The strain and its parts as read-outs of their own: sums of responses with the read-outs they come from.
  struct Sum {
    LinearResponse response;
    std::vector<std::pair<Phasor, Readout>> of{};
    void add(Phasor factor, LinearResponse const&, Readout const&);
    void add(Phasor factor, Sum const&);
  };
  Sum whole() const;
  std::vector<Sum> part_sums() const;                 // held, then by_length
  Phasor spectrum(Sum const& a, Sum const& b) const;  // one-sided, <a b*>, of the vacuum and the stated noises
  Phasor vacuum(Sum const& a, Sum const& b) const;    // of the vacuum alone

 private:
  Eigen::MatrixXcd responses(std::vector<LinearResponse> const&) const;
  Readout const& sensor(std::size_t loop) const;
  void subtract();
  Sum with_loops(LinearResponse const&, Readout const&, Eigen::RowVectorXcd const& weight) const;

  NetworkModel const& model_;
  Network const& network_;
  SteadyField const& field_;
  StrainScale scale_;
  double hz_;
  SmallSignals signals_;
  LinearResponse read_;
  std::vector<LinearResponse> lengths_, sensors_;  // the lengths themselves; what the loops sense
  std::vector<LinearResponse> channels_;           // that are subtracted
  Eigen::RowVectorXcd filters_;
  Eigen::RowVectorXcd seen_, kept_;  // read-out per m of each actuator; less feed-forward
  Eigen::RowVectorXcd weight_;       // of what the loops sense, in the read-out
  Eigen::RowVectorXcd per_length_;   // read-out per m of each length
  Eigen::MatrixXcd actuate_;         // m of each actuator per unit of what is sensed, negative
  Eigen::MatrixXcd move_;            // m of each length per m of each actuator
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
// ASD of the strain from one noise, 1/sqrt(Hz), by the ways it takes: the vacuum or a stated noise. Ways of one noise
// interfere; not a number outside a file.
struct NoiseByLoop {
  std::string noise;
  double held = 0;
  std::vector<double> by_length{};
  double total = 0;
};
// The filter of a subtracted channel at one frequency (eq. N.33).
struct SubtractedRow {
  std::string channel;
  bool best = true;
  Phasor filter = 0;  // read-out of strain per unit of the channel, for exp(+2 pi i f t)
};
struct LoopTable {
  double hz = 0;
  std::vector<LoopRow> loops{};
  std::vector<std::string> lengths{};  // that move: the columns of by_length
  std::vector<StrayByLoop> stray{};    // of the entrances of the model that have light
  std::vector<NoiseByLoop> noise{};    // the vacuum first
  std::vector<SubtractedRow> subtracted{};
};
LoopTable loop_table(NetworkModel const&, double hz, Band const&);

// Open-loop gain and suppression of the closed loops by frequency, for exp(+2 pi i f t); not a number outside the range
// of a table.
struct LoopCurve {
  std::string length;
  std::vector<Phasor> open_loop{}, suppressed{};
};
std::vector<LoopCurve> loop_curves(NetworkModel const&, std::vector<double> const& hz);

// Noise of the strain with all loops and subtractions acting: ASDs, 1/sqrt(Hz).
struct StrainNoise {
  std::vector<double> hz;
  std::vector<std::string> names{};        // "vacuum", then the causes
  std::vector<std::vector<double>> asd{};  // by name
  std::vector<double> total{}, as_read{};  // as_read: the total without the subtracted channels
};
StrainNoise strain_noise(NetworkModel const&, std::vector<double> const& hz);

}  // namespace straytrace::ifo
