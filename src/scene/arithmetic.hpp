// SPDX-License-Identifier: BSD-3-Clause
// Dimension-checked arithmetic of expressions. Every function throws ExpressionProblem for what it refuses.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "scene/expression.hpp"

namespace straytrace {

// A value and the bytes of the text it came from.
struct Operand {
  Value value;
  std::size_t begin = 0, end = 0;
  bool literal = false;  // a number as written, with or without a unit
};

Operand add(Operand const&, Operand const&, int sign, std::string_view text);
Operand multiply(Operand const&, Operand const&, std::string_view text);
Operand divide(Operand const&, Operand const&, std::string_view text);
Operand raise(Operand const&, Operand const& exponent, std::string_view text);

inline constexpr std::array<std::string_view, 11> function_names{"sqrt", "abs",   "min", "max", "sin",      "cos",
                                                                 "tan",  "atan2", "exp", "log", "curvature"};
// `curvature(R)` is 1/R, and 0 for R = 0, which means flat. [begin, end) are the bytes of the whole call.
Operand call(std::string_view name, std::span<Operand const> arguments, std::size_t begin, std::size_t end);

}  // namespace straytrace
