// SPDX-License-Identifier: BSD-3-Clause
// Response of h to a stray field (docs/theory/interferometer.md).
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input/table.hpp"
#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::ifo {
struct NetworkModel;  // ifo/network_model.hpp

// Where stray light joins the light of an interferometer again (docs/theory/interferometer.md).

// The relative field s of a path refers to the main light named here.
enum class InjectionPoint : std::uint8_t {
  arm,               // an arm, scattered at its input mirror; the light that leaves it into the arm (eq. 9.1, 9.2)
  end_mirror,        // an arm, scattered at its end mirror; the light that leaves it into the arm
  through_end,       // an end mirror from behind, passed twice in s already; the light that leaves it into the arm
  end_bench,         // an end mirror from behind; the light that leaves it there (eq. 9.3, 9.4)
  short_arm,         // between splitter and input mirror, on the way to the arm; what comes from it (N.17)
  recycling_cavity,  // between power-recycling mirror and splitter, on the way to the splitter; what comes from it
  signal_cavity,     // between splitter and signal-recycling mirror, on the way out; what the mirror returns
  as_port,           // the signal-recycling mirror from outside; the light that leaves it (eq. 9.6)
  symmetric_port,    // the power-recycling mirror from outside; the light that comes back from it
  input_bench        // the input beam; that light (eq. 9.7)
};
constexpr std::array<std::string_view, 10> entrance_names = {
    "arm",           "end-mirror", "through-end",    "end-bench",  "short-arm", "recycling-cavity",
    "signal-cavity", "as-port",    "symmetric-port", "input-bench"};
// The place is in one of two equal arms.
constexpr bool is_of_an_arm(InjectionPoint e) { return e <= InjectionPoint::short_arm; }
constexpr bool is_behind_the_end(InjectionPoint e) {
  return e == InjectionPoint::through_end || e == InjectionPoint::end_bench;
}
// Relative to the light that circulates in an arm.
constexpr bool is_inside_an_arm(InjectionPoint e) { return e <= InjectionPoint::through_end; }

// A port of the scene, as input of the interferometer.
struct TracedPort {
  std::string name;
  InjectionPoint injection_point = InjectionPoint::arm;  // where its light joins unless the table says otherwise
  double power = 0;                                      // W, of its beam; 0: not stated
  double cavity_length = 0;                              // m, between the mirrors of its beam; 0: no cavity
  // `lit` followed its light through a mirror of the cavity: the coupling holds the transmission already, twice.
  bool through_mirror = false;
  // Of a beam of the network: its name, "ITMx.front.out". Light that is scattered joins the beam of the opposite
  // direction, unless the table says otherwise; `along`: the beam itself.
  std::string light{};
  std::string lit_by{};  // the light that is scattered, where it is another beam of the network
  bool along = false;
  bool both_sides = false;  // of faces that return this light and that of the opposite direction (eq. N.20)
  // Geometric mean of the powers of that light and of the beam of the port, over the power that couplings refer to.
  double reference = 1;
};

// A mirror that the scene draws: a disk or a cap.
struct DrawnOptic {
  std::string name, body{};
  Vec3 vertex{}, axis{};  // m; unit, toward the centre of a positive curvature
  double curvature = 0;   // 1/m
};

// Numbers of the arms and of recycling that characterise a detector. NaN: not known.
struct DetectorNumbers {
  double arm_length = not_a_number, arm_power = not_a_number;  // m; W that circulate in one arm
  double mirror_mass = not_a_number;                           // kg, each mirror of the arm
  double finesse = not_a_number;                               // of an arm, eq. 6.5
  double gain = not_a_number;  // Gamma of the differential field in an arm with signal recycling, tuned: eq. 6.8
  double input_transmission = not_a_number, end_transmission = not_a_number;  // of an arm
};

class Interferometer {
 public:
  virtual ~Interferometer() = default;
  // Strain per unit relative field entering at a port, at frequency hz: the part in quadrature with the main field
  // (Im s, phase) and the part in phase (Re s, radiation pressure).
  virtual std::complex<double> strain_per_phase(PortId, double hz) const = 0;
  virtual std::complex<double> strain_per_amplitude(PortId, double hz) const = 0;
  // Strain per unit of Re s added to the main light itself as it passes this place, in both directions, where it is
  // known (docs/theory/diffraction.md, eq. N.21). Light that does not come back: 0.
  virtual std::optional<std::complex<double>> strain_per_passing_amplitude(PortId, double /*hz*/) const { return {}; }
  // Number of equal, independent copies of the traced port in the detector (two arms: 2). Powers add.
  virtual double copies(PortId) const = 0;
  virtual DetectorNumbers numbers() const { return {}; }
  virtual NetworkModel const* network() const { return nullptr; }  // none: closed forms
  virtual std::string description() const = 0;                     // one line for reports: formulas and numbers used
};

// Reads the table `interferometer`; `ports` in the order of PortId; wavelength in m, not a number: that of the preset.
// Where the table gives no power, the arms have that of the beams whose ports join there. Files of responses must cover
// the band. `optics`: those that mirrors of the network may name. Nothing without a preset and without `strain`: such a
// network does not say how light becomes strain.
std::unique_ptr<Interferometer> make_interferometer(Node const& table, std::vector<TracedPort> const& ports,
                                                    double wavelength, Band const& = {},
                                                    std::vector<DrawnOptic> const& optics = {});

}  // namespace straytrace::ifo
