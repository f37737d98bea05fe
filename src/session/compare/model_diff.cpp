// SPDX-License-Identifier: BSD-3-Clause
#include "session/compare/model_diff.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/files/read_write.hpp"
#include "base/math/constants.hpp"
#include "noise/fundamental/budget.hpp"
#include "results/results.hpp"
#include "results/text/table.hpp"

namespace straytrace::session {
namespace {

constexpr std::array<std::string_view, 16> sections{"materials",      "media",   "scene", "bodies", "beams",  "ports",
                                                    "receivers",      "sensors", "edges", "wave",   "ghosts", "rims",
                                                    "interferometer", "noise",   "trace", "report"};
constexpr double rounding = 1e-12;  // relative: 84 cm and 0.84 m

struct Leaf {
  std::string text;
  std::optional<Quantity> quantity;
  bool is_default = false;
  std::string printed() const { return is_default ? text + " (default)" : text; }
};
using Leaves = std::map<std::string, Leaf>;

// Peak to peak is twice the peak.
Quantity comparable(Quantity q) {
  if (q.amplitude == Amplitude::peak_to_peak) return {q.si / 2, q.dimension, Amplitude::peak};
  return q;
}

bool same(Leaf const& a, Leaf const& b) {
  if (!a.quantity || !b.quantity) return a.text == b.text;
  Quantity const p = comparable(*a.quantity), q = comparable(*b.quantity);
  bool const kind = p.dimension == q.dimension && p.amplitude == q.amplitude;
  return kind && (p.si == q.si || std::fabs(p.si - q.si) <= rounding * std::max(std::fabs(p.si), std::fabs(q.si)));
}

class Flattener {
 public:
  explicit Flattener(Scene const& scene) : files_(scene.files()) {}

  void add(ModelValue const& v, std::string const& named, Leaves& into) const {
    std::string const path = one_of_list(v) ? named + "[0]" : named;
    // Sources of numbers; `like` is already resolved.
    bool const remark = v.key == "source" || v.key == "note" || v.key == "status" || v.key == "override";
    if (remark || (v.key == "like" && v.how.form != KeyRequest::Form::choice)) return;  // of a motion it is a choice
    if (v.kind == Node::Kind::none || v.kind == Node::Kind::scalar) {
      if (!v.value.empty()) into[path] = leaf(v);
      return;
    }
    for (std::size_t i = 0; i < v.children.size(); ++i) {
      ModelValue const& c = v.children[i];
      if (v.kind == Node::Kind::list)
        add(c, fmt::format("{}[{}]", path, i), into);
      else
        add(c, path.empty() ? c.key : path + "." + c.key, into);
    }
    if (v.children.empty() && !path.empty()) into[path] = {"{}", {}, false};
  }

 private:
  // A single value counts as a list of one.
  static bool one_of_list(ModelValue const& v) {
    return v.kind != Node::Kind::list && v.given() && v.by_key && v.how.form == KeyRequest::Form::list;
  }

  Leaf leaf(ModelValue const& v) const {
    auto const folder =
        v.origin.substr(0, v.origin.rfind('/') + 1);  // names are relative to the file that contains them
    for (std::string const& name : {v.value, folder + v.value})
      if (auto const hit = files_.find(name); v.given() && hit != files_.end())
        return {fmt::format("{} (content {:.8})", v.value, sha256(hit->second)), {}, false};
    return {v.value, v.quantity, !v.given()};
  }

  FileTexts const& files_;
};

// Files are the same when their content is, whatever they are called.
std::string content_of(std::string const& text) {
  auto const at = text.find(" (content ");
  return at == text.npos ? text : text.substr(at);
}

void compare(Leaves const& before, Leaves const& after, std::string const& section, std::string const& name,
             std::vector<Difference>& into) {
  for (auto const& [key, b] : before) {
    auto const hit = after.find(key);
    if (hit == after.end()) {
      if (!b.is_default) into.push_back({section, name, key, b.printed(), "", 1, b.quantity, {}});
    } else if (!same(b, hit->second) && content_of(b.text) != content_of(hit->second.text)) {
      into.push_back({section, name, key, b.printed(), hit->second.printed(), 1, b.quantity, hit->second.quantity});
    }
  }
  for (auto const& [key, a] : after)
    if (!before.contains(key) && !a.is_default)
      into.push_back({section, name, key, "", a.printed(), 1, {}, a.quantity});
}

// name -> leaves of a section whose keys are names; "" for one that is a single table.
std::map<std::string, Leaves> named(ModelValue const* section, Flattener const& flat) {
  std::map<std::string, Leaves> out;
  if (!section || !section->given()) return out;
  for (ModelValue const& child : section->children) {
    if (section->listed)
      flat.add(child, "", out[child.key]);
    else
      flat.add(child, child.key, out[""]);
  }
  return out;
}

// Placement and material of a shape.
Leaves placed(PlacedValue const& p, Flattener const& flat) {
  Leaves out;
  for (ModelValue const* table : {&p.entry, &p.face})  // the face has priority
    for (char const* key : {"shape", "file", "units", "body", "material", "side", "medium", "surfaces"})
      if (ModelValue const* v = table->find(key); v && v->given()) flat.add(*v, key, out);
  for (std::size_t i = 0; i < p.frames.size(); ++i)
    for (char const* key : {"at", "facing", "rotate"})
      if (ModelValue const* v = p.frames[i].find(key); v && v->given())
        flat.add(*v, i == 0 ? key : fmt::format("frame {}.{}", i, key), out);
  if (p.axis >= 0)
    out[fmt::format("repeat along {}", "xyz"[p.axis])] = {fmt::format("{} m", p.offset),
                                                          Quantity{p.offset, dim::length, {}}, false};
  return out;
}

// Equal changes of instances of one group are one line.
void fold(std::vector<Difference>& of_group) {
  std::vector<Difference> folded;
  for (Difference& d : of_group) {
    auto const hit = std::find_if(folded.begin(), folded.end(), [&](Difference const& f) {
      return f.key == d.key && f.before == d.before && f.after == d.after;
    });
    if (hit == folded.end())
      folded.push_back(std::move(d));
    else
      ++hit->instances;
  }
  of_group = std::move(folded);
}

void compare_scenes(Scene const& before, Scene const& after, std::vector<Difference>& into) {
  Flattener const flat_before(before), flat_after(after);
  std::map<std::string, std::pair<std::string, Leaves>> b, a;  // by instance: group and leaves
  for (PlacedValue const& p : placed_values(before)) b[p.name] = {p.group, placed(p, flat_before)};
  for (PlacedValue const& p : placed_values(after)) a[p.name] = {p.group, placed(p, flat_after)};
  std::map<std::string, std::vector<Difference>> by_group;
  for (auto const& [name, entry] : b) {
    auto& own = by_group[entry.first];
    auto const hit = a.find(name);
    if (hit == a.end()) {
      own.push_back({"scene", entry.first, "", "present", ""});
      continue;
    }
    compare(entry.second, hit->second.second, "scene", entry.first, own);
  }
  for (auto const& [name, entry] : a)
    if (!b.contains(name)) by_group[entry.first].push_back({"scene", entry.first, "", "", "present"});
  for (auto& [group, list] : by_group) {
    fold(list);
    into.insert(into.end(), list.begin(), list.end());
  }
}

}  // namespace

std::vector<Difference> differences(Scene const& before, Scene const& after) {
  ModelValue const b = model_tree(before), a = model_tree(after);
  std::vector<Difference> all;
  for (std::string_view const section : sections) {
    if (section == "report") continue;
    if (section == "scene") {
      compare_scenes(before, after, all);
      continue;
    }
    auto const x = named(b.find(section), Flattener(before)), y = named(a.find(section), Flattener(after));
    for (auto const& [name, leaves] : x) {
      if (auto const hit = y.find(name); hit != y.end())
        compare(leaves, hit->second, std::string(section), name, all);
      else
        all.push_back({std::string(section), name, "", "present", ""});
    }
    for (auto const& [name, leaves] : y)
      if (!x.contains(name)) all.push_back({std::string(section), name, "", "", "present"});
  }
  return all;
}

std::vector<Difference> parameter_differences(Scene const& before, Scene const& after) {
  auto const values = [](Scene const& scene) {
    Leaves out;
    ModelValue const model = model_tree(scene);
    if (ModelValue const* params = model.find("params"))
      for (ModelValue const& p : params->children) out[p.key] = {p.value, p.quantity, false};
    return out;
  };
  std::vector<Difference> all;
  compare(values(before), values(after), "params", "", all);
  std::stable_partition(all.begin(), all.end(),
                        [](Difference const& d) { return !d.before.empty() && !d.after.empty(); });
  return all;
}

// Differences between two models as text: readable numbers, and one line for equal changes of many instances.

namespace {

struct Unit {
  Dimension dimension;
  double factor;
  char const* name;
};
// Of one dimension the largest first; the last one is for all that is smaller.
constexpr std::array<Unit, 15> units{
    Unit{dim::length, 1e3, "km"}, {dim::length, 1, "m"},     {dim::length, 1e-2, "cm"},   {dim::length, 1e-3, "mm"},
    {dim::length, 1e-6, "um"},    {dim::length, 1e-9, "nm"}, {dim::angle, degree, "deg"}, {dim::angle, 1e-3, "mrad"},
    {dim::angle, 1e-6, "urad"},   {dim::power, 1e6, "MW"},   {dim::power, 1e3, "kW"},     {dim::power, 1, "W"},
    {dim::power, 1e-3, "mW"},     {dim::power, 1e-6, "uW"},  {dim::mass, 1, "kg"}};

Unit const* unit_for(Quantity const& q) {
  Unit const* best = nullptr;
  for (Unit const& u : units)
    if (u.dimension == q.dimension && (!best || std::fabs(q.si) < best->factor)) best = &u;
  return best;
}

std::string in_unit(double si, Unit const& u, int digits) {
  return fmt::format("{:.{}g} {}", si / u.factor, digits, u.name);
}

// "49.5 cm -> 48 cm": as many digits as tell them apart.
std::string change(Difference const& d) {
  if (!d.was || !d.is || d.was->dimension != d.is->dimension) return d.before + " -> " + d.after;
  Quantity const larger = std::fabs(d.was->si) > std::fabs(d.is->si) ? *d.was : *d.is;
  Unit const* const unit = unit_for(larger);
  auto const text = [&](Quantity const& q, std::string const& as_given, int digits) {
    std::string out =
        unit ? in_unit(q.si, *unit, digits) : with_unit(fmt::format("{:.{}g}", q.si, digits), q.dimension);
    if (!unit && q.dimension == dim::angle) return as_given;  // in rad
    out += q.amplitude == Amplitude::peak ? " peak" : q.amplitude == Amplitude::rms ? " rms" : "";
    out += q.amplitude == Amplitude::peak_to_peak ? " pp" : "";
    return out + (as_given.ends_with(" (default)") ? " (default)" : "");
  };
  for (int digits = 5; digits < 17; digits += 3)
    if (std::string const a = text(*d.was, d.before, digits), b = text(*d.is, d.after, digits); a != b)
      return a + " -> " + b;
  return d.before + " -> " + d.after;
}

// A number in only one model.
std::string alone(std::string const& text, std::optional<Quantity> const& q) {
  Unit const* const unit = q ? unit_for(*q) : nullptr;
  return unit ? in_unit(q->si, *unit, 5) : text;
}

std::string in_words(Difference const& d) {
  if (d.before.empty()) return d.key.empty() ? "is new" : "now " + alone(d.after, d.is);
  if (d.after.empty()) return d.key.empty() ? "is gone" : "no longer given, was " + alone(d.before, d.was);
  return change(d);
}

constexpr std::size_t most_lines = 3;  // of one key of a group

bool same_key(Difference const& a, Difference const& b) {
  return a.section == b.section && a.name == b.name && a.key == b.key;
}

// "60 instances, by 1.2 mm to 3.4 m; the first: 55.2 m -> 55.1 m"
std::string many(std::vector<Difference>::const_iterator first, std::vector<Difference>::const_iterator last) {
  std::size_t instances = 0;
  double least = infinity, most = 0;
  bool numbers = true;
  for (auto d = first; d != last; ++d) {
    instances += d->instances;
    numbers = numbers && d->was && d->is;
    if (!d->was || !d->is) continue;
    least = std::min(least, std::fabs(d->is->si - d->was->si));
    most = std::max(most, std::fabs(d->is->si - d->was->si));
  }
  std::string text = fmt::format("{} instances", instances);
  if (Unit const* const u = numbers ? unit_for({most, first->was->dimension}) : nullptr)
    text += fmt::format(", by {} to {}", in_unit(least, *u, 3), in_unit(most, *u, 3));
  return text + "; the first: " + in_words(*first);
}

}  // namespace

std::vector<DifferenceLine> difference_lines(std::vector<Difference> const& parameters,
                                             std::vector<Difference> const& all) {
  std::vector<DifferenceLine> lines;
  if (all.empty()) return lines;
  for (Difference const& p : parameters) lines.push_back({"parameters", p.key, in_words(p)});
  std::vector<Difference> sorted = all;  // lines of one key together, where its first stood
  for (auto d = sorted.begin(); d != sorted.end(); ++d)
    d = std::prev(std::stable_partition(d, sorted.end(), [key = *d](Difference const& o) { return same_key(o, key); }));
  for (auto d = sorted.cbegin(); d != sorted.cend();) {
    std::string const named = d->name + (d->name.empty() || d->key.empty() ? "" : " ") + d->key;
    std::string const what = named.empty() ? d->section : named;
    auto const last = std::find_if(d, sorted.cend(), [&](Difference const& o) { return !same_key(o, *d); });
    if (std::size_t(last - d) > most_lines) {
      lines.push_back({d->section, what, many(d, last)});
      d = last;
    }
    for (; d != last; ++d)
      lines.push_back(
          {d->section, what, in_words(*d) + (d->instances > 1 ? fmt::format(" ({} instances)", d->instances) : "")});
  }
  return lines;
}

std::string difference_text(std::vector<DifferenceLine> const& lines) {
  if (lines.empty()) return "no physical difference between the models\n";
  std::string text, section;
  for (DifferenceLine const& l : lines) {
    if (l.section != section) text += (section = l.section) + "\n";
    text += fmt::format("  {}: {}\n", l.what, l.change);
  }
  return text;
}

bool same_texts(RunContent const& b, RunContent const& a) {
  return b.main_file == a.main_file && b.overrides == a.overrides && b.files == a.files;
}

std::string motion_difference(RunContent const& before, RunContent const& after) {
  if (before.motion_file == after.motion_file) return {};
  auto const named = [](RunContent const& r) { return r.motion_file.empty() ? "the scene" : r.motion_file; };
  return fmt::format("noise with the motion of {} -> {}", named(before), named(after));
}

namespace {

struct Compared {
  char const *name, *unit;
  double DetectorNumbers::*number;
  double tolerance;  // relative
};
constexpr Compared all_compared[] = {
    {"arm length", " m", &DetectorNumbers::arm_length, 0.01},
    {"power in an arm", " W", &DetectorNumbers::arm_power, 0.1},
    {"mass of a mirror", " kg", &DetectorNumbers::mirror_mass, 0.1},
    {"finesse of an arm", "", &DetectorNumbers::finesse, 0.1},
    {"Gamma, from signal recycling and finesse,", "", &DetectorNumbers::gain, 0.1},
};

// An unknown value equals any other.
std::vector<std::string> differences(DetectorNumbers const& own, DetectorNumbers const& curve) {
  std::vector<std::string> all;
  for (Compared const& c : all_compared) {
    double const a = own.*c.number, b = curve.*c.number;
    if (std::fabs(a - b) > c.tolerance * std::fabs(b))
      all.push_back(fmt::format("{} {:.4g}{}, not {:.4g}{}", c.name, a, c.unit, b, c.unit));
  }
  return all;
}

std::string remedy(std::string const& detector) {
  std::string const file = fmt::format("library/detectors/{}.yaml", detector);
  if (embedded_file(file).empty())
    return "give the interferometer these numbers, or compare with a curve of its own detector";
  return fmt::format("take the interferometer of '{}', or compare with a curve of your own detector", file);
}

}  // namespace

std::optional<OtherDetector> other_detector(std::string const& curve, Interferometer const& interferometer) {
  DetectorNumbers const own = interferometer.numbers();
  std::vector<std::string> least;
  std::string detector, title;
  for (std::string const& name : detectors_of_design(curve)) {
    IfoFile const file = read_ifo(name);
    std::vector<std::string> const found = differences(own, file.detector.numbers());
    if (found.empty()) return {};
    if (!least.empty() && found.size() >= least.size()) continue;
    least = found;
    detector = name;
    title = file.title;
  }
  if (least.empty()) return {};
  return OtherDetector{fmt::format("'{}' is a curve of {}, and the interferometer is another one: {}", curve, title,
                                   fmt::join(least, "; ")),
                       remedy(detector)};
}

std::optional<OtherDetector> other_detector(IfoFile const& budget, std::string const& detector, std::string const& run,
                                            Interferometer const& interferometer) {
  std::vector<std::string> const found = differences(interferometer.numbers(), budget.detector.numbers());
  if (found.empty()) return {};
  return OtherDetector{
      fmt::format("'{}' is a budget of {}, and the interferometer of '{}' is another one: {}", detector,
                  budget.title.empty() ? "one detector" : budget.title, run, fmt::join(found, "; ")),
      fmt::format("give the detector of '{}', or project the run with the interferometer of '{}'", run, detector)};
}

void warn_of_other_detector(ProjectionModel const& model, Node const& place) {
  if (!model.detector) return;
  for (DesignCurve const& curve : model.design)
    if (auto const other = other_detector(curve.name, *model.detector)) place.warning(other->what, other->suggestion);
}

namespace {

bool every_replica(CouplingTable const& table) {
  return std::ranges::none_of(table.replica_histories, [](auto n) { return n == 0; });
}

// Standard error of w_before P + w_after Q.
double paired(ReplicatedPower const& p, double w_before, ReplicatedPower const& q, double w_after, bool same_light) {
  double variance = 0;
  for (std::size_t r = 0; r < p.off.size(); ++r) variance += std::pow(w_before * p.off[r] + w_after * q.off[r], 2);
  auto const both = [&](double x, double y) { return std::pair(w_before * w_before * x, w_after * w_after * y); };
  auto const [rest_before, rest_after] = both(p.rest, q.rest);
  if (same_light) {
    double const root = std::sqrt(rest_after) - std::sqrt(rest_before);  // weights of opposite signs
    return std::sqrt(variance + root * root);
  }
  auto const [unseen_before, unseen_after] = both(p.unseen, q.unseen);
  return std::sqrt(variance + rest_before + rest_after + std::max(unseen_before, unseen_after));
}

}  // namespace

Histories common_histories(RunFile const& before, RunFile const& after) {
  CouplingTable const &b = before.trace.coupling, &a = after.trace.coupling;
  if (b.seed != a.seed || b.histories != a.histories) return Histories::other;
  if (before.about.model_hash == after.about.model_hash) return Histories::same_light;
  bool const alike = b.block_size == a.block_size && b.replica_histories == a.replica_histories;
  return alike && every_replica(b) ? Histories::same : Histories::other;
}

void ReplicatedPower::add(ReplicatedPower const& o) {
  value += o.value;
  rest += o.rest;
  unseen += o.unseen;
  for (std::size_t r = 0; r < off.size(); ++r) off[r] += o.off[r];
}

void ReplicatedPower::set_error(double sigma) {
  double light = 0;
  for (double const x : off) light += x * x;
  rest = std::max(0.0, sigma * sigma - light);
}

// The mean of n replicas with the deviations d_r of their sums S_r, relative to the sum of all, has the relative
// variance n/(n - 1) sum of d_r^2.
ReplicatedPower replicated(CouplingTable const& table, CouplingClass const& c, double value, double sigma,
                           bool all_of_it) {
  ReplicatedPower p{value, {}, sigma * sigma, std::pow(value * c.coupling.largest_share, 2)};
  double const sum = std::accumulate(c.replica_sum.begin(), c.replica_sum.end(), 0.0);
  if (!(sum > 0) || !every_replica(table)) return p;
  double const all = double(std::accumulate(table.replica_histories.begin(), table.replica_histories.end(), 0ull));
  double variance = 0;
  for (std::size_t r = 0; r < p.off.size(); ++r) {
    double const share = c.replica_sum[r] / sum - double(table.replica_histories[r]) / all;
    p.off[r] = value * share * std::sqrt(double(replica_count) / (replica_count - 1));
    variance += p.off[r] * p.off[r];
  }
  if (all_of_it && variance > 0)
    for (double& x : p.off) x *= sigma / std::sqrt(variance);
  if (!all_of_it || variance > 0) p.rest = all_of_it ? 0 : std::max(0.0, p.rest - variance);
  return p;
}

ErrorOfChange error_of_change(WithError const& before, WithError const& after, ReplicatedPower const& p,
                              ReplicatedPower const& q, Histories common, double exponent) {
  auto const relative = [](WithError const& v) { return v.value > 0 ? v.sigma / v.value : not_a_number; };
  ErrorOfChange const independent{std::hypot(before.sigma, after.sigma), std::hypot(relative(before), relative(after))};
  if (common == Histories::other) return independent;
  bool const same_light = common == Histories::same_light;
  auto const slope = [&](WithError const& v, ReplicatedPower const& of) {
    return of.value > 0 ? exponent * v.value / of.value : 0;
  };
  double const change = paired(p, -slope(before, p), q, slope(after, q), same_light);
  if (!(p.value > 0) || !(q.value > 0)) return {change, not_a_number, true};
  return {change, paired(p, -exponent / p.value, q, exponent / q.value, same_light), true};
}

bool Change::too_small() const { return std::fabs(after.value - before.value) < held; }

double Change::sigmas() const {
  double const change = too_small() ? 0 : after.value - before.value;
  if (!within.empty() || (change != 0 && (before.at_most || after.at_most))) return not_a_number;
  bool const computed = error.change <= 1e-9 * std::max(before.value, after.value);  // rounding, no Monte-Carlo error
  return !computed ? change / error.change : change == 0 ? 0 : not_a_number;
}

WithError Change::ratio() const {
  if (!within.empty() || !(before.value > 0)) return {not_a_number, not_a_number};
  double const ratio = after.value / before.value;
  if (ratio == 1) return {1, error.paired ? 0 : error.ratio, before.at_most || after.at_most, bound};
  double const spectra = held > 0 ? held / std::hypot(before.value, after.value) * std::sqrt(2) : 0;
  return {ratio, ratio > 0 ? ratio * std::hypot(error.ratio, spectra) : after.sigma / before.value,
          before.at_most || after.at_most, bound};
}

std::string value_text(Change const& c, bool after) {
  WithError const& value = after ? c.after : c.before;
  if (value.value > 0) return with_error(value);
  bool const has = after ? c.has_after : c.has_before;
  return has ? c.zero : c.within.empty() ? "none" : "in '" + c.within + "'";
}

std::string ratio_text(Change const& c) {
  WithError const r = c.ratio();
  if (!std::isfinite(r.value)) return "-";
  if (r.at_most) return fmt::format("{:.3g} (of bounds)", r.value);
  return r.sigma > 0 ? with_brackets(r.value, r.sigma) : fmt::format("{:.4g}", r.value);
}

std::string verdict_text(Change const& c) {
  double const s = c.sigmas();
  if (!c.within.empty()) return fmt::format("compared within '{}'", c.within);
  if (c.before.value == c.after.value) return "the same";
  if (c.too_small())
    return fmt::format("a change of {:.1e}, less than the error of the spectra, {:.1e}", c.after.value - c.before.value,
                       c.held);
  if (std::isfinite(s))
    return fmt::format("{} sigma{}", std::fabs(s) < 0.05 ? "0.0" : fmt::format("{:+.1f}", s),
                       std::fabs(s) < significant ? "" : ", significant");
  if (!c.before.at_most && !c.after.at_most) return "changed, without an error";
  return c.bound ? "contains upper bounds: speckle may hide the change" : "an upper bound: speckle may hide the change";
}

std::string outcome_text(Change const& c) {
  if (!c.within.empty()) return fmt::format("in '{}'", c.within);
  double const s = c.sigmas();
  bool const seen = !std::isfinite(s) || std::fabs(s) >= significant;  // computed, or beyond its error
  if (c.bound && !seen) return "not resolved";
  if (!c.has_before) return "new";
  if (!c.has_after) return "vanished";
  if (c.before.value == c.after.value) return c.bound ? "not resolved" : "the same";
  if (c.before.at_most || c.after.at_most) return "upper bound";
  if (!seen) return "no change resolved";
  return std::string(c.after.value > c.before.value ? "grew" : "fell") + (c.bound ? " (lower bound)" : "");
}

nlohmann::ordered_json change_json(Change const& c) {
  using Json = nlohmann::ordered_json;
  Json one{{"what", c.what}};
  if (!c.id.empty()) one["id"] = c.id;
  one["before"] = error_json(c.before);
  one["after"] = error_json(c.after);
  if (!c.within.empty()) one["within"] = c.within;
  WithError const ratio = c.ratio();
  one["ratio"] = std::isfinite(ratio.value) ? error_json(ratio) : Json();
  one["error"] = c.error.paired ? "paired replicas" : "independent";
  one["sigmas"] = std::isfinite(c.sigmas()) ? Json(c.sigmas()) : Json();
  if (c.held > 0) one["spectra_error"] = c.held;
  one["unresolved"] = c.bound;
  return one;
}

}  // namespace straytrace::session
