// SPDX-License-Identifier: BSD-3-Clause
// What differs between two models as physics: values in SI with defaults, placed shapes, contents of data files. Order,
// comments, names of parameters and spelling of units make no difference.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/model_tree.hpp"

namespace straytrace {

struct Difference {
  std::string section;        // "materials", "scene", ...
  std::string name, key;      // "baffles/cone", "shape.cone.inner_radius"
  std::string before, after;  // empty: not there
  std::size_t instances = 1;  // of a repeated entry
  std::optional<Quantity> was{}, is{};
};

// By section, in the order of the language. Both scenes have been read by all rooms.
std::vector<Difference> differences(Scene const& before, Scene const& after);
// Parameters of the models that have other values, those of only one of them last; section "params".
std::vector<Difference> parameter_differences(Scene const& before, Scene const& after);
// For people: parameters first, then what differs; changes of one key by many instances in one line.
std::string difference_text(std::vector<Difference> const& parameters, std::vector<Difference> const&);

}  // namespace straytrace
