// SPDX-License-Identifier: BSD-3-Clause
// Problems inside the built-in parts, told where the user can fix them: at the entry that uses the part.
#pragma once

#include <string>

#include "scene/scene_document.hpp"

namespace straytrace {

// As long as it lives, what is wrong in the source `hidden` is said of `name` at the entry.
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
  bool healthy() const override { return whole_.healthy(); }
  std::optional<Value> evaluate(NodeData const& node, Scope const* scope) override {
    ProblemRedirect const now(whole_, blame_);
    return whole_.evaluate(node, scope);
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

}  // namespace straytrace
