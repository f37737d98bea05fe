// SPDX-License-Identifier: BSD-3-Clause
// Michelson interferometer with arm cavities, power and signal recycling, in plane waves with radiation pressure
// (docs/theory/interferometer.md and docs/theory/sensitivity.md). The read-out is calibrated as DARM, h = (dLx -
// dLy)/L.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/input/table.hpp"
#include "ifo/interferometer.hpp"
#include "ifo/network.hpp"
#include "ifo/network_interferometer.hpp"
#include "ifo/network_model.hpp"
#include "ifo/ports.hpp"

namespace straytrace::ifo {
// Lengths of a dual-recycled interferometer and the degrees of freedom that light and loops see (R2.13).

// Arms, short arms from the splitter, power- and signal-recycling mirror from the splitter.
enum class Length : std::uint8_t { arm_x, arm_y, short_x, short_y, recycling, signal };
// The sixth, the mean short arm with PRCL and SRCL held, moves every mirror but the splitter's alike: it affects no
// light.
enum class Freedom : std::uint8_t { darm, carm, mich, prcl, srcl, mean_short };

using LengthMatrix = Eigen::Matrix<double, 6, 6>;

// Rows: DARM = Lx - Ly, CARM = (Lx + Ly)/2, MICH = lx - ly, PRCL = lp + (lx + ly)/2, SRCL = ls + (lx + ly)/2 and
// (lx + ly)/2.
inline LengthMatrix freedoms_of_lengths() {
  LengthMatrix m;
  m << 1, -1, 0, 0, 0, 0,    //
      0.5, 0.5, 0, 0, 0, 0,  //
      0, 0, 1, -1, 0, 0,     //
      0, 0, 0.5, 0.5, 1, 0,  //
      0, 0, 0.5, 0.5, 0, 1,  //
      0, 0, 0.5, 0.5, 0, 0;
  return m;
}
inline LengthMatrix lengths_of_freedoms() { return freedoms_of_lengths().inverse(); }

// Lengths in m, powers in W, transmissions and losses as fractions of power. Transmission 1 of a recycling mirror:
// none.
struct DualRecycledParameters {
  double wavelength = 1064e-9;
  double arm_length = 0, input_transmission = 0, end_transmission = 0;
  double round_trip_loss = 0;  // of an arm, at its end mirror
  double mirror_mass = infinity;
  double input_power = 0;  // at the power-recycling mirror
  double arm_power = 0;    // instead, in arm x; 0: from input_power
  double power_recycling_transmission = 1, signal_recycling_transmission = 1;
  // rad, one way, positive: longer; 0: resonant sideband extraction, pi/2: signal recycling.
  double signal_recycling_tuning = 0;
  double beam_splitter_loss = 0;  // of a round trip between the recycling mirror and the arms, as in eq. 6.11
  double signal_cavity_loss = 0;  // additional, of a round trip between the splitter and the signal-recycling mirror
  double splitter_transmission = 0.5;
  double power_recycling_length = 0, signal_recycling_length = 0;  // recycling mirror to splitter
  double short_arm = 0, schnupp_asymmetry = 0;                     // mean of the short arms, lx - ly
  // Arm x more, arm y less, by half of it: of the input transmission (relative) and of the round-trip loss.
  double transmission_difference = 0, loss_difference = 0;
  double dark_fringe_offset = 0;       // m of DARM; when not 0, its light is the local oscillator
  double homodyne_angle = pi / 2;      // rad, without an offset; pi/2: where DARM appears when the SRM is tuned
  double readout_loss = 0;             // of power, from the signal-recycling mirror to the photocurrent
  double squeezing = 1;                // noise power of the squeezed quadrature over that of the vacuum
  double squeezing_angle = 0;          // rad, from the best one of each frequency
  double injection_loss = 0;           // of power, from the squeezer to the signal-recycling mirror
  std::optional<Squeezer> squeezer{};  // instead of squeezing; angle 0: the quadrature of DARM when the SRM is tuned
  double pendulum_frequency = 0;       // Hz; 0: free masses
};

struct Modulation {
  double hz = 0, index = 0;  // rad
  ModulatorParameters::Of of = ModulatorParameters::Of::all;
};

class DualRecycled {
 public:
  // `changes`: of a scene, to the network of these parameters. Without mirror_mass nothing moves.
  explicit DualRecycled(DualRecycledParameters const&, std::vector<Modulation> const& = {}, NetworkChanges = {});
  DualRecycled(DualRecycled const&) = delete;
  DualRecycled& operator=(DualRecycled const&) = delete;

  DualRecycledParameters const& parameters() const { return p_; }
  Network const& network() const { return network_; }
  bool changed() const { return !changes_.empty(); }
  SteadyField const& field() const { return *field_; }
  Readout const& readout() const { return readout_; }
  double power_at(char const* component, std::uint32_t port) const;  // W that enters there
  double arm_power() const { return power_at("ETMx", 0); }

  LinearResponse response(double hz) const { return {network_, *field_, readout_, hz}; }
  LinearResponse response(Readout const& r, double hz) const { return {network_, *field_, r, hz}; }
  Phasor to_freedom(LinearResponse const&, Freedom) const;  // per m
  NamedFreedom freedom(Freedom) const;
  // The network with read-outs at its ports and the degrees of freedom DARM to SRCL.
  NetworkModel model(std::string preset) const;
  Injection injection(InjectionPoint) const;
  std::vector<NamedWay> entrances() const;  // all that have a name
  // The field s at this place that an injection of 1 represents: light that passed the end mirror twice has
  // s = T_E s_bench (eq. 9.3), and is injected behind that mirror.
  double share_outside(InjectionPoint) const;
  // Reference field of a stray field at this place, over that in arm x. Without light there: rounding.
  double reference(InjectionPoint) const;
  // Another read-out of DARM than that of the parameters.
  void read(Readout const& r) { readout_ = r; }
  bool sees_darm(double hz) const;  // in its read-out; otherwise the response there is rounding
  // Power fluctuation in the arms by stray light s in an arm, (dPx - dPy)/P, over 2 Re s; eq. 8.6, without radiation
  // pressure.
  Phasor stray_gain(double hz) const;
  double pole() const;  // Hz where the response to DARM without radiation pressure is 1/sqrt(2) of its largest
  // One-sided ASD of the strain, 1/sqrt(Hz), from the vacuum at all open ports and losses, squeezed as stated.
  double quantum_noise(double hz) const;

 private:
  void build();
  void build_arms(ComponentId splitter);
  // Quadratures of DARM at low frequency, with a tuned signal-recycling mirror and mirrors that do not move, rad.
  struct Quadratures {
    double read = 0, squeezed = 0;  // of the local oscillator; of the vacuum that comes in by the dark port
  };
  Quadratures quadratures() const;
  std::unique_ptr<DualRecycled> without_radiation_pressure() const;

  DualRecycledParameters p_;
  std::vector<Modulation> modulations_;
  NetworkChanges changes_;
  Network network_;
  std::unique_ptr<SteadyField> field_;
  Quadratures signal_;
  Readout readout_;
};

// Names of presets and their numbers (docs/theory/sensitivity.md; the reference page has a source for each).
struct DualRecycledPreset {
  std::string_view name, detector;
  DualRecycledParameters parameters;
};
std::span<DualRecycledPreset const> dual_recycled_presets();

// Stray light to strain by the network of a dual-recycled interferometer (docs/theory/interferometer.md).

class RecycledInterferometer final : public Interferometer {
 public:
  struct Servos {  // open-loop gains, for the input bench (eq. 9.7)
    TransferFunction frequency, intensity;
  };
  RecycledInterferometer(std::string name, std::unique_ptr<DualRecycled> model, std::vector<PortEntry> ports,
                         Servos servos, Band const& band = {}, std::optional<NetworkModel> asked = {},
                         std::string readout = {})
      : name_(std::move(name)),
        model_(std::move(model)),
        asked_(asked ? *std::move(asked) : model_->model(name_)),
        ports_(std::move(ports)),
        servos_(std::move(servos)),
        band_(band),
        readout_(std::move(readout)) {}

  std::complex<double> strain_per_phase(PortId, double hz) const override;
  std::complex<double> strain_per_amplitude(PortId, double hz) const override;
  std::optional<std::complex<double>> strain_per_passing_amplitude(PortId, double hz) const override;
  double copies(PortId port) const override { return ports_.at(port.value).copies; }
  DetectorNumbers numbers() const override;
  std::string description() const override;
  DualRecycled const& model() const { return *model_; }
  NetworkModel const* network() const override { return &asked_; }
  // Strain per relative field in the larger of both quadratures, without attenuation by the port and servos.
  double largest_response(PortId, double hz) const;

 private:
  struct Answer {
    std::array<std::complex<double>, entrance_names.size()> phase, amplitude;  // strain per relative field
    std::vector<StrayResponse> by_port;                                        // of those that name beams
    std::vector<std::complex<double>> passing;                                 // by port, strain per Re s
  };
  Answer const& answer(double hz) const;
  Answer solved(double hz) const;
  std::complex<double> phase(PortId, double hz) const;  // strain per relative field
  std::complex<double> amplitude(PortId, double hz) const;

  std::string name_;
  std::unique_ptr<DualRecycled> model_;
  NetworkModel asked_;
  std::vector<PortEntry> ports_;
  Servos servos_;
  Band band_;            // for the description
  std::string readout_;  // of DARM, by name; empty: that of the parameters
  mutable std::mutex mutex_;
  mutable std::map<double, Answer> answers_;  // by frequency: one solution serves every port
};

// The network of a preset alone: nothing of ports, loops and responses is read.
std::optional<NetworkModel> read_preset_network(Node const& table, DualRecycledPreset const&, double wavelength,
                                                std::vector<DrawnOptic> const& optics);
std::unique_ptr<Interferometer> read_recycled_interferometer(Node const& table, DualRecycledPreset const&,
                                                             std::vector<TracedPort> const& ports, double wavelength,
                                                             Band const&, std::vector<DrawnOptic> const& optics);

}  // namespace straytrace::ifo
