// SPDX-License-Identifier: BSD-3-Clause
// A model as its readers interpreted it: every key that they requested, its value in SI and its origin. Made after the
// model was read, for `print`, `diff` and the schema of the language.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input/document.hpp"
#include "scene/scene.hpp"
#include "scene/scene_document.hpp"

namespace straytrace::scene {

struct ModelValue {
  std::string key;                     // of a table entry; empty for elements of a list
  Node::Kind kind = Node::Kind::none;  // none: not written, so `value` is the default, empty where there is none
  std::string value;                   // of a scalar: a quantity in SI, "0.35 m", otherwise the text
  std::optional<Quantity> quantity;    // where the readers took one
  std::string written, origin;         // as in the file; "arm.yaml:12"
  KeyRequest how;                      // by the key in its table; otherwise how the value itself was read
  bool by_key = false;                 // it was the former
  std::string role;                    // name of a table in messages: "beam 'arm'"
  bool listed = false;                 // its keys are names that the user gives
  std::vector<ModelValue> children;

  bool given() const { return kind != Node::Kind::none; }
  ModelValue const* find(std::string_view key) const;
};

// The table of the whole model, with includes merged; built-in parts are left out.
ModelValue model_tree(Scene const&);

// One placed shape: its face and the entry it came from, with the parameters in force there.
struct PlacedValue {
  std::string group, name;
  ModelValue face, entry;
  std::vector<ModelValue> frames;  // outermost first: tables with at, facing, rotate
  double offset = 0;               // m along the axis of the repeat
  int axis = -1;
};
std::vector<PlacedValue> placed_values(Scene const&);

// YAML that is the same model again, with SI values; defaults and origins are comments.
std::string printed_model(Scene const&);

// The model as YAML text: parameters in SI, sections as written after includes, and one line per instance.
std::string resolved_text(Node const& root, std::vector<Scene::Instance> const&);

std::string si_text(std::optional<Value> const&);  // "0.35 m", "1e-05 m peak"; what reads back as the same value
std::string yaml_text(std::string const&);         // plain where YAML reads it back as the same text, otherwise quoted

// Entries that a model takes from the built-in library (docs/reference/library.md): files below "library/".

inline bool is_library(std::string_view file_name) { return file_name.starts_with("library/"); }

// Removes unused materials, media, parts and bodies of library files from the model, so that they cost nothing and
// cause no messages. A model that names an unknown material or part keeps all except bodies, so that a message can
// suggest one.
void drop_unused(SceneDocument const&, NodeData& model);

// "parameter first_baffle = 10 m: assumed; SOURCE" for each parameter marked so that something in the model names and
// that the command line does not set.
std::vector<std::string> assumed_parameters(Scene const&);

}  // namespace straytrace::scene
