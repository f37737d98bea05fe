// SPDX-License-Identifier: BSD-3-Clause
// Optical properties of one side of a surface: a specular interface plus a sum of BSDF models. The rest of the light,
// which is neither reflected nor transmitted nor scattered, is absorbed.
#pragma once

#include "base/memory/storage.hpp"
#include "optics/lobes/bsdf.hpp"

namespace straytrace::optics {

// Weight of one model in a sum, against the angle: the model is multiplied by sqrt(w(theta_i) w(theta_s)), which keeps
// it reciprocal (docs/theory/surfaces.md, eq. 3.2) for any w. Page: docs/reference/scatter/mixtures.md.
struct AngleWeight {
  AlbedoTable root;    // sqrt(w) against the cosine
  AlbedoTable albedo;  // of the weighted model
  double most = 0;     // largest sqrt(w)
};

// A model with its weight, which is a model as well.
template <class Law>
struct Weighted {
  Law const& law;
  AngleWeight const* weight;  // null: 1

  STRAY_HD double albedo(double cos_i) const { return weight ? weight->albedo.at(cos_i) : law.albedo(cos_i); }
  STRAY_HD double albedo(Vec3 wi) const { return weight ? weight->albedo.at(wi.z) : albedo_from(law, wi); }
  STRAY_HD double weighted(double value, Vec3 wi, Vec3 wo) const {
    return weight && value > 0 ? value * weight->root.at(wi.z) * weight->root.at(wo.z) : value;
  }
  STRAY_HD double eval(Vec3 wi, Vec3 wo) const { return weighted(law.eval(wi, wo), wi, wo); }
  STRAY_HD ValueAndPdf both(Vec3 wi, Vec3 wo) const {
    ValueAndPdf const found = both_of(law, wi, wo);
    return {weighted(found.value, wi, wo), found.pdf};
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return law.pdf(wi, wo); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return law.sample(wi, u, v); }
};

// Direction of the local axes of a surface, for models with a direction on it. The axis is that of the shape.
enum class Lay : std::uint8_t { free, around, along, given };

struct Optic {
  static constexpr int most_laws = 8;
  double reflect = 0, transmit = 0;  // fixed coating: power, the same at every angle; unused with an interface
  bool has_interface = false;
  PoolRef interface;       // in SpecularTypes
  bool diffracts = false;  // the interface is a Grating
  double depolarise = 1;   // share of scattered light that loses its polarisation
  Lay lay = Lay::free;     // grooves (local y) run around the axis, along it, or along `lay_direction` of the scene
  Vec3 lay_direction;
  int laws = 0;
  PoolRef law[most_laws];                     // in LawTypes
  bool through[most_laws] = {};               // scatters to the other side (optics/scatter/mixture.hpp)
  View<AngleWeight const> weight[most_laws];  // none, or one
  // Light reflected within this angle of the specular direction is left to the field of a cavity (docs/theory/wave.md,
  // eq. W.20); `below`: its share of all light at normal incidence.
  double crossover = 0, below = 0;  // rad, 1
};

}  // namespace straytrace::optics
