// SPDX-License-Identifier: BSD-3-Clause
// What the objects of the library hold, and texts that they read in place of files.
#pragma once

#include <string>
#include <utility>

#include "scene/scene_document.hpp"
#include "session/open_run.hpp"
#include "straytrace/straytrace.hpp"

namespace straytrace::api {

struct Model::Source {
  session::Model model;
};

struct Run::Source {
  RunFile file;
};

// A text in place of a file, while this object lives.
class TextInPlace {
 public:
  TextInPlace(std::string name, std::string const& text) : name_(std::move(name)) { scene::set_unsaved(name_, text); }
  ~TextInPlace() { scene::forget_unsaved(name_); }
  TextInPlace(TextInPlace const&) = delete;
  TextInPlace& operator=(TextInPlace const&) = delete;

 private:
  std::string name_;
};

}  // namespace straytrace::api
