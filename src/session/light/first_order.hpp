// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "session/options.hpp"
#include "trace/coupling.hpp"

namespace straytrace::session {

struct FirstOrderOptions : SceneOptions {
  std::optional<std::uint64_t> histories;
  std::string by;  // "port", "receiver"; empty: both
  bool csv = false;
  std::size_t show = 0;  // rows; 0: as in the scene
};

// straytrace paths FILE --first-order: illuminated objects, critical objects, and both. Returns the exit code.
int print_first_order(FirstOrderOptions const&);

// Of an entry of these lists, whose histories are batches: with fewer the spread does not give the error.
constexpr std::uint64_t least_batches = 4;
inline bool resolved(Estimate const& e) { return e.scored >= least_batches; }

}  // namespace straytrace::session
