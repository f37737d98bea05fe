// SPDX-License-Identifier: BSD-3-Clause
// The arm of case A14 as a network, and strain per relative stray field.
#pragma once

#include <cmath>
#include <utility>

#include "base/every_module.hpp"
#include "ifo/control_loops.hpp"
#include "ifo/dual_recycled.hpp"
#include "ifo/fabry_perot_michelson.hpp"

namespace straytrace {

// A14: AdV's arm with end mirrors as built, nothing recycled, nothing moved by light.
inline DualRecycledParameters case_a14() {
  DualRecycledParameters p;
  p.arm_length = 3000;
  p.input_transmission = 0.014;
  p.end_transmission = 4.4e-6;
  p.round_trip_loss = 75e-6;
  p.input_power = 1000;
  return p;
}
inline ArmCavity arm_of(DualRecycledParameters const& p) {
  return {p.arm_length, p.input_transmission, p.end_transmission, p.round_trip_loss};
}
struct Strain {
  Phasor phase, amplitude;
  double both() const { return std::sqrt(std::norm(phase) + std::norm(amplitude)); }
};
inline Strain strain(DualRecycled const& d, Injection const& i, double hz) {
  LinearResponse const r = d.response(hz);
  Phasor const darm = d.to_freedom(r, Freedom::darm) * d.parameters().arm_length;
  return {r.to_phase(i) / darm, r.to_amplitude(i) / darm};
}
inline Strain strain(DualRecycled const& d, InjectionPoint e, double hz) { return strain(d, d.injection(e), hz); }

// The read-out of DARM, by default with CARM, MICH, PRCL and SRCL held.
class HeldResponse {
 public:
  explicit HeldResponse(DualRecycled const& d, double hz, NetworkModel model)
      : d_(d), model_(std::move(model)), response_(model_, d.field(), hz) {}
  HeldResponse(DualRecycled const& d, double hz) : HeldResponse(d, hz, d.model("")) {}
  HeldResponse(HeldResponse const&) = delete;
  CalibratedStrain const& strain() const { return response_; }
  Phasor to_freedom(Freedom f) const {
    return response_.to([&](LinearResponse const& r) { return d_.to_freedom(r, f); });
  }
  Phasor to_phase(Injection const& i) const {
    return response_.to([&](LinearResponse const& r) { return r.to_phase(i); });
  }
  Phasor to_amplitude(Injection const& i) const {
    return response_.to([&](LinearResponse const& r) { return r.to_amplitude(i); });
  }
  StrayResponse to_stray(StrayWay const& way) const { return response_.to_stray(way); }

 private:
  DualRecycled const& d_;
  NetworkModel model_;
  CalibratedStrain response_;
};

}  // namespace straytrace
