// SPDX-License-Identifier: BSD-3-Clause
// The input of `run`: a scene file, or a run file that is made again from the texts, seed and stop rule inside it.
#pragma once

#include <optional>

#include "app/model.hpp"
#include "report/report.hpp"

namespace straytrace {

class Earlier {
 public:
  explicit Earlier(std::string input);
  Model read(std::vector<std::string> const& overrides) const;  // refers to the texts held here
  // The same with as many histories as were asked for, where the run was stopped before.
  Model read_to_the_end(std::vector<std::string> const& overrides) const;
  Slice slice() const { return file_ ? file_->trace.slice : Slice{}; }
  RunContent completed(RunContent) const;  // with the motion file the run was projected with

 private:
  std::string input_;
  std::optional<RunFile> file_;
};

}  // namespace straytrace
