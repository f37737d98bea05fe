// SPDX-License-Identifier: BSD-3-Clause
#include "session/optimise/order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "base/errors.hpp"
#include "base/text/pattern.hpp"
#include "base/text/words.hpp"
#include "noise/fundamental/budget.hpp"
#include "scene/expression.hpp"
#include "scene/scope.hpp"

namespace straytrace::session {
namespace {

// What is wrong with bytes [begin, end) of a text; 0, 0: with all of it.
using Complain = std::function<void(std::string what, std::string remedy, std::size_t begin, std::size_t end)>;

Complain at_node(Node const& node) {
  return [node](std::string what, std::string remedy, std::size_t begin, std::size_t end) {
    NodeData const& data = *node.data();
    if (end <= begin || data.inset < 0) return node.problem(std::move(what), std::move(remedy));
    Problem problem{node.place(), std::move(what), std::move(remedy), Severity::error, 1};
    std::string_view const text = data.text;
    problem.place.column += std::uint32_t(data.inset) + code_points(text.substr(0, begin));
    problem.width = std::max(1u, code_points(text.substr(begin, end - begin)));
    node.document()->add(std::move(problem));
  };
}

Complain of_option(std::string option, std::vector<InputError>& errors) {
  return [option, &errors](std::string const& what, std::string remedy, std::size_t, std::size_t) {
    errors.emplace_back(fmt::format("{}: {}", option, what), std::move(remedy));
  };
}

char const* const limit_example =
    "write 'h_total < 0.1 x et-d-points between 3 Hz and 1 kHz with 95 %', or a relation such as 'rim > 34 cm'";

struct RangeExamples {
  char const *range, *whole;
};
constexpr RangeExamples in_table{"write for example [30 cm, 49 cm]", "write {integer: [10, 60]}"},
    in_option{"write for example rim=30cm..49cm", "write for example baffles=10..60:integer"};

constexpr double least_excess = 1e-12;  // of equal values where one must be smaller

std::string trimmed(std::string text) {
  text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

// Reads one order; the same for table and options.
class OrderReader {
 public:
  explicit OrderReader(Scene const& scene) : scene_(scene) {}

  void minimise(std::string const& text, Complain const& complain) {
    order_.minimise = trimmed(text);
    if (!order_.least_noise() && order_.minimise.find("h_total") != text.npos)
      return complain("'h_total' cannot be part of an expression",
                      "write h_total alone, or a cost of parameters such as count(baffles*); limit the noise in "
                      "'subject_to' or with --subject \"h_total < ...\"",
                      0, 0);
    if (!order_.least_noise()) number(order_.minimise, text.find(order_.minimise), std::nullopt, complain);
  }

  void subject(std::string const& text, Complain const& complain) {
    static Pattern const noise(
        R"(\s*h_total\s*<\s*(?:(.+?)\s+x\s+)?(\S+)(?:\s+between\s+(.+?)\s+and\s+(.+?))?(?:\s+with\s+([0-9.]+)\s*%)?\s*)");
    static Pattern const on_entry(R"(\s*power\(\s*([^()]+?)\s*\)\s*<\s*(.+?)(?:\s+with\s+([0-9.]+)\s*%)?\s*)");
    if (PatternMatch const m = noise.match(text)) return limit(text, m, complain);
    if (PatternMatch const m = on_entry.match(text)) return power(text, m, complain);
    std::size_t const sign = text.find_first_of("<>");
    if (std::string const first = trimmed(text.substr(0, sign)); means_noise(first))
      return complain(fmt::format("'{}' is not a limit", text), "did you mean 'h_total'? " + std::string(limit_example),
                      0, 0);
    if (sign == text.npos || text.find_first_of("<>", sign + 1) != text.npos || text.find("h_total") != text.npos)
      return complain(fmt::format("'{}' is not a limit", text), limit_example, 0, 0);
    std::size_t const right = sign + (sign + 1 < text.size() && text[sign + 1] == '=' ? 2 : 1);
    std::string const before = trimmed(text.substr(0, sign)), after = trimmed(text.substr(right));
    auto const a = number(before, text.find(before), std::nullopt, complain);
    auto const b = number(after, right + text.substr(right).find(after), std::nullopt, complain);
    if (!a || !b) return;
    bool const zero = a->bare_zero || b->bare_zero;
    if (!zero && !(a->quantity.dimension == b->quantity.dimension))
      return complain(fmt::format("'{}' compares {} with {}", text, described(a->quantity.dimension),
                                  described(b->quantity.dimension)),
                      "give both sides the same dimension", 0, 0);
    bool const less = text[sign] == '<';
    order_.relations.push_back({text, less ? before : after, less ? after : before, right > sign + 1});
  }

  // A parameter with its ends or its values. `examples`: as a range is written where this one stands.
  void vary(VariedParameter p, Complain const& complain, RangeExamples const& examples) {
    std::vector<std::string> const known = scene::parameter_names(scene_.root().scope().get());
    if (!scene::names_place(p.name + "=x") && std::ranges::find(known, p.name) == known.end())
      return complain(
          fmt::format("the scene has no parameter '{}'", p.name),
          did_you_mean(p.name, known, "define it under 'params', or write the place of a value, scene.tube.material"),
          0, 0);
    if (std::ranges::any_of(order_.vary, [&](auto const& other) { return other.name == p.name; }))
      return complain(fmt::format("'{}' is varied twice", p.name), "keep one range of it", 0, 0);
    if (p.whole && (p.low != std::round(p.low) || p.high != std::round(p.high)))
      return complain(fmt::format("the range of '{}' does not end at whole numbers", p.name), examples.whole, 0, 0);
    if (!p.listed() && !(p.low < p.high))
      return complain(fmt::format("the range of '{}' does not go from a lower to a higher value", p.name),
                      examples.range, 0, 0);
    if (auto const wanted = p.listed() ? std::nullopt : dimension_of(p.name); wanted && !(p.dimension == *wanted))
      return complain(
          fmt::format("'{}' is {}, but its range is {}", p.name, described(*wanted), described(p.dimension)),
          fmt::format("write both ends with a unit, for example {}", with_unit("10", *wanted)), 0, 0);
    if (!p.price.empty() && p.price.size() != p.values.size())
      return complain(fmt::format("'{}' has {} and {}", p.name, counted(p.values.size(), "value"),
                                  counted(p.price.size(), "price")),
                      "write one price for each value", 0, 0);
    if (!p.price.empty()) prices_[p.name] = p.price.front();
    order_.vary.push_back(std::move(p));
  }

  std::optional<Value> number(std::string const& text, std::size_t offset, std::optional<Dimension> wanted,
                              Complain const& complain) const {
    try {
      auto const found = SceneValues(scene_, prices_, {}).value(text);
      if (found && wanted && !(found->quantity.dimension == *wanted) && !found->bare_zero) {
        complain(fmt::format("'{}' is {}, not {}", text, described(found->quantity.dimension), described(*wanted)),
                 fmt::format("write for example {}", with_unit("10", *wanted)), offset, offset + text.size());
        return {};
      }
      return found;
    } catch (scene::ExpressionProblem const& p) {
      complain(p.what, p.suggestion, offset + p.begin, offset + p.end);
      return {};
    }
  }

  OptimiseOrder order() && { return std::move(order_); }

 private:
  bool means_noise(std::string const& word) const {
    std::vector<std::string> known = scene::parameter_names(scene_.root().scope().get());
    known.emplace_back("h_total");
    return word != "h_total" && std::ranges::find(known, word) == known.end() && nearest_word(word, known) == "h_total";
  }
  // Of a parameter; nothing for a place, a word, or a zero without unit.
  std::optional<Dimension> dimension_of(std::string const& name) const {
    if (scene::names_place(name + "=x")) return {};
    try {
      auto const found = SceneValues(scene_, prices_, {}).value(name);
      return found && !found->bare_zero ? std::optional(found->quantity.dimension) : std::nullopt;
    } catch (scene::ExpressionProblem const&) {
      return {};
    }
  }

  void limit(std::string const& text, PatternMatch const& m, Complain const& complain) {
    NoiseLimit limit;
    limit.text = trimmed(text);
    limit.curve = m[2];
    auto const part = [&](std::size_t k, Dimension wanted, double& into) {
      if (!m.matched(k)) return;
      auto const found = number(m[k], m.position(k), wanted, complain);
      into = found ? found->quantity.si : not_a_number;
    };
    part(1, dim::plain, limit.factor);
    part(3, dim::frequency, limit.low_hz);
    part(4, dim::frequency, limit.high_hz);
    if (m.matched(5)) limit.confidence = confidence_of(m[5], text, complain);
    std::vector<std::string> known{"line"};
    for (auto const& name : built_in_designs()) known.push_back(name);
    for (Node const& name : scene_.table("noise").list("compare")) known.push_back(name.text());
    std::size_t const at = m.position(2);
    if (std::ranges::find(known, limit.curve) == known.end())
      complain(fmt::format("'{}' is not a curve to compare with", limit.curve),
               did_you_mean(limit.curve, known, limit_example), at, at + limit.curve.size());
    if (!(limit.factor > 0) && !std::isnan(limit.factor))
      complain(fmt::format("the factor in '{}' is not above zero", text), limit_example, 0, 0);
    if (limit.low_hz >= limit.high_hz)
      complain(fmt::format("the band in '{}' does not go from a lower to a higher frequency", text), limit_example, 0,
               0);
    order_.limits.push_back(std::move(limit));
  }

  static double confidence_of(std::string const& percent, std::string const& text, Complain const& complain) {
    double const confidence = std::strtod(percent.c_str(), nullptr) / 100;
    if (!(confidence >= 0.5 && confidence <= 0.999))
      complain(fmt::format("the confidence in '{}' is not between 50 % and 99.9 %", text), "write 'with 95 %'", 0, 0);
    return confidence;
  }

  void power(std::string const& text, PatternMatch const& m, Complain const& complain) {
    PowerLimit limit;
    limit.text = trimmed(text);
    limit.entry = m[1];
    auto const found = number(m[2], m.position(2), dim::power, complain);
    limit.watts = found ? found->quantity.si : not_a_number;
    if (found && !(limit.watts > 0))
      complain(fmt::format("the power in '{}' is not above zero", text), "write 'power(baffles) < 1 W'", 0, 0);
    if (m.matched(3)) limit.confidence = confidence_of(m[3], text, complain);
    std::set<std::string> found_entries;
    for (Scene::Instance const& instance : scene_.instances()) found_entries.insert(entry_of(instance.group));
    std::vector<std::string> const entries(found_entries.begin(), found_entries.end());
    if (std::ranges::none_of(entries, [&](std::string const& entry) { return matches(limit.entry, entry); }))
      complain(fmt::format("no entry of the scene is called '{}'", limit.entry),
               did_you_mean(limit.entry, entries, fmt::format("known: {}", fmt::join(entries, ", "))), m.position(1),
               m.position(1) + m[1].size());
    order_.powers.push_back(std::move(limit));
  }

  Scene const& scene_;
  OptimiseOrder order_;
  std::map<std::string, double> prices_;
};

std::vector<std::string> texts_of(Node const& list) {
  std::vector<std::string> out;
  for (Node const& value : list.as_list()) out.push_back(value.as_word());
  return out;
}

// The ends of a range; true when they are sound.
bool read_ends(Node const& list, VariedParameter& p) {
  std::vector<Node> const ends = list.as_list();
  if (ends.size() != 2) {
    list.problem(fmt::format("the range of '{}' needs two ends", p.name), "write for example [30 cm, 49 cm]");
    return false;
  }
  Quantity const low = ends[0].as_quantity(), high = ends[1].as_quantity();
  if (std::isnan(low.si) || std::isnan(high.si)) return false;
  if (!(low.dimension == high.dimension) && low.si != 0) {
    ends[1].problem("both ends of a range must have the same dimension", "write for example [30 cm, 49 cm]");
    return false;
  }
  p.low = low.si;
  p.high = high.si;
  p.dimension = high.dimension;
  return true;
}

void read_varied(std::string const& name, Node const& node, OrderReader& reader) {
  VariedParameter p;
  p.name = name;
  if (node.kind() != Node::Kind::table) {
    if (read_ends(node, p)) reader.vary(std::move(p), at_node(node), in_table);
    return;
  }
  std::size_t const before = node.document()->errors();
  if (Node const ends = node["integer"]) p.whole = read_ends(ends, p);
  if (Node const values = node["values"]) p.values = texts_of(values);
  for (Node const& price : node.list("price")) p.price.push_back(price.as_number(dim::plain));
  if (p.whole == p.listed() && node.document()->errors() == before)
    node.problem(fmt::format("'{}' needs a range of whole numbers or a list of values", name),
                 "write {integer: [10, 60]} or {values: [1e-4 /sr, 1e-5 /sr], price: [1, 4]}");
  node.refuse_unknown("a varied parameter");
  if (node.document()->errors() == before) reader.vary(std::move(p), at_node(node), in_table);
}

void vary_by_word(std::string const& word, OrderReader& reader, Complain const& complain) {
  std::size_t const equal = word.find('='), dots = word.find("..");
  VariedParameter p;
  p.name = word.substr(0, equal);
  if (equal == 0 || equal == word.npos)
    return complain(fmt::format("'{}' does not name a parameter and its range", word), "write rim=30cm..49cm", 0, 0);
  std::string const text = word.substr(equal + 1);
  if (dots == word.npos) {
    static Pattern const dash(R"(.*[0-9]\s*[a-z]*\s*-\s*[0-9].*)");
    if (text.find(',') == text.npos && dash.match(text))
      return complain(fmt::format("'{}' is one value, not a range", word), in_option.range, 0, 0);
    for (std::size_t at = 0; at <= text.size();) {
      std::size_t const comma = std::min(text.find(',', at), text.size());
      p.values.push_back(trimmed(text.substr(at, comma - at)));
      at = comma + 1;
    }
    return reader.vary(std::move(p), complain, in_option);
  }
  static constexpr std::string_view integer = ":integer";
  std::string high = word.substr(dots + 2);
  p.whole = high.ends_with(integer);
  if (p.whole) high.resize(high.size() - integer.size());
  auto const b = reader.number(high, 0, std::nullopt, complain);
  auto const a = b ? reader.number(word.substr(equal + 1, dots - equal - 1), 0, b->quantity.dimension, complain) : b;
  if (!a) return;
  p.low = a->quantity.si;
  p.high = b->quantity.si;
  p.dimension = b->quantity.dimension;
  reader.vary(std::move(p), complain, in_option);
}

// Varied parameters first: expressions name their prices.
void read_all(Node const& table, OrderWords const& words, OrderReader& reader, std::vector<InputError>& errors) {
  for (std::string const& word : words.vary) vary_by_word(word, reader, of_option("--vary", errors));
  if (table)
    for (auto const& [name, node] : table.table("vary").items())
      if (words.vary.empty()) read_varied(name, node, reader);
  if (!words.minimise.empty()) reader.minimise(words.minimise, of_option("--minimise", errors));
  for (std::string const& word : words.subject) reader.subject(word, of_option("--subject", errors));
  if (!table) return;
  if (Node const minimise = table["minimise"]; minimise && words.minimise.empty())
    reader.minimise(minimise.as_word(), at_node(minimise));
  for (Node const& limit : table.list("subject_to"))
    if (words.subject.empty()) reader.subject(limit.as_word(), at_node(limit));
  table.refuse_unknown("'optimise'");
}

void refuse_incomplete(OptimiseOrder const& order) {
  std::vector<InputError> errors;
  if (order.minimise.empty())
    errors.emplace_back("nothing is to be minimised",
                        "write --minimise h_total, or in the scene 'optimise: {minimise: count(baffles)}'");
  if (order.vary.empty())
    errors.emplace_back("no parameter is varied",
                        "write --vary rim=30cm..49cm, or in the scene 'optimise: {vary: ...}'");
  if (order.limits.empty() && order.powers.empty() && order.relations.empty() && !order.least_noise())
    errors.emplace_back("there is no limit, so the least cost has no meaning", limit_example);
  throw_all(errors);
}

}  // namespace

std::optional<OptimiseOrder> read_order(Scene const& scene) {
  Node const table = scene.table("optimise");
  if (!table) return {};
  OrderReader reader(scene);
  std::vector<InputError> none;
  read_all(table, {}, reader, none);
  return std::move(reader).order();
}

OptimiseOrder read_order(Scene const& scene, OrderWords const& words) {
  OrderReader reader(scene);
  std::vector<InputError> errors;
  read_all(scene.table("optimise"), words, reader, errors);
  try {
    scene.throw_if_problems();
  } catch (InputError const& e) {
    errors.push_back(e);
  }
  throw_all(errors);
  OptimiseOrder order = std::move(reader).order();
  refuse_incomplete(order);
  return order;
}

std::optional<Value> SceneValues::value(std::string_view expression) const {
  scene::Scope const* const scope = scene_.root().scope().get();
  return scene::evaluate_expression(expression,
                                    {[=](std::string_view name) { return scene::find_parameter(scope, name); },
                                     [=] { return scene::parameter_names(scope); },
                                     {"count", "area", "price"},
                                     [this](std::string_view f, std::string_view name) { return called(f, name); }});
}

Value SceneValues::called(std::string_view function, std::string_view name) const {
  if (function == "price") {
    if (auto const found = prices_.find(std::string(name)); found != prices_.end())
      return {{found->second, dim::plain, {}}, false};
    std::vector<std::string> known;
    for (auto const& [varied, ignored] : prices_) known.push_back(varied);
    throw scene::ExpressionProblem{fmt::format("no varied parameter '{}' has prices", name),
                                   did_you_mean(name, known, "write {values: [...], price: [...]} under 'vary'")};
  }
  std::set<std::string> placed, groups;
  for (Scene::Instance const& instance : scene_.instances()) {
    std::string const entry = entry_of(instance.group);
    groups.insert(entry);
    if (matches(name, entry)) placed.insert(instance.name.substr(0, instance.name.find('/')));
  }
  std::vector<std::string> const known(groups.begin(), groups.end());
  if (placed.empty())
    throw scene::ExpressionProblem{fmt::format("no entry of the scene is called '{}'", name),
                                   did_you_mean(name, known, fmt::format("known: {}", fmt::join(known, ", ")))};
  if (function == "count") return {{double(placed.size()), dim::plain, {}}, false};
  double area = areas_ ? 0 : 1;  // of an expression that is only checked
  if (areas_)
    for (auto const& [entry, own] : areas_())
      if (matches(name, entry)) area += own;
  return {{area, dim::plain, {}}, false};
}

std::string entry_of(std::string const& group) { return group.substr(0, group.find('/')); }

std::vector<std::string> OptimiseOrder::limit_texts() const {
  std::vector<std::string> all;
  for (NoiseLimit const& limit : limits) all.push_back(limit.text);
  for (PowerLimit const& limit : powers) all.push_back(limit.text);
  return all;
}

double SceneValues::excess(Relation const& r) const {
  auto const a = value(r.smaller), b = value(r.larger);
  if (!a || !b) return not_a_number;
  double const x = a->quantity.si, y = b->quantity.si, scale = std::max(std::fabs(x), std::fabs(y));
  return x != y ? (x - y) / scale : r.or_equal ? 0 : least_excess;
}

}  // namespace straytrace::session
