// SPDX-License-Identifier: BSD-3-Clause
#include "scene/parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "scene/model_tree.hpp"
#include "scene/scene_document.hpp"
#include "scene/scope.hpp"

namespace straytrace::scene {
namespace {

// `limits` and `words` are about parameters of the part.
void check_limits(Node const& part) {
  Node const params = part["params"];
  for (char const* key : {"limits", "words"})
    for (auto const& [name, node] : part.table(key).items()) {
      if (!params.has(name))
        node.problem(fmt::format("'{}' is not a parameter of the part", name), "name one of its 'params'");
      if (node.kind() != Node::Kind::table || std::string_view(key) == "words") continue;
      for (char const* known : {"above", "at_least", "at_most", "because"}) node.has(known);
      node.refuse_unknown(fmt::format("the limits of '{}'", name));
    }
}

}  // namespace

bool is_entry_key(std::string_view key) { return std::ranges::find(entry_keys, key) != entry_keys.end(); }

bool name_allowed(Node const& at, std::string const& name) {
  bool const bad =
      name.empty() || std::ranges::any_of(name, [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || std::string_view("/*[]>\"'").find(c) != std::string_view::npos;
      });
  if (bad)
    at.problem(fmt::format("'{}' is not a valid name", shortened(name)), "remove the characters / * [ ] > and quotes");
  return !bad;
}

void check_parts(SceneDocument& document, Node const& parts) {
  for (auto const& [name, part] : parts.items()) {
    if (part.kind() != Node::Kind::table) {
      if (part)
        part.problem(fmt::format("part '{}' needs a table with 'faces'", name),
                     "write '{faces: {front: {shape: ...}}}'");
      continue;
    }
    bool const named = name_allowed(part, name);
    Node const faces = part.table("faces"), params = part.table("params");
    if (named && !part.has("faces"))
      part.problem(fmt::format("part '{}' has no faces", name),
                   "add 'faces: {front: {shape: {disk: {outer_radius: 10 cm}}}}'");
    else if (faces.kind() == Node::Kind::table && faces.items().empty())
      faces.problem(fmt::format("part '{}' has no faces", name), "add 'front: {shape: ...}'");
    for (auto const& [face, data] : faces.items()) {
      if (!name_allowed(data, face)) continue;
      if (data.kind() != Node::Kind::table && data)
        data.problem(fmt::format("face '{}' needs a table of keys", face), "write '{shape: {...}, material: ...}'");
    }
    if (params.kind() == Node::Kind::table)
      for (NodeData::Entry const& p : params.data()->entries)
        if (is_entry_key(p.key))
          document.add({p.place,
                        fmt::format("'{}' is a key of every scene entry and cannot name a parameter of a part", p.key),
                        "choose another name", Severity::error, p.width});
    check_limits(part);
    for (char const* known : {"note", "source", "medium"}) part.has(known);
    part.refuse_unknown(fmt::format("part '{}'", name));
  }
}

std::size_t FaceCounter::count(Node const& use, std::size_t limit) {
  std::string const& name = use.text();
  if (auto const hit = done_.find(name); hit != done_.end()) return hit->second;
  bool const circle = std::ranges::find(chain_, name) != chain_.end();
  if (circle || chain_.size() >= deepest_part) {
    use.problem(circle ? fmt::format("part '{}' contains itself", name)
                       : fmt::format("parts are nested more than {} deep", deepest_part),
                "use another part here");
    return 0;
  }
  Node const faces = parts_[name]["faces"];
  if (faces.kind() != Node::Kind::table) return 1;  // reported where it is written or used
  chain_.push_back(name);
  std::size_t sum = 0;
  bool sound = true;
  for (auto const& [face, data] : faces.items()) {
    Node const inner = data.kind() == Node::Kind::table ? data["use"] : Node();
    std::size_t const n = inner ? count(inner, limit) : 1;
    sound = sound && n > 0;
    sum = std::min(limit + 1, sum + n);
  }
  chain_.pop_back();
  return done_[name] = sound ? sum : 0;
}

namespace {

constexpr double rounding = 1e-12;  // relative: a lens may be exactly as wide as its sphere

struct Rule {
  std::string_view key, in_words;
  int sign;  // +1: the value is not below the bound
};
constexpr std::array rules{Rule{"above", "more than", 1}, Rule{"at_least", "at least", 1},
                           Rule{"at_most", "at most", -1}};

bool keeps(Rule const& rule, double value, double bound) {
  double const over = rule.sign * (value - bound);
  return rule.key == "above" ? over > 0 : over >= -rounding * std::fabs(bound);
}

// In a common unit, with four digits, rounded so that the printed value is allowed.
std::string readable(double si, Dimension d, int sign) {
  double const unit = d == dim::length && std::fabs(si) < 1 ? 1e-3 : d == dim::angle ? pi / 180 : 1;
  double const x = si / unit;
  double const step = x == 0 ? 1 : std::pow(10, std::floor(std::log10(std::fabs(x))) - 3);
  std::string const number = fmt::format("{:.6g}", x == 0 ? 0 : sign * std::ceil(sign * x / step - 1e-9) * step);
  return unit == 1e-3 ? number + " mm" : with_unit(number, d);
}

}  // namespace

bool within_limits(Node const& entry, std::string const& name, Node const& part,
                   std::shared_ptr<Scope const> const& scope) {
  Node const limits = part["limits"];
  if (limits.kind() != Node::Kind::table) return true;
  for (auto const& [parameter, limit] : limits.items()) {
    auto const value = find_parameter(scope.get(), parameter).value;
    if (!value || limit.kind() != Node::Kind::table) continue;  // reported already
    for (Rule const& rule : rules) {
      if (!limit.has(rule.key)) continue;
      Node const written = limit[rule.key];
      Quantity const bound = Node(written.data(), scope, limit.document()).as_quantity();
      double const is = value->quantity.si;
      if (!std::isfinite(bound.si) || keeps(rule, is, bound.si)) continue;
      Node const given = entry[parameter];
      std::string const least = readable(bound.si, bound.dimension, rule.sign);
      (given ? given : entry)
          .problem(fmt::format("'{}' of '{}' must be {} {} here, it is {}", parameter, name, rule.in_words, least,
                               readable(is, bound.dimension, 1)),
                   limit.word("because", "change it or the other parameters of the part"));
      return false;
    }
  }
  return true;
}

namespace {

constexpr std::size_t most_includes = 1000, deepest_include = 50;

enum class Section { text, named, list, single };
struct TopKey {
  std::string_view name, noun;
  Section kind;
};
constexpr std::array top_keys{
    TopKey{"title", "title", Section::text},
    TopKey{"notes", "notes", Section::text},
    TopKey{"params", "parameter", Section::named},
    TopKey{"set", "value", Section::named},
    TopKey{"materials", "material", Section::named},
    TopKey{"media", "medium", Section::named},
    TopKey{"bodies", "body", Section::named},
    TopKey{"parts", "part", Section::named},
    TopKey{"scene", "scene", Section::list},
    TopKey{"beams", "beam", Section::named},
    TopKey{"ports", "port", Section::named},
    TopKey{"receivers", "receiver", Section::named},
    TopKey{"sensors", "sensor", Section::named},
    TopKey{"edges", "", Section::single},
    TopKey{"wave", "", Section::single},
    TopKey{"ghosts", "", Section::single},
    TopKey{"rims", "", Section::single},
    TopKey{"interferometer", "", Section::single},
    TopKey{"trace", "", Section::single},
    TopKey{"noise", "", Section::single},
    TopKey{"scan", "", Section::single},
    TopKey{"optimise", "", Section::single},
    TopKey{"report", "", Section::single},
};

// The BSDF models of both, as one list.
std::shared_ptr<NodeData> joined(std::shared_ptr<NodeData> const& first, std::shared_ptr<NodeData> const& second) {
  auto all = std::make_shared<NodeData>(*second);
  all->kind = Node::Kind::list;
  all->entries.clear();
  all->index.clear();
  all->elements.clear();
  for (auto const& laws : {first, second}) {
    if (laws->kind == Node::Kind::list)
      all->elements.insert(all->elements.end(), laws->elements.begin(), laws->elements.end());
    else
      all->elements.push_back(laws);
  }
  return all;
}

void take_over(NodeData const& from, NodeData& into) {
  for (NodeData::Entry const& e : from.entries) {
    if (e.key == "override") continue;
    auto const own = into.index.find(e.key);
    if (own == into.index.end())
      into.add(e);
    else if (e.key == "scatter")
      into.entries[own->second].value = joined(e.value, into.entries[own->second].value);
  }
}

// `like: NAME` in a material: everything of another material that is not stated here; BSDF models stated here are
// added.
void take_over_materials(SceneDocument& document, NodeData& model) {
  NodeData::Entry const* section = model.find("materials");
  if (!section || section->value->kind != Node::Kind::table) return;
  NodeData const& materials = *section->value;
  for (NodeData::Entry const& e : materials.entries) {
    NodeData::Entry const* like = e.value->kind == Node::Kind::table ? e.value->find("like") : nullptr;
    if (!like) continue;
    like->value->known = true;
    NodeData::Entry const* from = materials.find(like->value->text);
    if (from && from->value->kind == Node::Kind::table && !from->value->find("like")) {
      take_over(*from->value, *e.value);
      continue;
    }
    std::vector<std::string> names;
    for (NodeData::Entry const& m : materials.entries)
      if (m.value->kind == Node::Kind::table && !m.value->find("like")) names.push_back(m.key);
    Node(like->value, nullptr, &document)
        .problem(fmt::format("'like' cannot copy material '{}'", shortened(like->value->text)),
                 did_you_mean(like->value->text, names, "name one of 'materials' that is not itself 'like' another"));
  }
}

class Merger {
 public:
  Merger(SceneDocument& document, std::vector<std::string> const& overrides)
      : document_(document), overrides_(overrides), model_(std::make_shared<NodeData>()) {
    model_->kind = Node::Kind::table;
  }

  std::shared_ptr<NodeData> run(std::string const& main_file) {
    std::uint32_t const main = document_.open_main(main_file);
    std::uint32_t const builtin =
        document_.add_source("built-in parts", std::string(embedded_file("library/parts/builtin.yaml")), false);
    if (auto const root = read_yaml(document_, builtin)) merge(*root);
    model_->place = {main, 1, 1};
    for (TopKey const& k : top_keys) model_->asked.try_emplace(std::string(k.name));
    read(main, 0);
    if (unreadable_) throw_errors(document_);
    take_over_materials(document_, *model_);
    set_values(document_, *model_, overrides_);
    drop_unused(document_, *model_);
    return model_;
  }

 private:
  Node node(std::shared_ptr<NodeData> const& data) const { return {data, nullptr, &document_}; }
  void problem(NodeData::Entry const& at, std::string what, std::string suggestion) {
    document_.add({at.place, std::move(what), std::move(suggestion), Severity::error, at.width});
  }
  // "line 5", or "line 5 of lib.yaml" when that is another file.
  std::string where(Place place, std::uint32_t seen_from) const {
    std::string const line = fmt::format("line {}", place.line);
    return place.file == seen_from ? line : fmt::format("{} of {}", line, document_.source(place.file).name);
  }

  void read(std::uint32_t file, std::size_t depth) {
    visiting_.push_back(file);
    if (auto const root = read_yaml(document_, file); root && version_read(*root, depth == 0)) {
      include(*root, depth);
      check_keys(*root);
      merge(*root);
    } else {
      unreadable_ = true;
    }
    visiting_.pop_back();
    done_.push_back(file);
  }

  // Whether the version is the one that this program reads; a file without one counts as such.
  bool version_read(NodeData const& root, bool main) {
    NodeData::Entry const* e = root.find("straytrace");
    if (!e) {
      if (main)
        document_.add({root.place, "the format version is missing",
                       fmt::format("begin the file with 'straytrace: {}'", format_version)});
      return true;
    }
    if (e != &root.entries.front())
      problem(*e, "'straytrace' must be the first key",
              fmt::format("move 'straytrace: {}' to the top", format_version));
    std::string const& text = e->value->text;
    bool const digits =
        !text.empty() && text.size() < 9 && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
    int const version = digits ? std::stoi(text) : 0;
    if (e->value->kind == Node::Kind::none || version == format_version) return true;
    if (version > format_version)
      node(e->value).problem(
          fmt::format("format version {} is newer than this program, which reads version {}", version, format_version),
          "install a newer straytrace");
    else
      node(e->value).problem(fmt::format("\"{}\" is not a format version", shortened(text)),
                             fmt::format("write 'straytrace: {}'", format_version));
    return false;
  }

  void include(NodeData const& root, std::size_t depth) {
    NodeData::Entry const* e = root.find("include");
    if (!e) return;
    for (Node const& name : node(e->value).as_list()) {
      if (name.kind() != Node::Kind::scalar) {
        if (name) name.problem("'include' takes file names", "write 'include: [materials.yaml, baffles.yaml]'");
        continue;
      }
      if (depth >= deepest_include || done_.size() >= most_includes) {
        name.problem("too many nested includes", "combine some of them");
        return;
      }
      auto const file = document_.open(name, name.text(), model_file_limit);
      if (!file)
        unreadable_ = true;
      else if (std::ranges::find(visiting_, *file) != visiting_.end())
        name.problem(fmt::format("'{}' includes itself{}", document_.source(*file).name,
                                 *file == visiting_.back() ? "" : " through other files"),
                     "remove this name");
      else if (std::ranges::find(done_, *file) == done_.end())
        read(*file, depth + 1);
    }
  }

  void check_keys(NodeData const& root) {
    std::vector<std::string> names{"straytrace", "include"};
    for (TopKey const& k : top_keys) names.emplace_back(k.name);
    for (NodeData::Entry const& e : root.entries) {
      if (document_.error_count() > 1000) return;  // hostile input: stop reporting
      if (std::ranges::find(names, e.key) != names.end()) continue;
      model_->misspelt = true;
      std::string all;
      for (std::string const& n : names) all += (all.empty() ? "" : ", ") + n;
      problem(e, fmt::format("unknown key '{}' at the top of a model", shortened(e.key)),
              did_you_mean(e.key, names, "known keys: " + all));
    }
  }

  void merge(NodeData const& root) {
    for (NodeData::Entry const& e : root.entries) {
      auto const key = std::ranges::find_if(top_keys, [&](TopKey const& k) { return k.name == e.key; });
      if (key == top_keys.end() || e.value->kind == Node::Kind::none) continue;
      if (key->kind == Section::named) merge_named(e, *key);
      if (key->kind == Section::list) merge_list(e);
      if (key->kind == Section::single) merge_single(e);
      if (key->kind == Section::text) replace(e);  // the including file has priority
    }
  }

  void replace(NodeData::Entry const& e) {
    auto const hit = model_->index.find(e.key);
    if (hit == model_->index.end())
      model_->add(e);
    else
      model_->entries[hit->second] = e;
  }

  // The table or list of the model that collects this section.
  NodeData& section(NodeData::Entry const& e, Node::Kind kind) {
    if (!model_->find(e.key)) {
      auto data = std::make_shared<NodeData>();
      data->kind = kind;
      data->label = e.key;
      model_->add({e.key, e.place, e.width, std::move(data)});
    }
    auto& entry = model_->entries[model_->index.find(e.key)->second];
    entry.place = e.place;
    entry.value->place = e.value->place;
    return *entry.value;
  }

  // `override: true` in a definition or, for all of them, in the section.
  bool overrides(NodeData const& data) {
    if (!data.find("override")) return false;
    auto const copy = std::make_shared<NodeData>(data);
    return Node(copy, nullptr, &document_).flag("override", false);
  }

  void merge_named(NodeData::Entry const& e, TopKey const& key) {
    if (e.value->kind != Node::Kind::table) {
      node(e.value).problem(fmt::format("'{}' needs a table of names", e.key),
                            fmt::format("write '{}: {{name: ...}}'", e.key));
      return;
    }
    NodeData& into = section(e, Node::Kind::table);
    bool const all = overrides(*e.value);
    for (NodeData::Entry const& d : e.value->entries) {
      if (d.key == "override") continue;
      bool const one = d.value->kind == Node::Kind::table && overrides(*d.value);
      if (one) d.value->find("override")->value->known = true;
      auto const hit = into.index.find(d.key);
      if (hit == into.index.end()) {
        if (one || all) refuse_idle_override(d, key, into);
        into.add(d);
        continue;
      }
      NodeData::Entry& earlier = into.entries[hit->second];
      if (!one && !all)
        problem(d, fmt::format("{} '{}' is already defined ({})", key.noun, d.key, where(earlier.place, d.place.file)),
                d.value->kind == Node::Kind::table
                    ? "choose another name, or add 'override: true' to replace it"
                    : fmt::format("choose another name, or add 'override: true' to '{}' to replace it", e.key));
      earlier = d;
    }
  }

  void refuse_idle_override(NodeData::Entry const& d, TopKey const& key, NodeData const& into) {
    std::vector<std::string> names;
    for (NodeData::Entry const& known : into.entries) names.push_back(known.key);
    problem(d, fmt::format("'override: true' but no earlier {} '{}'", key.noun, d.key),
            did_you_mean(d.key, names, "remove 'override: true', or include the file that defines it"));
  }

  void merge_list(NodeData::Entry const& e) {
    NodeData& into = section(e, Node::Kind::list);
    for (Node const& element : node(e.value).as_list()) into.elements.push_back(element.data());
  }

  void merge_single(NodeData::Entry const& e) {
    bool const replaces = e.value->kind == Node::Kind::table && overrides(*e.value);
    if (replaces) e.value->find("override")->value->known = true;
    NodeData::Entry const* earlier = model_->find(e.key);
    if (earlier && !replaces)
      problem(e, fmt::format("'{}' is already defined ({})", e.key, where(earlier->place, e.place.file)),
              "keep one of them, or add 'override: true' to replace the earlier one");
    if (!earlier && replaces)
      problem(e, fmt::format("'override: true' but no earlier '{}'", e.key), "remove 'override: true'");
    replace(e);
  }

  SceneDocument& document_;
  std::vector<std::string> const& overrides_;
  std::shared_ptr<NodeData> model_;
  std::vector<std::uint32_t> visiting_, done_;
  bool unreadable_ = false;
};

}  // namespace

std::shared_ptr<NodeData> read_model(SceneDocument& document, std::string const& main_file,
                                     std::vector<std::string> const& overrides) {
  return Merger(document, overrides).run(main_file);
}

}  // namespace straytrace::scene
