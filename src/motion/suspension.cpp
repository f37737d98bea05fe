// SPDX-License-Identifier: BSD-3-Clause
#include "motion/suspension.hpp"

#include <fmt/format.h>

namespace straytrace {

std::array<bool, 6> add_suspended(Node const& suspended, std::array<AxisMotion, 6>& axes) {
  std::array<bool, 6> stated{};
  constexpr std::array<bool, 6> translations = {true, true, true};  // which is meant cannot be told
  if (suspended.kind() != Node::Kind::table) {
    suspended.problem("'suspended' is a table",
                      "write {from: ground, vertical: y, stages: [{frequency: 0.6 Hz, quality: 10}]}");
    return translations;
  }
  std::string const body = suspended.word("from");
  std::string const up = suspended.choice("vertical", std::span(axis_names).first(3));
  for (bool const vertical : {false, true}) {
    Node const stages = suspended[vertical ? "vertical_stages" : "stages"];
    if (!stages && !vertical)
      suspended.problem("'stages' of the suspension are missing", "add 'stages: [{frequency: 0.6 Hz, quality: 10}]'");
    if (!stages) continue;
    auto const through = std::make_shared<TransferFunction const>(read_stages(stages));
    if (body.empty() || up.empty()) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if ((axis_names[axis] == up) != vertical) continue;
      axes[axis].references.push_back({body, axis, 1, true, through, suspended["from"]});
      stated[axis] = true;
    }
  }
  suspended.refuse_unknown("'suspended'");
  return body.empty() || up.empty() || !suspended.has("stages") ? translations : stated;
}

}  // namespace straytrace
