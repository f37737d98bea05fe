// SPDX-License-Identifier: BSD-3-Clause
// Interferometers of any topology in plane waves: components that scatter, spaces between their ports
// (docs/theory/conventions.md and docs/theory/interferometer.md). Fields are in sqrt(W), proportional to exp(i(kr -
// wt)); phase grows along the way. A lossless interface reflects i r and transmits t on both sides.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseLU>

#include <cmath>
#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"

namespace straytrace {

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

// How a component answers a force: free above its resonance.
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
};

class Network {
 public:
  explicit Network(double wavelength) : wavelength_(wavelength) {}  // m, in vacuum

  ComponentId add_mirror(std::string name, MirrorParameters const&);
  ComponentId add_splitter(std::string name, MirrorParameters const&);
  ComponentId add_laser(std::string name, double power, double phase = 0);  // W, rad
  ComponentId add_dump(std::string name);
  // Faraday isolator: power transmission from 1 to 0 (eq. 9.6) and from 0 to 1.
  ComponentId add_isolator(std::string name, double isolation, double transmission = 1);
  // Phase modulator: index in rad, frequency in Hz, bands +-1 ... +-order.
  ComponentId add_modulator(std::string name, double index, double hz, int order = 1);
  // Space between two free ports: optical length in m, a whole number of wavelengths, and a phase beyond it in rad.
  void link(NetworkPort, NetworkPort, double length, double phase = 0);
  void move(ComponentId, double displacement);      // m, sets MirrorParameters::displacement
  void retune(NetworkPort, double phase);           // of the space at this port
  ComponentId find(std::string const& name) const;  // throws std::out_of_range
  std::string const& name(ComponentId id) const { return at(id).name; }

  double wavelength() const { return wavelength_; }
  double wavenumber() const { return 2 * pi / wavelength_; }

  // For the solvers. Ports are numbered through all components.
  struct Component {
    std::string name;
    std::uint32_t first_port = 0, ports = 0;
    Eigen::MatrixXcd scattering;  // out = scattering x in, at rest
    Eigen::MatrixXd path;         // how much longer each way becomes with the displacement: 2 cos, -2 cos or 0
    std::vector<double> push;     // by port: +-cos; force = sum of push (P_in + P_out)/c along the displacement
    double displacement = 0;      // m
    Suspension suspension;
    Phasor emits = 0;           // sqrt(W), at the carrier
    double modulation = 0;      // Hz; 0: none
    std::vector<Phasor> bands;  // of a modulator: bands[s + order] of band s
    bool moves() const { return suspension.mass < infinity; }
    // The scattering matrix where the component stands.
    Eigen::MatrixXcd scattering_at_place(double wavenumber) const;
  };
  struct Space {
    std::uint32_t from = 0, to = 0;
    double length = 0, phase = 0;
  };
  std::vector<Component> const& components() const { return components_; }
  std::vector<Space> const& spaces() const { return spaces_; }
  std::uint32_t ports() const { return ports_; }
  std::uint32_t number_of(NetworkPort) const;
  // Carriers that the modulators make, Hz from the laser, ascending; 0 is always among them.
  std::vector<double> carriers() const;

 private:
  Component const& at(ComponentId id) const { return components_.at(id.value); }
  ComponentId add(Component);
  ComponentId add_interface(std::string name, MirrorParameters const&, bool splitter);

  double wavelength_;
  std::uint32_t ports_ = 0;
  std::vector<Component> components_;
  std::vector<Space> spaces_;
};

// The light that stands in a network.
class SteadyField {
 public:
  explicit SteadyField(Network const&);                              // NumericalError when there is no single answer
  std::vector<double> const& carriers() const { return carriers_; }  // Hz from the laser
  // sqrt(W): light that enters, leaves the component at this port; carrier by number.
  Phasor in(std::uint32_t port, std::size_t carrier) const { return in_[carrier][Eigen::Index(port)]; }
  Phasor out(std::uint32_t port, std::size_t carrier) const { return out_[carrier][Eigen::Index(port)]; }
  double power_in(std::uint32_t port) const;  // W, all carriers
  double power_out(std::uint32_t port) const;
  std::size_t carrier(double hz) const;  // number of this one; throws std::out_of_range

 private:
  std::vector<double> carriers_;
  std::vector<Eigen::VectorXcd> in_, out_;
};

}  // namespace straytrace

// What the solvers of a network share: every way of light through components and spaces, and sparse linear systems.
namespace straytrace::network_detail {

inline Phasor const i_unit{0, 1};

// Number of the carrier at this frequency, when it is one that is kept.
inline std::optional<std::size_t> carrier_at(std::span<double const> carriers, double hz) {
  for (std::size_t n = 0; n < carriers.size(); ++n)
    if (std::fabs(carriers[n] - hz) < 1e-3) return n;
  return {};
}

// Calls way(out, in, m, n, amplitude) for every way through the component, from carrier n at port `in` of it to carrier
// m at port `out`.
template <class Way>
void for_each_way(Network::Component const& c, Eigen::MatrixXcd const& scattering, std::vector<double> const& carriers,
                  Way const& way) {
  int const order = int(c.bands.size()) / 2;
  for (std::uint32_t out = 0; out < c.ports; ++out)
    for (std::uint32_t in = 0; in < c.ports; ++in) {
      Phasor const amplitude = scattering(out, in);
      if (amplitude == 0.0) continue;
      for (std::size_t n = 0; n < carriers.size(); ++n) {
        if (c.bands.empty()) {
          way(out, in, n, n, amplitude);
          continue;
        }
        for (int s = -order; s <= order; ++s)
          if (auto const m = carrier_at(carriers, carriers[n] + s * c.modulation))
            way(out, in, *m, n, amplitude * c.bands[std::size_t(s + order)]);
      }
    }
}

// Phase along a space, rad, of light at `hz` from the laser.
inline double phase_along(Network::Space const& s, double hz) {
  return s.phase + 2 * pi * hz * s.length / speed_of_light;
}

using Sparse = Eigen::SparseMatrix<Phasor>;
using Entries = std::vector<Eigen::Triplet<Phasor>>;

// Solves for one right-hand side; checks the residual (a backward error).
inline Eigen::VectorXcd solved(Sparse const& matrix, Eigen::VectorXcd const& right, char const* what) {
  Eigen::SparseLU<Sparse> solver;
  solver.compute(matrix);
  Eigen::VectorXcd x;
  if (solver.info() == Eigen::Success) x = solver.solve(right);
  bool const good = solver.info() == Eigen::Success && x.allFinite() &&
                    (matrix * x - right).norm() <= 1e-12 * (matrix.norm() * x.norm() + right.norm());
  if (!good) throw NumericalError(std::string("the network has no single answer for ") + what);
  return x;
}

}  // namespace straytrace::network_detail
