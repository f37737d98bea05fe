// SPDX-License-Identifier: BSD-3-Clause
// Control loops of the lengths of a dual-recycled interferometer (docs/theory/interferometer.md, eq. N.4 and N.5).
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input/table.hpp"
#include "ifo/network_model.hpp"
#include "spectra/transfer_function.hpp"

namespace straytrace::ifo {

class DualRecycled;  // ifo/dual_recycled.hpp
enum class Freedom : std::uint8_t;

// The lengths that loops control besides DARM, whose loop cancels in h.
inline constexpr std::array<std::string_view, 4> controlled_lengths = {"CARM", "MICH", "PRCL", "SRCL"};

struct ControlLoop {
  // held: the length does not change, as with an ideal sensor and infinite gain. closed: a sensor of the light and an
  // open-loop gain. free: no loop.
  enum class Kind : std::uint8_t { held, closed, free };
  Kind kind = Kind::held;
  NamedReadout sensor{};         // of a closed loop
  TransferFunction open_loop{};  // G, with no other loop acting; positive: suppresses by 1/(1 + G)
  // Share of the way from the actuator to the read-out of DARM that a feed-forward filter subtracts; 1: all of it.
  TransferFunction feedforward{};
};
using ControlLoops = std::array<ControlLoop, controlled_lengths.size()>;  // in the order of controlled_lengths

// The table `loops` of an interferometer; what it does not name is held. `model`: the sensors.
ControlLoops read_control_loops(Node const& interferometer, NetworkModel const& model, Band const&);

// "CARM, MICH and SRCL held; PRCL by POP_I"
std::string describe(ControlLoops const&);

// Warns of loops that are close to instability or unstable in the band, and refuses sensors that their length does not
// reach.
void check_control_loops(Node const& interferometer, DualRecycled const&, ControlLoops const&, Band const&);

// The read-out of DARM with all loops acting. Held lengths are the default: without loops, common radiation pressure
// on both arms would dominate the read-out below 10 Hz, through the dark-fringe offset.
class ControlledResponse {
 public:
  ControlledResponse(DualRecycled const&, double hz, ControlLoops const& = {});

  using Cause = std::function<Phasor(LinearResponse const&)>;  // response of any read-out to it
  Phasor to(Cause const&) const;
  Phasor to_freedom(Freedom) const;
  Phasor to_phase(Injection const&) const;
  Phasor to_amplitude(Injection const&) const;

  // The response with all lengths held, and what the motion of each length adds to it, less its feed-forward; the sum
  // is to(cause). A held length adds nothing.
  struct Parts {
    Phasor held = 0;
    std::array<Phasor, controlled_lengths.size()> by_length{};
  };
  Parts parts(Cause const&) const;
  // Response of the read-out to a noise of the sensor of this closed loop, per unit of the sensor.
  Phasor to_sensor_noise(std::size_t loop) const { return -weight_[Eigen::Index(loop)]; }

 private:
  static constexpr int count = int(controlled_lengths.size());
  using Row = Eigen::Matrix<Phasor, 1, count>;
  using Square = Eigen::Matrix<Phasor, count, count>;
  Square responses(std::vector<LinearResponse> const&) const;  // rows: read-outs, columns: actuators

  DualRecycled const& d_;
  LinearResponse read_;
  std::vector<LinearResponse> lengths_, sensors_;  // the lengths themselves; what the loops sense
  Row seen_, kept_;                                // read-out per m of each actuator; less feed-forward
  Row weight_;                                     // of what the loops sense, in the read-out
  Row per_length_;                                 // read-out per m of each length
  Square actuate_;                                 // m of each actuator per unit of what the loops sense, negative
  Square move_;                                    // m of each length per m of each actuator
};

// Of an open-loop gain in a band and around its corner frequencies.
struct LoopMargins {
  double unity_gain = not_a_number;                  // Hz, the highest; not a number: |G| does not cross 1
  double phase_margin = not_a_number;                // rad, there
  double least = infinity, least_at = not_a_number;  // |1 + G| and its frequency, Hz
  bool encircles = false;                            // G goes around -1: the closed loop is unstable
};
LoopMargins loop_margins(TransferFunction const& open_loop, Band const&);

// What the loops do at one Fourier frequency. Complex numbers for motion proportional to exp(+2 pi i f t).
struct LoopRow {
  std::string length, sensor{};                                // sensor: "held" or "free" without one
  char const* unit = "";                                       // of the sensor
  Phasor plant = not_a_number;                                 // sensor per m of the actuator, with no loop acting
  Phasor open_loop = not_a_number, suppressed = not_a_number;  // G, 1/(1 + G)
  Phasor noise_to_strain = not_a_number;                       // strain per unit of noise of the sensor
  LoopMargins margins{};
};
std::vector<LoopRow> loop_rows(DualRecycled const&, ControlledResponse const&, ControlLoops const&, double hz,
                               Band const&);

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
  std::vector<StrayByLoop> stray{};
};

}  // namespace straytrace::ifo
