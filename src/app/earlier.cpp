// SPDX-License-Identifier: BSD-3-Clause
#include "app/earlier.hpp"

#include "app/open_run.hpp"

namespace straytrace {

Earlier::Earlier(std::string input) : input_(std::move(input)) {
  if (input_.ends_with(".h5")) file_ = read_run(input_);
}

Model Earlier::read(std::vector<std::string> const& overrides) const {
  if (!file_) return read_model(input_, overrides);
  Model model = model_of(*file_, overrides);
  model.seed = file_->trace.coupling.seed;
  model.world.block_size = file_->trace.coupling.block_size;
  if (file_->trace.stop_rule.empty()) {
    bool const in_pieces = file_->trace.stopped == Stopped::by_gaps || !file_->trace.slice.whole();
    model.until = {};
    model.histories =
        in_pieces ? file_->trace.all_blocks * file_->trace.coupling.block_size : file_->trace.coupling.histories;
  } else {
    model.until = parse_stop_rule(file_->trace.stop_rule);
  }
  return model;
}

Model Earlier::read_to_the_end(std::vector<std::string> const& overrides) const {
  Model model = read(overrides);
  if (file_) model.histories = file_->trace.all_blocks * file_->trace.coupling.block_size;
  return model;
}

RunContent Earlier::completed(RunContent content) const {
  if (!file_ || file_->about.motion_file.empty()) return content;
  content.files = file_->about.files;
  content.motion_file = file_->about.motion_file;
  return content;
}

}  // namespace straytrace
