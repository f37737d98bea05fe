// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/units/media_presets.hpp"
#include "io/delimited_text.hpp"
#include "scene/parts.hpp"
#include "scene/scope.hpp"

namespace straytrace::scene {
namespace {

// `repeat`: positions of the instances of an entry and the parameters of each (docs/reference/scene.md).

// A column of a table besides the position: sets the parameter of that name.
struct RepeatColumn {
  std::string name;
  Dimension dimension;
  std::uint32_t line = 0, column = 0;  // of its header
};

struct Repeat {
  int axis = -1;                   // 0, 1, 2 = x, y, z; -1: not repeated
  std::vector<double> offsets{0};  // m along the axis, one per instance; empty when the input is wrong
  std::vector<RepeatColumn> columns{};
  std::vector<std::vector<Value>> rows{};  // one value per column, one row per instance
  std::vector<std::uint32_t> lines{};      // of the rows, in this table
  std::string table{};
};

constexpr std::size_t most_instances = 1000000;

int read_axis(Node const& repeat) {
  std::string const axis = repeat.choice("along", axes);
  auto const hit = std::ranges::find(axes, axis);
  return hit == axes.end() ? -1 : static_cast<int>(hit - axes.begin());
}

std::vector<double> by_pitch(Node const& repeat, std::size_t count) {
  double const from = repeat.number("from", dim::length, 0), pitch = repeat.number("pitch", dim::length);
  if (pitch <= 0) {
    repeat["pitch"].problem("'pitch' must be positive", "write the distance of neighbours, for example '5 m'");
    return {};
  }
  if (std::isnan(from) || std::isnan(pitch)) return {};
  std::vector<double> offsets(count);
  for (std::size_t i = 0; i < count; ++i) offsets[i] = from + static_cast<double>(i) * pitch;
  return offsets;
}

std::vector<double> by_ends(Node const& repeat, std::size_t count) {
  double const from = repeat.number("from", dim::length), to = repeat.number("to", dim::length);
  if (from > to) {
    repeat["to"].problem("'to' lies before 'from'", "write the smaller position as 'from'");
    return {};
  }
  if (count == 1 && from < to) {
    repeat["count"].problem("a single instance cannot be at both 'from' and 'to'",
                            "write 'count: 2' or more, or use 'at' instead of 'repeat'");
    return {};
  }
  if (std::isnan(from) || std::isnan(to)) return {};
  std::vector<double> offsets(count, from);
  for (std::size_t i = 1; i < count; ++i)
    offsets[i] = i + 1 == count ? to : from + (to - from) * (static_cast<double>(i) / static_cast<double>(count - 1));
  return offsets;
}

// `count`, or the number for which the shadow of the last one reaches `to` (the second form of eq. 8.16).
std::size_t shadow_count(Node const& repeat, double origin, double from, double ratio) {
  if (!repeat.has("to")) return repeat.whole("count", required, 1, most_instances);
  if (repeat.has("count")) {
    repeat["count"].problem("'count' and 'to' both set the number of instances", "keep one of them");
    return 0;
  }
  double const to = repeat.number("to", dim::length);
  if (std::isnan(origin + from + to + ratio)) return 0;
  double const steps = std::log((to - origin) / (from - origin)) / std::log(ratio);
  if (steps > 0 && steps <= most_instances) return std::size_t(std::ceil(steps * (1 - 1e-12)));
  repeat["to"].problem("no progression with this ratio reaches 'to' from 'from'",
                       "write a 'to' beyond 'from' as seen from 'origin', and a ratio above 1; or 'count' instead");
  return 0;
}

// Distances from `origin` in geometric progression: the shadow rule of baffles (docs/theory/arm.md, eq. 8.16).
std::vector<double> by_ratio(Node const& repeat) {
  double const origin = repeat.number("origin", dim::length, 0), from = repeat.number("from", dim::length);
  double const ratio = repeat.number("ratio", dim::plain, required, 1e-3, 1e3);
  for (char const* key : {"count", "to"}) repeat.has(key);
  if (from == origin) {
    repeat["from"].problem("the progression starts at its own origin", "write another position as 'from'");
    return {};
  }
  std::size_t const count = shadow_count(repeat, origin, from, ratio);
  if (std::isnan(origin) || std::isnan(from) || std::isnan(ratio)) return {};
  std::vector<double> offsets(count);
  for (std::size_t i = 0; i < count; ++i)
    offsets[i] = origin + (from - origin) * std::pow(ratio, static_cast<double>(i));
  return offsets;
}

std::vector<double> by_list(Node const& repeat) {
  std::vector<Node> const positions = repeat.list("at");
  if (positions.empty() || positions.size() > most_instances) {
    repeat["at"].problem("'at' needs between 1 and 1000000 positions", "write for example 'at: [50 m, 75 m, 120 m]'");
    return {};
  }
  if (refuse_decimal_commas(positions, dim::length, false)) return {};
  std::vector<double> offsets;
  for (Node const& p : positions) offsets.push_back(p.as_number(dim::length));
  bool const bad = std::ranges::any_of(offsets, [](double z) { return std::isnan(z); });
  return bad ? std::vector<double>{} : offsets;
}

// Checks the columns of a table of positions and values.
class OffsetTable {
 public:
  explicit OffsetTable(Node const& name) : name_(name) {}

  Repeat read() {
    repeat_.offsets.clear();
    if (name_.kind() != Node::Kind::scalar) {
      if (name_) name_.problem("'table' takes the name of a file", "write 'table: baffles.csv'");
      return repeat_;
    }
    repeat_.table = name_.text();
    CsvTable const table = read_csv_table(name_, name_.text(), Comments::whole_lines, "z [m], aperture [cm]");
    for (CsvTable::Column const& column : table.columns)
      if (!add_column(column)) return repeat_;
    if (repeat_.axis < 0 && !table.columns.empty())
      return refuse(table.columns[0].line, 1, "no position column", "name one column 'x [m]', 'y [m]' or 'z [m]'");
    if (table.rows.size() > most_instances)
      return refuse(table.rows[most_instances].line(), 1, fmt::format("more than {} rows", most_instances),
                    "split the table");
    for (CsvTable::Row const& row : table.rows) add_row(row, table.columns);
    return repeat_;
  }

 private:
  Repeat refuse(std::uint32_t line, std::uint32_t column, std::string what, std::string suggestion) {
    name_.file_problem(name_.text(), line, column, std::move(what), std::move(suggestion));
    repeat_.offsets.clear();
    return repeat_;
  }

  bool add_column(CsvTable::Column const& column) {
    std::size_t const axis = std::string_view("xyz").find(column.name);
    bool const position = column.name.size() == 1 && axis != std::string_view::npos;
    if (position && repeat_.axis >= 0) {
      refuse(column.line, column.at, "a second position column", "keep one of x, y, z; instances lie along one axis");
      return false;
    }
    if (position && column.unit.dimension != dim::length) {
      refuse(column.line, column.at, wrong_unit(column, dim::length), fmt::format("write '{} [m]'", column.name));
      return false;
    }
    if (position)
      repeat_.axis = static_cast<int>(axis);
    else
      repeat_.columns.push_back({column.name, column.unit.dimension, column.line, column.at});
    is_position_.push_back(position);
    return true;
  }

  void add_row(CsvTable::Row const& row, std::vector<CsvTable::Column> const& columns) {
    std::vector<Value> values;
    for (std::size_t i = 0; i < row.values.size(); ++i)
      if (is_position_[i])
        repeat_.offsets.push_back(row.values[i]);
      else
        values.push_back({{row.values[i], columns[i].unit.dimension, {}}, false});
    repeat_.rows.push_back(std::move(values));
    repeat_.lines.push_back(row.line());
  }

  Node name_;
  Repeat repeat_;
  std::vector<bool> is_position_;
};

// `entry` holds `repeat` or not.
Repeat read_repeat(Node const& entry) {
  Node const repeat = entry.table("repeat");
  if (!entry.has("repeat")) return {};
  Repeat result;
  result.offsets.clear();
  if (!repeat) return result;
  if (repeat.has("table")) {
    result = OffsetTable(repeat["table"]).read();
  } else {
    result.axis = read_axis(repeat);
    if (repeat.has("at")) {
      result.offsets = by_list(repeat);
    } else if (repeat.has("ratio")) {
      result.offsets = by_ratio(repeat);
    } else {
      std::size_t const count = repeat.whole("count", required, 1, most_instances);
      result.offsets = repeat.has("pitch") ? by_pitch(repeat, count) : by_ends(repeat, count);
    }
    if (result.axis < 0) result.offsets.clear();
  }
  repeat.refuse_unknown("this form of 'repeat'");
  return result;
}

bool holds_position(Node const& n) {
  bool const at = n.has("at"), facing = n.has("facing"), rotate = n.has("rotate");
  return at || facing || rotate;
}

constexpr double usual_wavelength = 1.064e-6;  // m, of beams that state none

// Data shared by the instances of one entry while its parts are expanded.
struct Unfolding {
  std::string group, name;   // so far: "bench/dump" and "bench[2]/dump"
  Node placement;            // tables that provide body, material, side and medium
  Node usual_medium;         // of the part whose faces are unfolded
  std::vector<Node> frames;  // outermost first
  double offset = 0;
  int axis = -1;
  bool refused = false;
};

class Expander {
 public:
  Expander(SceneDocument& document, Node root) : document_(document), root_(std::move(root)), faces_(root_["parts"]) {}

  std::vector<Scene::Instance> run() {
    check_parts(document_, root_["parts"]);
    for (Node const& entry : root_.list("scene")) {
      if (entry.kind() == Node::Kind::table)
        expand_entry(entry);
      else if (entry)
        entry.problem("an entry of 'scene' is a table of keys", "write '- {name: ITM, use: mirror, ...}'");
    }
    return std::move(out_);
  }

 private:
  void expand_entry(Node const& entry) {
    std::string const written = entry.word("name");
    ProblemRedirect const here(document_, blame_at(entry, written));
    bool const split = entry.flag("split", false);
    bool const sound = check_what(entry, written.empty() ? "an entry" : fmt::format("entry '{}'", shortened(written)));
    Repeat const repeat = read_repeat(entry);
    std::string const name = name_of(entry, written);
    if (!sound) return refuse(entry, name);
    Node const part = entry.has("use") ? find_part(entry["use"]) : Node();
    if (entry.has("use") && !part) return refuse(entry, name);
    std::size_t const faces = part ? faces_.count(entry["use"], most_instances) : 1;
    if (faces == 0) return;
    if (faces * repeat.offsets.size() > most_instances - out_.size()) return refuse_total(entry);
    GivenParameters given = given_by(entry, part);
    add_index(given, part, entry);
    if (!check_columns(entry, part, repeat)) return;
    std::shared_ptr<Scope const> scope = part ? part_scope(part, given) : nullptr;
    bool sizes = !part || !repeat.columns.empty() || within_limits(entry, name, part, scope);
    for (std::size_t i = 0; i < repeat.offsets.size(); ++i) {
      std::string const instance = repeat.axis < 0 ? name : fmt::format("{}[{}]", name, i);
      Unfolding u{split ? instance : name, instance, entry, {}, {}, repeat.offsets[i], repeat.axis};
      if (holds_position(entry)) u.frames.push_back(entry);
      if (!part) {
        emit(u, entry);
        continue;
      }
      if (!repeat.columns.empty()) {
        std::string const from = fmt::format("line {} of {}", repeat.lines[i], repeat.table);
        for (std::size_t c = 0; c < repeat.columns.size(); ++c)
          given[repeat.columns[c].name] = {repeat.rows[i][c], nullptr, from};
        scope = part_scope(part, given);
        sizes = within_limits(entry, instance, part, scope);
      }
      u.refused = !sizes;
      unfold(part, scope, u);
      if (!sizes) return;  // the others fail alike
    }
  }

  // An entry or a face has exactly one of use, shape, file.
  bool check_what(Node const& n, std::string const& called) {
    int const kinds = n.has("use") + n.has("shape") + n.has("file");
    if (kinds == 1) return true;
    if (kinds > 1) n.problem(fmt::format("{} has more than one of 'use', 'shape', 'file'", called), "keep one of them");
    for (char const* key : {"use", "shape", "file"})  // one problem, whichever of them is misspelt
      if (kinds == 0)
        n.lack(key, fmt::format("{} has neither 'use' nor 'shape' nor 'file'", called),
               "add 'use: part' or 'shape: {disk: {outer_radius: 10 cm}}'");
    return false;
  }

  // For messages, and for those who use the entry; one by its line where its own name is missing, wrong or taken.
  std::string name_of(Node const& entry, std::string const& written) {
    std::string const line = fmt::format("line {}", entry.place().line);
    if (!entry["name"] || !name_allowed(entry["name"], written)) return line;
    return register_name(entry, written) ? written : fmt::format("{} ({})", written, line);
  }

  // The names in it are checked all the same.
  void refuse(Node const& entry, std::string const& name) { emit({name, name, entry, {}, {}, 0, -1, true}, entry); }

  bool register_name(Node const& entry, std::string const& name) {
    auto const [hit, fresh] = lines_.emplace(name, entry["name"].place());
    if (fresh) return true;
    Place const first = hit->second;
    std::string const file = first.file == entry.place().file ? "" : " of " + document_.source(first.file).name;
    entry["name"].problem(fmt::format("name '{}' is used twice in 'scene'", shortened(name)),
                          fmt::format("choose another name; the first is in line {}{}", first.line, file));
    return false;
  }

  void refuse_total(Node const& entry) {
    entry.problem(fmt::format("the scene has more than {} instances", most_instances),
                  "repeat less, or describe the row by one larger shape");
  }

  Node find_part(Node const& use) {
    std::string const name = use.as_word();
    Node const parts = root_["parts"], part = parts[name];
    if (part.kind() == Node::Kind::table) return part;
    if (use.kind() != Node::Kind::scalar || part.data()) return {};  // reported already
    std::vector<std::string> names;
    for (auto const& [known, data] : parts.items()) names.push_back(known);
    use.problem(
        fmt::format("part '{}' is not defined", shortened(name)),
        did_you_mean(
            name, names,
            fmt::format("define it under 'parts', add 'include: [library/parts.yaml]' if it is from the library, or "
                        "use one of: {}",
                        shortened(fmt::format("{}", fmt::join(names, ", "))))));
    return {};
  }

  // Parameters of the part that the entry sets; evaluated in the scope of the entry.
  GivenParameters given_by(Node const& entry, Node const& part) {
    GivenParameters given;
    Node const params = part ? part.table("params") : Node();
    if (params.kind() != Node::Kind::table) return given;
    for (NodeData::Entry const& p : params.data()->entries) {
      if (is_entry_key(p.key) || !entry.has(p.key)) continue;
      Node const value = entry[p.key];
      std::optional<Value> v;
      if (value.kind() == Node::Kind::scalar)
        v = said_by_word(value, part["words"][p.key], entry.document());
      else if (value)
        value.problem(fmt::format("parameter '{}' must be one quantity", p.key), "write a number with a unit");
      given[p.key] = {v, value.data().get(), fmt::format("line {}", value.place().line)};
    }
    return given;
  }

  // The parameter `index` of a part is that of its glass, unless the entry sets it. Other mistakes in media are
  // reported where these are read.
  void add_index(GivenParameters& given, Node const& part, Node const& placement) {
    Node const params = part ? part.table("params") : Node();
    if (params.kind() != Node::Kind::table || !params.data()->find("index") || given.contains("index")) return;
    NodeData::Entry const* const own = placement.data()->find("medium");
    NodeData::Entry const* const usual = part.data()->find("medium");
    NodeData::Entry const* const medium = own ? own : usual;
    std::optional<double> const index = medium ? index_of_medium(medium->value->text) : std::nullopt;
    if (index) given["index"] = {Value{{*index, dim::plain, {}}}, nullptr, ""};
  }

  std::optional<double> index_of_medium(std::string name) {
    Node const media = root_["media"];
    NodeData::Entry const* const own = media.kind() == Node::Kind::table ? media.data()->find(name) : nullptr;
    if (NodeData::Entry const* const said = own ? own->value->find("index") : nullptr) {
      auto const value = document_.evaluate(*said->value, root_.scope().get());
      return value ? std::optional(value->quantity.si) : std::nullopt;
    }
    if (NodeData::Entry const* const preset = own ? own->value->find("preset") : nullptr) name = preset->value->text;
    for (MediumPreset const& p : medium_presets())
      if (p.name == name) return index_of(p, wavelength());
    return {};
  }

  // Of the beams, in vacuum, m: one for all.
  double wavelength() {
    Node const beams = root_["beams"];
    if (beams.kind() != Node::Kind::table || beams.data()->entries.empty()) return usual_wavelength;
    NodeData::Entry const* const said = beams.data()->entries.front().value->find("wavelength");
    auto const value = said ? document_.evaluate(*said->value, root_.scope().get()) : std::nullopt;
    return value ? value->quantity.si : usual_wavelength;
  }

  // `hand: left` where the part has words for the parameter, otherwise the quantity as written.
  std::optional<Value> said_by_word(Node const& value, Node const& words, Document* document) {
    if (words.kind() != Node::Kind::table) return document->evaluate(*value.data(), value.scope().get());
    if (NodeData::Entry const* word = words.data()->find(value.text()))
      return document_.evaluate(*word->value, static_cast<Scope const*>(nullptr));
    std::string known;
    for (NodeData::Entry const& e : words.data()->entries) known += (known.empty() ? "" : " or ") + e.key;
    value.problem(fmt::format("'{}' is {}, got \"{}\"", value.data()->label, known, shortened(value.text())),
                  fmt::format("write '{}: {}'", value.data()->label, words.data()->entries.front().key));
    return {};
  }

  // Columns of a table name parameters of the part and agree with their dimensions.
  bool check_columns(Node const& entry, Node const& part, Repeat const& repeat) {
    if (repeat.columns.empty()) return true;
    Node const table = entry["repeat"]["table"];
    std::vector<std::string> names;
    if (Node const params = part.table("params"); params.kind() == Node::Kind::table)
      for (NodeData::Entry const& p : params.data()->entries) names.push_back(p.key);
    auto const defaults = part_scope(part, {});
    bool good = true;
    auto const refuse = [&](RepeatColumn const& c, std::string what, std::string suggestion) {
      table.file_problem(table.text(), c.line, c.column, std::move(what), std::move(suggestion));
      good = false;
    };
    for (RepeatColumn const& c : repeat.columns) {
      if (std::ranges::find(names, c.name) == names.end()) {
        refuse(c,
               fmt::format("column '{}' is neither a position (x, y, z) nor a parameter of the repeated part",
                           shortened(c.name)),
               did_you_mean(c.name, names, "name the columns after parameters of the part"));
        continue;
      }
      auto const value = find_parameter(defaults.get(), c.name).value;
      if (!value || value->bare_zero || value->quantity.dimension == c.dimension) continue;
      Dimension const wanted = value->quantity.dimension;
      refuse(c, fmt::format("column '{}' is {}, its unit is {}", c.name, described(wanted), described(c.dimension)),
             fmt::format("write '{} [{}]'", c.name, example_unit(wanted)));
    }
    return good;
  }

  // Parts are written at the top of the model, so their defaults see the parameters of the model.
  std::shared_ptr<Scope const> part_scope(Node const& part, GivenParameters const& given) {
    Node const params = part.table("params");
    bool const table = params.kind() == Node::Kind::table;
    return make_scope(document_, table ? params.data().get() : nullptr, root_.scope(), given);
  }

  void unfold(Node const& part, std::shared_ptr<Scope const> const& scope, Unfolding const& u) {
    Node const faces = part.table("faces");
    if (faces.kind() != Node::Kind::table) return;
    bool const single = faces.data()->entries.size() == 1;
    for (NodeData::Entry const& e : faces.data()->entries) {
      if (e.value->kind != Node::Kind::table) continue;
      Unfolding inner = u;
      inner.usual_medium = part["medium"];
      if (!single) {
        inner.group += "/" + e.key;
        inner.name += "/" + e.key;
      }
      Node const face(e.value, scope, seen_from(e.value->place, inner.group));
      if (!check_what(face, fmt::format("face '{}'", e.key))) continue;
      if (holds_position(face)) inner.frames.push_back(face);
      if (face.has("use"))
        unfold_inner(face, inner);
      else
        emit(inner, face);
    }
  }

  // A face that is itself a part, placed in the frame of its parent.
  void unfold_inner(Node const& face, Unfolding u) {
    Node const part = find_part(face["use"]);
    if (!part) return;
    for (char const* key : {"repeat", "split"})
      if (face.has(key))
        face[key].problem(fmt::format("'{}' inside a part is not supported", key),
                          "repeat the whole part in 'scene', or write one face per position");
    u.placement = placed_in(u.placement, face);
    GivenParameters given = given_by(face, part);
    add_index(given, part, u.placement);
    auto const scope = part_scope(part, given);
    u.refused = u.refused || !within_limits(face, u.group, part, scope);
    face.refuse_unknown(fmt::format("a face that uses part '{}'", face["use"].text()));
    unfold(part, scope, u);
  }

  // The outer placement, with body, material, side and medium replaced by those of the inner one.
  Node placed_in(Node const& outer, Node const& inner) {
    auto merged = std::make_shared<NodeData>(*outer.data());
    bool changed = false;
    for (char const* key : {"body", "material", "side", "medium"}) {
      if (!inner.has(key)) continue;
      changed = true;
      NodeData::Entry const entry = *inner.data()->find(key);
      if (!merged->add(entry)) merged->entries[merged->index.find(key)->second] = entry;
    }
    return changed ? Node(std::move(merged), outer.scope(), &document_) : outer;
  }

  Blame blame_at(Node const& entry, std::string name) const {
    return {builtin_source(root_.place().file), entry.place(), entry.data()->width, std::move(name), entry.data()};
  }

  // The document for a face: of a built-in part, one that reports at the entry being unfolded.
  Document* seen_from(Place face, std::string const& group) {
    if (!document_.blame || face.file != document_.blame->hidden) return &document_;
    Document*& view = views_[group];
    if (!view) {
      Blame blame = *document_.blame;
      blame.name = group;
      view = document_.keep(std::make_unique<InPart>(document_, std::move(blame)));
    }
    return view;
  }

  void emit(Unfolding const& u, Node const& node) {
    out_.push_back({u.group, u.name, node, u.placement, u.usual_medium, u.frames, u.offset, u.axis, u.refused});
  }

  SceneDocument& document_;
  Node root_;
  FaceCounter faces_;
  std::vector<Scene::Instance> out_;
  std::map<std::string, Document*> views_;  // of faces of built-in parts, by group
  std::map<std::string, Place> lines_;      // names and where they are written
};

}  // namespace

std::vector<Scene::Instance> expand_scene(SceneDocument& document, Node const& root) {
  return Expander(document, root).run();
}

}  // namespace straytrace::scene
