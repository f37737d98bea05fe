// SPDX-License-Identifier: BSD-3-Clause
// The parameters of a BSDF model in the scene language. A model declares
//   static ModelKeys<Model> keys();        defined in its .cpp
//   ModelComplaint impossible() const;     where the ranges of the keys do not suffice
// One that needs more than numbers (files, lists, several models) has a reader in world/build/read_laws.cpp.
#pragma once

#include <span>

#include "base/input/table.hpp"
#include "optics/lobes/bsdf.hpp"

namespace straytrace::optics {

constexpr double optional = infinity;  // as a default: the member keeps its value where the key is not written

template <class Model>
struct ModelKey {
  std::string_view name;
  double Model::*member;
  Dimension dimension;
  double fallback, low, high;  // SI; fallback `required`: no default
  std::string_view doc;
  double Model::*like = nullptr;  // its value, read before, is the default
};

// Two keys for one member, of which a scene has one: a coefficient, or the total at normal incidence.
template <class Model>
struct EitherKey {
  struct One {
    std::string_view name;
    Dimension dimension;
    double low, high;
    std::string_view doc;
    double (*value)(Model const&, double given) = nullptr;  // of the member, all other keys read; null: as given
  };
  double Model::*member = nullptr;
  One first, second;  // without either of them, the second is reported as missing
};

template <class Model>
struct ModelKeys {
  std::span<ModelKey<Model> const> numbers;
  EitherKey<Model> either{};  // no member: none
};

}  // namespace straytrace::optics
