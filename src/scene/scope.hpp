// SPDX-License-Identifier: BSD-3-Clause
// Parameters in force: those of the model, and those of a part inside them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/input/document.hpp"
#include "scene/expression.hpp"
#include "scene/scene_document.hpp"

namespace straytrace::scene {

class SceneDocument;

struct Scope {
  std::shared_ptr<Scope const> outer;
  std::map<std::string, std::optional<Value>, std::less<>> own;  // no value: its problem is recorded
  std::map<std::string, std::string, std::less<>> origins{};     // where values from outside are set, for messages
};

ParameterLookup::Found find_parameter(Scope const*, std::string_view name);
std::vector<std::string> parameter_names(Scope const*);

// A value set from outside: by the entry that places a part, by a row of a table, by the command line.
struct GivenParameter {
  std::optional<Value> value;      // evaluated where it is written
  NodeData const* node = nullptr;  // where it is written, for messages; null when the dimension is checked already
  std::string from = {};           // "line 3 of rows.csv"
};
using GivenParameters = std::map<std::string, GivenParameter, std::less<>>;

// Evaluates `params` (a table or null) in any order; values given replace those written, with the same dimension.
std::shared_ptr<Scope const> make_scope(SceneDocument&, NodeData const* params, std::shared_ptr<Scope const> outer,
                                        GivenParameters const& given);

// The scope of the model; `overrides` are "name=value" from the command line.
std::shared_ptr<Scope const> make_model_scope(SceneDocument&, NodeData const* params,
                                              std::vector<std::string> const& overrides);

// Values set by their place in the model, in the table `set` or on the command line:
// "-p materials.steel.scatter.brdf=5e-3/sr".

// A place is two or more keys separated by dots; the name of a parameter contains no dot. An element of a list is
// addressed by its `name` or its number, counted from 0: "scene.ring.at[2]".
bool names_place(std::string const& override_text);
std::vector<std::string> keys_of_place(std::string_view place);  // "scene.ring.at[2]": scene, ring, at, 2

// Replaces the scalars of the merged model that the table `set` names, then those that these overrides name, or adds
// their last key; records problems at their places. Overrides of parameters are left out.
void set_values(SceneDocument&, NodeData& model, std::vector<std::string> const& overrides);

}  // namespace straytrace::scene
