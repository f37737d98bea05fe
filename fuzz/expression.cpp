// SPDX-License-Identifier: BSD-3-Clause
// Quantities, units and expressions of scenes.
#include "scene/expression.hpp"

#include "base/every_module.hpp"
#include "base/units/quantity.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace straytrace;
  std::string_view const text = fuzz::text_of(data, size);
  (void)parse_unit(text);
  (void)leading_unit(text);
  (void)likely_unit(text);
  ParameterLookup const lookup{[](std::string_view name) {
                                 Value const length{{4e3, dim::length, Amplitude::none}, false};
                                 return ParameterLookup::Found{name == "L" || name == "broken",
                                                               name == "L" ? std::optional(length) : std::nullopt};
                               },
                               [] {
                                 return std::vector<std::string>{"L", "broken"};
                               }};
  try {
    (void)evaluate_expression(text, lookup);
  } catch (ExpressionProblem const&) {
  }
  return 0;
}
