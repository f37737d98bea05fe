// SPDX-License-Identifier: BSD-3-Clause
// Entry point of the module: text files -> one checked tree (docs/reference/scene.md). Includes, parameters, parts and
// repeats are already expanded; the modules that read the tree check units, references and geometry.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/input/table.hpp"

namespace straytrace::scene {

// name as written -> text. Stored in the run file, so that the run can be repeated from it.
using FileTexts = std::map<std::string, std::string>;

class Scene {
 public:
  Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  Node root() const;  // the main table, `straytrace: 1` checked and consumed
  Node table(std::string_view key) const { return root().table(key); }
  // Placed parts after `use`, nested parts and `repeat` are expanded: one entry per instance. Each node is a table
  // with name, shape, material, body, at, facing/rotate ... whose scalars are evaluated in the instance's scope.
  struct Instance {
    std::string group;         // name shown in path classes, "baffles" or "baffles/cone"
    std::string name;          // unique, "baffles[12]/cone"
    Node node;                 // the face or shape table
    Node placement;            // the scene entry it came from (body, material given there)
    Node usual_medium;         // `medium` of the part: fills it where it lets light in, unless entry or face name one
    std::vector<Node> frames;  // outermost first: tables holding at / facing / rotate
    double offset = 0;         // m along the repeat axis, in the frame of the scene entry (outermost)
    int repeat_axis = -1;      // 0, 1, 2 = x, y, z; -1 none
    bool refused = false;      // its part is unknown or impossible, which is reported: only names are read
  };
  std::vector<Instance> const& instances() const;

  std::string const& main_file() const;               // name as given by the user, without directories of this machine
  std::vector<std::string> const& overrides() const;  // as given on the command line
  FileTexts const& files() const;  // every text read, includes and data files, by name relative to the main file
  std::string title() const;
  std::string place_text(Place) const;  // "library/materials/mirrors.yaml:7"
  std::string warnings() const;         // rendered, empty when there are none
  void throw_if_problems() const;       // one InputError with everything, sorted by place
  // The tree with parameters evaluated and includes, parts and repeats expanded (check --resolved).
  std::string resolved() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  friend Scene read_scene(std::string const&, std::vector<std::string> const&, FileTexts const*);
};

// Reads `file` from disk, or from `texts` when given (run files). `overrides`: "aperture=60cm" from the command line.
// Syntax errors and errors of structure are recorded; the caller calls throw_if_problems() once all modules
// have read their tables. Throws InputError at once when a file is missing or is not YAML: problems reported about the
// rest would be noise. With `texts` the disk is never touched.
Scene read_scene(std::string const& file, std::vector<std::string> const& overrides = {},
                 FileTexts const* texts = nullptr);

}  // namespace straytrace::scene
