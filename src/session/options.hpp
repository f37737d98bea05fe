// SPDX-License-Identifier: BSD-3-Clause
// Options common to several commands. The struct of a command derives from the one that it needs and adds its
// own, in the file of the command.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::session {

enum ExitCode { done = 0, input_error = 2, numerical_failure = 3, unmet = 4, checkpointed = 85 };

struct PrintOptions {
  std::string format = "text";
  bool quiet = false;
  bool warnings = true;  // false: those of this model were printed before

  bool json() const { return format == "json"; }
};

struct SceneOptions : PrintOptions {
  std::string input;                   // scene or run file
  std::vector<std::string> overrides;  // "aperture=60cm"
};

struct TraceOptions : SceneOptions {
  std::optional<std::uint64_t> seed, histories;  // otherwise those of the scene
  std::string until, backend = "cpu";
  unsigned threads = 0;                 // 0: all cores
  double max_seconds = 0;               // 0: no limit
  double checkpoint_seconds = 1200;     // between writings of the run file during the trace; infinite: none
  std::uint64_t slice = 1, slices = 1;  // 7/200
  bool force = false;
};

// A page of this machine that follows the command (session/live).
struct LiveOptions {
  bool live = false, open = false;  // open: in a browser
  std::uint16_t port = 0;           // 0: a free one
};

}  // namespace straytrace::session
