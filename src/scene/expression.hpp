// SPDX-License-Identifier: BSD-3-Clause
// Quantities and expressions of parameters: "L - 50 m", "2e-11 m/sqrt(Hz)", "10 um peak", "-37 dB"
// (docs/reference/scene.md).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/input/document.hpp"

namespace straytrace::scene {

struct ParameterLookup {
  struct Found {
    bool known = false;
    std::optional<Value> value;  // empty when known but broken; its problem is already recorded
  };
  std::function<Found(std::string_view)> find;
  std::function<std::vector<std::string>()> names;  // for suggestions
  // Further functions, of one name each, as count(baffles): `called` throws ExpressionProblem; its bytes become those
  // of the name.
  std::vector<std::string> calls = {};
  std::function<Value(std::string_view call, std::string_view name)> called = {};
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

}  // namespace straytrace::scene
