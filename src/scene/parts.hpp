// SPDX-License-Identifier: BSD-3-Clause
// The `parts` of a model: their structure and how many faces each of them unfolds to.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.hpp"
#include "scene/scene_document.hpp"
#include "scene/scope.hpp"

namespace straytrace::scene {

constexpr std::size_t deepest_part = 8;

// Keys of an entry that a parameter of a part may not be called.
constexpr std::array<std::string_view, 14> entry_keys{"name",     "use",  "shape",  "file",    "repeat",
                                                      "split",    "at",   "facing", "rotate",  "body",
                                                      "material", "side", "medium", "surfaces"};
bool is_entry_key(std::string_view);

// False, with a problem, for a name that could not be used in paths like "bench/dump_3/front".
bool name_allowed(Node const& at, std::string const& name);

// Reports parts without faces, unknown keys and bad names.
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

// `limits` of a part: bounds of its parameters that make its faces fit together.

// False, with a problem at the value in `entry` (or at the entry, when it gives none), for the first parameter that is
// not `above`, `at_least` or `at_most` the bound of the part; `name` is that of the entry.
bool within_limits(Node const& entry, std::string const& name, Node const& part, std::shared_ptr<Scope const> const&);

// Problems inside the built-in parts are reported where the user can fix them: at the entry that uses the part.

// As long as it lives, problems in the source `hidden` are reported for `name` at the entry.
class ProblemRedirect {
 public:
  ProblemRedirect(SceneDocument& document, Blame blame) : document_(document), before_(document.blame) {
    document_.blame = std::move(blame);
  }
  ~ProblemRedirect() { document_.blame = std::move(before_); }
  ProblemRedirect(ProblemRedirect const&) = delete;
  ProblemRedirect& operator=(ProblemRedirect const&) = delete;

 private:
  SceneDocument& document_;
  std::optional<Blame> before_;
};

// The document as the nodes of one face of a built-in part see it.
class InPart : public Document {
 public:
  InPart(SceneDocument& whole, Blame blame) : whole_(whole), blame_(std::move(blame)) {}
  void add(Problem p) override {
    ProblemRedirect const now(whole_, blame_);
    whole_.add(std::move(p));
  }
  void withdraw(Problem p) override {
    ProblemRedirect const now(whole_, blame_);
    whole_.withdraw(std::move(p));
  }
  std::size_t errors() const override { return whole_.errors(); }
  std::optional<Value> evaluate(NodeData const& node, Scope const* scope) override {
    ProblemRedirect const now(whole_, blame_);
    return whole_.evaluate(node, scope);
  }
  std::optional<std::string> origin(std::string_view expression, Scope const* scope) const override {
    return whole_.origin(expression, scope);
  }
  std::string data_file(Node const& from, std::string const& name) override { return whole_.data_file(from, name); }
  std::optional<std::string> optional_file(Node const& from, std::string const& name) override {
    return whole_.optional_file(from, name);
  }
  std::optional<std::string> derived_file(Node const& from, std::string const& name,
                                          std::function<std::optional<std::string>()> const& make) override {
    return whole_.derived_file(from, name, make);
  }
  Place place_in_file(Node const& from, std::string const& name, std::uint32_t line, std::uint32_t column) override {
    return whole_.place_in_file(from, name, line, column);
  }

 private:
  SceneDocument& whole_;
  Blame blame_;
};

// The main file, its includes and the built-in parts as one table (docs/reference/scene.md).

// The table of the whole model without `straytrace` and `include`. Throws InputError when a file cannot be read as
// YAML, because problems of the rest would be noise.
std::shared_ptr<NodeData> read_model(SceneDocument&, std::string const& main_file,
                                     std::vector<std::string> const& overrides);

constexpr int format_version = 1;
// The source that holds them, in a document whose main file is `main`.
constexpr std::uint32_t builtin_source(std::uint32_t main) { return main + 1; }

// Strict YAML (docs/reference/scene.md): no duplicate keys, anchors, aliases, merge keys, tags, further documents,
// tabs, plain values broken over lines.

// The root of a file; null when the syntax is broken, with the problems recorded.
std::shared_ptr<NodeData> read_yaml(SceneDocument&, std::uint32_t file);

// The `scene` list with `use`, parts of parts and `repeat` expanded.

std::vector<Scene::Instance> expand_scene(SceneDocument&, Node const& root);

// Along which parts are repeated, by Instance::repeat_axis.
constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};

}  // namespace straytrace::scene
