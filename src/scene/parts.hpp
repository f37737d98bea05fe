// SPDX-License-Identifier: BSD-3-Clause
// The `parts` of a model: their structure and how many faces each of them unfolds to.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "scene/scene_document.hpp"
#include "scene/scope.hpp"

namespace straytrace {

constexpr std::size_t deepest_part = 8;

// Keys of an entry that a parameter of a part may not be called.
constexpr std::array<std::string_view, 14> entry_keys{"name",     "use",  "shape",  "file",    "repeat",
                                                      "split",    "at",   "facing", "rotate",  "body",
                                                      "material", "side", "medium", "surfaces"};
bool is_entry_key(std::string_view);

// False, with a problem, for a name that could not be used in paths like "bench/dump_3/front".
bool name_allowed(Node const& at, std::string const& name);

// Refuses parts without faces, unknown keys and bad names.
void check_parts(SceneDocument&, Node const& parts);

class FaceCounter {
 public:
  explicit FaceCounter(Node parts) : parts_(std::move(parts)) {}
  // Faces of the part that `use` names, with all parts inside it, at most `limit` + 1; 0 when it cannot be unfolded
  // because a part contains itself, which is reported here.
  std::size_t count(Node const& use, std::size_t limit);

 private:
  Node parts_;
  std::map<std::string, std::size_t> done_;
  std::vector<std::string> chain_;
};

// `limits` of a part: what its parameters must keep to, so that its faces fit together.

// False, with a problem at the value in `entry` (or at the entry, when it gives none), for the first parameter that is
// not `above`, `at_least` or `at_most` what the part says; `name` is that of the entry.
bool within_limits(Node const& entry, std::string const& name, Node const& part, std::shared_ptr<Scope const> const&);

}  // namespace straytrace
