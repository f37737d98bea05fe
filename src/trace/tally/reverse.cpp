// SPDX-License-Identifier: BSD-3-Clause
#include "trace/tally/reverse.hpp"

#include <algorithm>
#include <unordered_map>

#include "trace/tally/route.hpp"

namespace straytrace {
namespace {

// The route of `made` run backwards, with its numbers.
MadeClass mirrored(MadeClass const& made, std::uint64_t hash) {
  MadeClass other = made;
  other.row.hash = hash;
  other.row.steps = backwards(made.row.steps);
  other.row.port = made.back;
  other.row.by_reverse = true;
  other.back = made.row.port;
  return other;
}

bool better(CouplingClass const& a, CouplingClass const& b) {
  if (a.coupling.trusted != b.coupling.trusted) return a.coupling.trusted;
  return a.coupling.scored > b.coupling.scored;
}

}  // namespace

std::uint64_t hash_of_route(std::vector<PathStep> const& steps, std::uint32_t beam, std::uint32_t end) {
  std::uint64_t name = 0;
  for (PathStep const& s : steps) name = extended(name, s.group, s.event == Event::emit ? Event::scatter : s.event);
  return hash_of_ends(beam, name, end);
}

std::vector<PathStep> backwards(std::vector<PathStep> steps) {
  std::reverse(steps.begin(), steps.end());
  steps.front().event = Event::emit;
  steps.back().event = Event::couple;
  return steps;
}

void mirror_poorly_sampled(std::vector<MadeClass>& classes) {
  std::unordered_map<std::uint64_t, std::size_t> place;
  for (std::size_t i = 0; i < classes.size(); ++i) place[classes[i].row.hash] = i;
  std::size_t const sampled = classes.size();
  for (std::size_t i = 0; i < sampled; ++i) {
    if (!classes[i].reversible) continue;
    std::uint64_t const hash = hash_of_route(backwards(classes[i].row.steps), classes[i].beam, classes[i].back.value);
    auto const at = place.find(hash);
    if (at == place.end()) {
      classes.push_back(mirrored(classes[i], hash));
      continue;
    }
    MadeClass& other = classes[at->second];
    bool const settled = classes[i].row.by_reverse || other.row.by_reverse ||
                         (classes[i].row.coupling.trusted && other.row.coupling.trusted);
    if (!settled && better(classes[i].row, other.row)) other = mirrored(classes[i], hash);
  }
}

}  // namespace straytrace
