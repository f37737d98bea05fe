// SPDX-License-Identifier: BSD-3-Clause
// Quantities and expressions of parameters: "L - 50 m", "2e-11 m/sqrt(Hz)", "10 um peak", "-37 dB"
// (docs/reference/scene.md).
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/input/document.hpp"

namespace straytrace {

struct ParameterLookup {
  struct Found {
    bool known = false;
    std::optional<Value> value;  // empty when known but broken; its problem is recorded already
  };
  std::function<Found(std::string_view)> find;
  std::function<std::vector<std::string>()> names;  // for suggestions
};

// Thrown inside an expression: what is wrong with bytes [begin, end) of the text.
struct ExpressionProblem {
  std::string what, suggestion;
  std::size_t begin = 0, end = 0;
};

// Empty when a parameter it needs is broken. Throws ExpressionProblem.
std::optional<Value> evaluate_expression(std::string_view text, ParameterLookup const&);

// A name that cannot be a parameter because the language uses it: a unit, a function, peak, pp, rms, dB.
bool is_reserved_word(std::string_view);
bool is_parameter_name(std::string_view);

// Dimension-checked arithmetic of expressions. Every function throws ExpressionProblem for what it refuses.

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
