// SPDX-License-Identifier: BSD-3-Clause
// The table `optimise` of a scene and the options that replace its keys (docs/reference/scene.md#optimise).
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/input/document.hpp"
#include "scene/scene.hpp"

namespace straytrace::session {

struct VariedParameter {
  std::string name;          // of a parameter, or the place of a value: "scene.baffles.material"
  double low = 0, high = 0;  // SI
  Dimension dimension;
  bool whole = false;
  std::vector<std::string> values;  // instead of a range: as -p takes them
  std::vector<double> price;        // of each value; empty: none

  bool listed() const { return !values.empty(); }
};

// "h_total < 0.1 x et-d-points between 3 Hz and 1 kHz with 95 %"
struct NoiseLimit {
  std::string text, curve;  // design curve, or "line": that of the scene with its margin
  double factor = 1, low_hz = 0, high_hz = infinity, confidence = 0.95;
};

// "power(baffles) < 2 W with 95 %": of the stray light that arrives on entries of the scene, all encounters counted.
struct PowerLimit {
  std::string text, entry;  // by name, with wildcards
  double watts = 0, confidence = 0.95;
};

// "rim > 6 * beam_radius": known without a trace.
struct Relation {
  std::string text, smaller, larger;
  bool or_equal = false;
};

struct OptimiseOrder {
  std::string minimise;  // an expression, or "h_total": the largest ratio to the line
  std::vector<VariedParameter> vary;
  std::vector<NoiseLimit> limits;
  std::vector<PowerLimit> powers;
  std::vector<Relation> relations;

  bool least_noise() const { return minimise == "h_total"; }
  std::vector<std::string> limit_texts() const;  // of the noise, then of powers
};

// Of the command line; empty ones leave those of the table.
struct OrderWords {
  std::string minimise;
  std::vector<std::string> vary, subject;  // "rim=30cm..49cm", "n=10..60:integer", "black=1e-4/sr,1e-5/sr"
};

// Nothing without the table. Problems are recorded in the scene.
std::optional<OptimiseOrder> read_order(Scene const&);
// The same with the words. Throws InputError with all problems.
OptimiseOrder read_order(Scene const&, OrderWords const&);

// Expressions of the parameters of a scene, with count(ENTRY), area(ENTRY) in m^2 and price(PARAMETER).
class SceneValues {
 public:
  // Area of the surfaces of an entry, by its name in the scene, m^2; called only where an expression needs it.
  using Areas = std::function<std::map<std::string, double>()>;
  SceneValues(Scene const& scene, std::map<std::string, double> prices, Areas areas)
      : scene_(scene), prices_(std::move(prices)), areas_(std::move(areas)) {}
  std::optional<Value> value(std::string_view expression) const;  // throws ExpressionProblem
  double excess(Relation const&) const;  // (smaller - larger) over the larger magnitude: at most 0 where it holds

 private:
  Value called(std::string_view function, std::string_view name) const;
  Scene const& scene_;
  std::map<std::string, double> prices_;
  Areas areas_;
};

// The entry of the scene that a group of surfaces belongs to: "baffles" of "baffles/cone".
std::string entry_of(std::string const& group);

}  // namespace straytrace::session
