// SPDX-License-Identifier: BSD-3-Clause
// What the objects of the library hold.
#pragma once

#include "session/open_run.hpp"
#include "straytrace/straytrace.hpp"

namespace straytrace::api {

struct Model::Source {
  session::Model model;
};

struct Run::Source {
  RunFile file;
};

}  // namespace straytrace::api
