// SPDX-License-Identifier: BSD-3-Clause
// Interferometers of any topology, in plane waves or in Hermite-Gauss modes: components that scatter, spaces between
// their ports (docs/theory/conventions.md and docs/theory/interferometer.md). Fields are in sqrt(W), proportional to
// exp(i(kr - wt)); phase grows along the way. A lossless interface reflects i r and transmits t on both sides.
#pragma once

#include <Eigen/Core>

#include <array>
#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/math/constants.hpp"

namespace straytrace::ifo {
using Phasor = std::complex<double>;

struct ComponentId {
  std::uint32_t value = 0;
};
// Where light enters and leaves a component. Mirrors: 0 front, 1 back. Splitters: 0 and 1 front, 2 and 3 back; light
// that enters at 0 is reflected to 1 and transmitted to 2, light that enters at 3 is reflected to 2 and transmitted to
// 1. Isolators and modulators: 0 in, 1 out. Lasers and dumps: 0.
struct NetworkPort {
  ComponentId component;
  std::uint32_t number = 0;
};

// Mechanical response of a component: free above its resonance.
struct Suspension {
  double mass = infinity;              // kg
  double resonance = 0;                // Hz
  double loss = 0;                     // loss angle of the pendulum
  Phasor compliance(double hz) const;  // m/N, for motion proportional to exp(-2 pi i f t)
};

struct MirrorParameters {
  double transmission = 0, loss = 0;  // of power
  // m, along the light that comes in at the front; of a splitter: along its normal. The front path becomes longer.
  double displacement = 0;
  double incidence = 0;  // rad, of a splitter
  Suspension suspension{};
  // Without effect on plane waves. 1/RoC, 1/m: positive when concave seen from the front.
  double curvature = 0;
  std::optional<double> curvature_across{};  // across the plane of incidence, where it is another one
  // rad, about y and about x: the light that the front reflects turns by twice as much along x and y of its own frame.
  // The plane of incidence is that of x.
  std::array<double, 2> tilt{};
  std::string origin{};  // of curvature and incidence, where they are not stated: "optic ITM, body itm"
};
// Fundamental mode at the port of a laser, in both axes.
struct LaserMode {
  double radius = 0, curvature = 0;  // m; 1/RoC of the wavefront in 1/m, positive when it diverges
};
struct LaserParameters {
  double power = 0, phase = 0;  // W, rad
  std::optional<LaserMode> mode{};
};
struct IsolatorParameters {
  double isolation = 0, transmission = 1;  // of power, from 1 to 0 (eq. 9.6) and from 0 to 1
};
struct LensParameters {
  double focal_length = infinity;  // m, positive when it focuses; without effect on plane waves
};
// Open inside; without effect on plane waves.
struct ApertureParameters {
  double radius = infinity;        // m
  std::array<double, 2> offset{};  // of its centre from the axis, along x and y of the light that enters at 0, m
};
struct DumpParameters {};
struct ModulatorParameters {
  enum class Kind : std::uint8_t { phase, amplitude };
  // all: light of every frequency gets sidebands. carrier: only frequencies 0 and s hz up to the order get light from
  // each other; light of any other is attenuated.
  enum class Of : std::uint8_t { all, carrier };
  double index = 0, hz = 0;
  int order = 1;
  Kind kind = Kind::phase;
  Of of = Of::all;
  double phase = 0;  // rad, of the drive: cos(2 pi hz t + phase)
};
enum class LinearPolarisation : std::uint8_t { s, p };  // p: every reflection changes its sign (eq. N.10)

// Hermite-Gauss modes instead of plane waves.
struct ModeSettings {
  int order = 0;      // largest n + m
  bool even = false;  // modes of even n and even m alone
  // Cavities whose eigenmodes are the bases, each by names of components on it, the first the most important. None: all
  // of them, the highest finesse first.
  std::vector<std::vector<std::string>> cavities{};
};

class Network {
 public:
  explicit Network(double wavelength, LinearPolarisation polarisation = LinearPolarisation::s)  // m, in vacuum
      : wavelength_(wavelength), polarisation_(polarisation) {}

  // For the solvers. Ports are numbered through all components.
  struct Component {
    enum class Kind : std::uint8_t { mirror, splitter, laser, dump, isolator, modulator, lens, aperture };
    std::string name;
    Kind kind = Kind::dump;
    std::variant<DumpParameters, MirrorParameters, LaserParameters, IsolatorParameters, ModulatorParameters,
                 LensParameters, ApertureParameters>
        stated{};
    std::uint32_t first_port = 0, ports = 0;
    Eigen::MatrixXcd scattering;  // out = scattering x in, at rest, of s polarisation
    Eigen::MatrixXd path;         // how much longer each way becomes with the displacement: 2 cos, -2 cos or 0
    std::vector<double> push;     // by port: +-cos; force = sum of push (P_in + P_out)/c along the displacement
    double displacement = 0;      // m
    Suspension suspension;
    Phasor emits = 0;            // sqrt(W), at the carrier
    double modulation = 0;       // Hz; 0: none
    std::vector<Phasor> bands;   // of a modulator: bands[s + order] of band s
    bool carrier_alone = false;  // ModulatorParameters::Of::carrier
    bool moves() const { return suspension.mass < infinity; }
    bool interface() const { return kind == Kind::mirror || kind == Kind::splitter; }
    bool reflects(std::uint32_t out, std::uint32_t in) const;
    std::string port_name(std::uint32_t number) const;  // "PRM.front", "BS.1", "laser"
  };
  static Component mirror(std::string name, MirrorParameters const&);
  static Component splitter(std::string name, MirrorParameters const&);
  static Component laser(std::string name, LaserParameters const&);
  static Component dump(std::string name);
  static Component isolator(std::string name, IsolatorParameters const&);
  // Of phase, exp(i index cos(2 pi hz t + phase)): bands 0, +-1 ... +-order. Of amplitude,
  // 1 - index (1 - cos(2 pi hz t + phase))/2.
  static Component modulator(std::string name, ModulatorParameters const&);
  static Component lens(std::string name, LensParameters const&);
  static Component aperture(std::string name, ApertureParameters const&);

  ComponentId add(Component);
  // Another component with as many ports takes the place of one.
  void replace(ComponentId, Component);
  ComponentId add_mirror(std::string name, MirrorParameters const& p) { return add(mirror(std::move(name), p)); }
  ComponentId add_splitter(std::string name, MirrorParameters const& p) { return add(splitter(std::move(name), p)); }
  ComponentId add_laser(std::string name, double power, double phase = 0) {
    return add(laser(std::move(name), {power, phase}));
  }
  ComponentId add_dump(std::string name) { return add(dump(std::move(name))); }
  ComponentId add_isolator(std::string name, double isolation, double transmission = 1) {
    return add(Network::isolator(std::move(name), {isolation, transmission}));
  }
  ComponentId add_modulator(std::string name, double index, double hz, int order = 1) {
    return add(modulator(std::move(name), {.index = index, .hz = hz, .order = order}));
  }
  // Space between two free ports: optical length in m, a whole number of wavelengths, and a phase beyond it in rad.
  void link(NetworkPort, NetworkPort, double length, double phase = 0, std::string origin = {});
  void unlink(std::uint32_t port);  // removes the space at this port, where there is one
  void change(std::size_t space, double length, double phase);
  void move(ComponentId, double displacement);  // m, sets MirrorParameters::displacement
  // Curvature and tilt of a mirror or splitter; what is not given stays.
  void shape(ComponentId, std::optional<double> curvature, std::optional<std::array<double, 2>> tilt,
             std::optional<double> curvature_across = {}, std::string const& origin = {});
  void hold();                                      // nothing yields to forces
  ComponentId find(std::string const& name) const;  // throws std::out_of_range
  std::optional<ComponentId> search(std::string const& name) const;
  std::string const& name(ComponentId id) const { return at(id).name; }

  void use_modes(std::optional<ModeSettings> settings) { modes_ = std::move(settings); }
  std::optional<ModeSettings> const& modes() const { return modes_; }

  double wavelength() const { return wavelength_; }
  LinearPolarisation polarisation() const { return polarisation_; }
  double wavenumber() const { return 2 * pi / wavelength_; }
  double wavenumber(double hz) const { return wavenumber() + 2 * pi * hz / speed_of_light; }  // hz from the laser

  struct Space {
    std::uint32_t from = 0, to = 0;
    double length = 0, phase = 0;
    std::string origin{};  // of the length, where it is not stated
  };
  std::vector<Component> const& components() const { return components_; }
  Component const& at(ComponentId id) const { return components_.at(id.value); }
  std::vector<Space> const& spaces() const { return spaces_; }
  std::uint32_t ports() const { return ports_; }
  std::uint32_t number_of(NetworkPort) const;
  ComponentId owner_of(std::uint32_t port) const;
  std::string port_name(std::uint32_t port) const;
  std::string space_name(std::size_t space) const;  // "PRM.back>BS.1"
  // The scattering matrix at the place of the component for light at `hz` from the laser (eq. N.1, N.10).
  Eigen::MatrixXcd scattering(Component const&, double hz) const;
  // Carriers that the modulators make, Hz from the laser, ascending; 0 is always among them.
  std::vector<double> carriers() const;

 private:
  double wavelength_;
  LinearPolarisation polarisation_;
  std::uint32_t ports_ = 0;
  std::vector<Component> components_;
  std::vector<Space> spaces_;
  std::optional<ModeSettings> modes_;
};

class ModeBases;     // ifo/mode_bases.hpp
class SparseSolver;  // ifo/network_ways.hpp

// The steady light in a network.
class SteadyField {
 public:
  // NumericalError without a unique solution, or without modes where the network uses them.
  explicit SteadyField(Network const&);
  std::vector<double> const& carriers() const { return carriers_; }  // Hz from the laser
  // sqrt(W): light that enters, leaves the component at this port; carrier and mode by number.
  Phasor in(std::uint32_t port, std::size_t carrier, std::size_t mode = 0) const {
    return in_[carrier][Eigen::Index(port * modes_ + mode)];
  }
  Phasor out(std::uint32_t port, std::size_t carrier, std::size_t mode = 0) const {
    return out_[carrier][Eigen::Index(port * modes_ + mode)];
  }
  double power_in(std::uint32_t port) const;  // W, all carriers and modes
  double power_out(std::uint32_t port) const;
  std::size_t carrier(double hz) const;                    // number of this one; throws std::out_of_range
  std::size_t modes() const { return modes_; }             // 1 for plane waves
  ModeBases const* bases() const { return bases_.get(); }  // null for plane waves

 private:
  std::vector<double> carriers_;
  std::size_t modes_ = 1;
  std::shared_ptr<ModeBases const> bases_;
  std::vector<Eigen::VectorXcd> in_, out_;  // by carrier; all modes of port 0 first
};

// Response of a read-out of an interferometer to small motion, stray light, forces and the vacuum, at one Fourier
// frequency (docs/theory/arm.md and docs/theory/interferometer.md). Each carrier has two sidebands; light pushes
// mirrors and moving mirrors change light, so radiation pressure, optical springs and recycling are included.
// Quantities go as Re(X exp(-2 pi i f t)).

// Squeezed vacuum before and after filter cavities, at one Fourier frequency.

// Of the two quadratures of a field, in units of the vacuum.
using QuadratureCovariance = Eigen::Matrix2cd;

QuadratureCovariance squeezed_vacuum(double least, double most, double angle = 0);  // noise powers; rad

struct FilterCavity {
  double length = not_a_number, detuning = not_a_number;                                           // m, Hz
  double input_transmission = not_a_number, end_transmission = not_a_number, loss = not_a_number;  // loss: round trip
  double rotation = 0;                                                                             // rad, after it
};

struct Squeezer {
  double decibels = 0, anti_decibels = not_a_number;  // NaN: as much as squeezing
  double angle = 0, loss = 0, phase_noise = 0;        // rad, power, rad rms
  std::vector<FilterCavity> cavities{};               // in the order the light meets them

  QuadratureCovariance covariance(double hz) const;  // after loss and cavities; the angle fluctuates by phase_noise
};

// A read-out of the light that enters a port, or that leaves it.
struct Readout {
  static Readout power(std::uint32_t port) { return {port, Kind::power, 0, 0}; }  // W
  // Beat with a strong local oscillator of phase `angle` (rad), sqrt(W): e^{-i angle} a + e^{i angle} b. Its mode is
  // the fundamental one of the beam.
  static Readout homodyne(std::uint32_t port, double angle) { return {port, Kind::homodyne, angle, 0}; }
  // Power demodulated at `hz` with cos(2 pi hz t + phase) and averaged, W (eq. 6.10, N.2).
  static Readout demodulated(std::uint32_t port, double hz, double phase) {
    return {port, Kind::demodulated, phase, hz};
  }
  // Sum of displacements of components, m, each with a factor.
  static Readout motion(std::vector<std::pair<ComponentId, double>> of) {
    return {0, Kind::motion, 0, 0, std::move(of)};
  }
  Readout of_leaving() const {
    Readout r = *this;
    r.leaving = true;
    return r;
  }
  enum class Kind : std::uint8_t { power, homodyne, demodulated, motion };
  std::uint32_t port = 0;
  Kind kind = Kind::power;
  double angle = 0, hz = 0;
  std::vector<std::pair<ComponentId, double>> moving{};
  bool leaving = false;
};

// Steady value of a read-out: W, sqrt(W) of a homodyne one; 0 m of motion.
double value_of(Readout const&, SteadyField const&);

// Slope of the steady value of a power, demodulated or not, with respect to any number of the network, from one adjoint
// solution (eq. N.3). Infinite or not a number where the slope does not exist: of a transmission 0.
class AdjointSlope {
 public:
  AdjointSlope(Network const&, SteadyField const&, Readout const&);

  double to_displacement(ComponentId) const;  // per m
  double to_transmission(
      ComponentId) const;              // per 1, of a mirror or splitter; the loss stays, the reflectivity changes
  double to_loss(ComponentId) const;   // per 1; the transmission stays
  double to_power(ComponentId) const;  // per W of a laser
  double to_length(std::size_t space) const;  // per m
  double to_phase(std::size_t space) const;   // per rad

 private:
  double along_ways(ComponentId, Eigen::MatrixXd const& relative, Eigen::MatrixXd const& path) const;
  double along_space(std::size_t space, bool of_length) const;
  // Conjugate of lambda at what leaves.
  Phasor weighted(std::uint32_t port, std::size_t carrier, std::size_t mode) const;

  Network const& network_;
  SteadyField const& field_;
  Readout readout_;
  Eigen::VectorXcd lambda_;  // of every leaving field
};

// Squeezed vacuum instead of the vacuum that leaves a dump (or laser) at this port of it, about carrier 0. Its first
// quadrature is the one at `angle`, rad.
struct Squeezing {
  std::uint32_t port = 0;
  QuadratureCovariance covariance = QuadratureCovariance::Identity();
  double angle = 0;
};

// Stray light that joins what enters or what leaves a port, as a share of what enters or leaves it; `turn`: phase, rad,
// on the way back.
struct Injection {
  std::uint32_t port = 0;
  bool joins_leaving = false, of_leaving = false;
  double turn = 0;
};

// The equations of small signals at one frequency, factored: shared by all read-outs.
class SmallSignals {
 public:
  SmallSignals(Network const&, SteadyField const&, double hz);
  Eigen::VectorXcd weights(Readout const&) const;  // of every equation in the read-out
  Network const& network() const { return network_; }
  SteadyField const& field() const { return field_; }

 private:
  class Equations;
  Network const& network_;
  SteadyField const& field_;
  std::shared_ptr<Equations const> equations_;
  std::shared_ptr<SparseSolver const> solver_;
};

class LinearResponse {
 public:
  // One solution gives the response to every cause.
  LinearResponse(Network const& n, SteadyField const& f, Readout const& r, double hz)
      : LinearResponse(SmallSignals(n, f, hz), r) {}
  LinearResponse(SmallSignals const& s, Readout const& r)
      : network_(s.network()), field_(s.field()), weight_(s.weights(r)) {}

  Phasor to_displacement(ComponentId) const;  // per m that an actuator or the ground adds
  // Stray field s (docs/theory/interferometer.md), of the light entering this port of a component by default: s = i
  // e for phase, s = e for amplitude. It applies to all carriers equally.
  Phasor to_phase(std::uint32_t port) const { return to_phase(Injection{port}); }
  Phasor to_amplitude(std::uint32_t port) const { return to_amplitude(Injection{port}); }
  Phasor to_phase(Injection const&) const;
  Phasor to_amplitude(Injection const&) const;
  // Read-out per sqrt(W) of a sideband that joins what enters or what leaves a port: the upper one of a carrier (side
  // 0), or the lower one, conjugated (side 1).
  Phasor weight(std::uint32_t port, bool leaving, int side, std::size_t carrier, std::size_t mode = 0) const;
  // Angle of the quadrature leaving a dump (or laser) with the largest effect on the read-out: the one to squeeze.
  double seen_quadrature(std::uint32_t port) const;
  // One-sided PSD of the read-out from the vacuum that enters at losses and open ports, squared units per Hz.
  double quantum_noise(std::span<Squeezing const> = {}) const;
  // One-sided cross spectrum with another read-out at the same frequency from that vacuum, <this other*>.
  Phasor vacuum_correlation(LinearResponse const& other) const;
  // Becomes the response of this read-out plus `factor` times the other.
  void add(Phasor factor, LinearResponse const& other) { weight_ += factor * other.weight_; }

 private:
  template <class Port, class Loss>
  void each_vacuum(Port const& port, Loss const& loss) const;
  Phasor injected(Injection const&, Phasor upper, Phasor lower) const;
  Phasor of_leaving(std::uint32_t port, int side) const;  // weight around carrier 0

  Network const& network_;
  SteadyField const& field_;
  Eigen::VectorXcd weight_;  // of every equation in the read-out
};

}  // namespace straytrace::ifo
