// SPDX-License-Identifier: BSD-3-Clause
// Surface known by its shares of power against the angle of incidence: reflected and transmitted, for s and p, and
// scattered; the rest is absorbed. Phases are those of the unitary interface (docs/theory/conventions.md).
// Page: docs/reference/interfaces/coating.md.
#pragma once

#include "optics/amplitudes.hpp"
#include "optics/coating/angle_table.hpp"

namespace straytrace {

struct Coating {
  enum Column { reflect_s, reflect_p, transmit_s, transmit_p, scatter, absorb_s, absorb_p, columns };
  AngleTable<columns> table;
  bool scatters = false;  // the table says what is scattered; otherwise the laws of the material do

  static constexpr char const* key = "coating";
  static constexpr bool yields_to_scatter = false;

  // The angle is the one the light comes at: beyond the critical angle nothing passes, and what the table transmits is
  // reflected instead.
  STRAY_HD Amplitudes amplitudes(double cos_i, double n_in, double n_out, bool /*front*/) const {
    AngleColumns<columns> const c = table.at(cos_i);
    double share[4];
    for (int i = 0; i < 4; ++i) share[i] = std::fmax(0.0, c.value[i]);
    if (n_in * n_in * (1 - cos_i * cos_i) >= n_out * n_out && n_in > n_out)
      for (int i = 0; i < 2; ++i) {
        share[i] += share[i + 2];
        share[i + 2] = 0;
      }
    return unitary_amplitudes(share[reflect_s], share[reflect_p], share[transmit_s], share[transmit_p]);
  }
  STRAY_HD double scattered(double cos_i) const {
    return scatters ? std::fmax(0.0, table.at(cos_i).value[scatter]) : -1;
  }
  template <class F>
  void numbers(F&& f) const {
    for (std::size_t k = 0; k < table.knots.size; ++k) {
      f(table.knots[k].cosine);
      for (double x : table.knots[k].value) f(x);
    }
    f(double(scatters));
  }
};

}  // namespace straytrace
