// SPDX-License-Identifier: BSD-3-Clause
// The filled volumes around a point, carried along a path, and the media on both sides of a surface
// (R3.23). Page: docs/reference/interfaces/media.md.
#pragma once

#include <cstdint>

#include "base/math/functions.hpp"

namespace straytrace::optics {

// Share of power left after a length [m] in a medium that absorbs `absorption` [1/m] (Beer and Lambert).
STRAY_HD double kept_on_the_way(double absorption, double distance) {
  return absorption > 0 ? exp_number(-absorption * distance) : 1;
}

// The change of volumes in a passage from one side of a surface to the other.
struct Passage {
  static constexpr std::uint32_t none = 0xffffffffu;
  std::uint32_t volume = none;  // filled volume behind the surface, whose normal points out of it; none: a sheet
  bool from_front = true;       // against the normal: into the volume
  std::int32_t priority = 0;    // where volumes overlap, the higher one fills the space; equal: the last one entered
};

struct MediaStack {
  static constexpr int capacity = 8;
  struct Entry {
    std::uint32_t volume;
    std::int32_t priority;
  };
  Entry entry[capacity];  // in the order they were entered; those from `depth` on have no meaning
  int depth = 0;
  bool overflow = false;  // more than `capacity` volumes at one point: the rest was not kept

  STRAY_HD bool inside(std::uint32_t volume) const {
    for (int i = 0; i < depth; ++i)
      if (entry[i].volume == volume) return true;
    return false;
  }
  // The volume whose medium fills the space here; none: outside all of them.
  STRAY_HD std::uint32_t current() const {
    int best = -1;
    for (int i = 0; i < depth; ++i)
      if (best < 0 || entry[i].priority >= entry[best].priority) best = i;
    return best < 0 ? Passage::none : entry[best].volume;
  }
  // Entering twice counts once.
  STRAY_HD void enter(std::uint32_t volume, std::int32_t priority = 0) {
    if (volume == Passage::none || inside(volume)) return;
    if (depth == capacity) {
      overflow = true;
      return;
    }
    entry[depth++] = {volume, priority};
  }
  STRAY_HD void leave(std::uint32_t volume) {
    int kept = 0;
    for (int i = 0; i < depth; ++i)
      if (entry[i].volume != volume) entry[kept++] = entry[i];
    depth = kept;
  }
};

// Volumes that fill the space before and behind a surface, and the stacks there.
struct MediumSides {
  std::uint32_t in = Passage::none, out = Passage::none;
  MediaStack before, after;  // `before` for reflected light, `after` for transmitted light
};

// Corrects the stack first: light that leaves a volume was in it, also if it started there unnoticed; light that enters
// one was outside.
STRAY_HD void put_right(MediaStack& stack, Passage p) {
  if (p.volume == Passage::none) return;
  if (p.from_front) {
    stack.leave(p.volume);
  } else if (!stack.inside(p.volume)) {
    MediaStack held;  // entered before all others
    held.enter(p.volume, p.priority);
    for (int i = 0; i < stack.depth; ++i) held.enter(stack.entry[i].volume, stack.entry[i].priority);
    held.overflow = held.overflow || stack.overflow;
    stack = held;
  }
}
STRAY_HD void pass(MediaStack& stack, Passage p) {
  if (p.from_front)
    stack.enter(p.volume, p.priority);
  else
    stack.leave(p.volume);
}

STRAY_HD MediumSides sides(MediaStack const& stack, Passage p) {
  MediumSides s;
  s.before = stack;
  put_right(s.before, p);
  s.after = s.before;
  pass(s.after, p);
  s.in = s.before.current();
  s.out = s.after.current();
  return s;
}

// Two surfaces that touch are one boundary: only the net change of media counts, in whatever order they were found.
constexpr double contact_distance = 1e-9;  // m, along the ray
STRAY_HD MediumSides sides(MediaStack const& stack, Passage first, Passage second) {
  MediumSides s;
  s.before = stack;
  put_right(s.before, first);
  put_right(s.before, second);
  s.after = s.before;
  if (first.from_front && !second.from_front) {  // out of the one before into the other
    pass(s.after, second);
    pass(s.after, first);
  } else {
    pass(s.after, first);
    pass(s.after, second);
  }
  s.in = s.before.current();
  s.out = s.after.current();
  return s;
}

}  // namespace straytrace::optics
