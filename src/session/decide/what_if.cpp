// SPDX-License-Identifier: BSD-3-Clause
#include "session/decide/what_if.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <type_traits>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "noise/bands/inversion.hpp"
#include "noise/project/route_noise.hpp"
#include "scene/model_tree.hpp"
#include "scene/scene_document.hpp"
#include "scene/scope.hpp"
#include "session/light/cavity_waves.hpp"
#include "trace/importance/importance.hpp"
#include "world/model/material.hpp"

namespace straytrace::session {
namespace {

struct RowSums {
  double before = 0, after = 0, squares = 0, unknown = 0;
  std::array<double, replica_count> of_before{}, of_after{};
};

RowSums sums_of(CouplingTable const& table, CouplingClass const& c, std::vector<double> const& factors) {
  RowSums s;
  for (std::size_t j = 0; j < c.records.size(); ++j) {
    double const w = c.records[j].weight, f = std::isnan(factors[j]) ? 0 : factors[j], changed = w * std::exp(f);
    std::size_t const r = replica_of(c.records[j].history, table.block_size);
    s.before += w;
    s.after += changed;
    s.squares += changed * changed;
    s.unknown += std::isnan(factors[j]) ? w : 0;
    s.of_before[r] += w;
    s.of_after[r] += changed;
  }
  return s;
}

void scale_replicas(CouplingClass& c, RowSums const& s) {
  double before = 0, after = 0;
  for (std::size_t r = 0; r < replica_count; ++r) {
    before += c.replica_sum[r];
    c.replica_sum[r] *= s.of_before[r] > 0 ? s.of_after[r] / s.of_before[r] : s.after / s.before;
    after += c.replica_sum[r];
  }
  double const factor = before > 0 ? after / before : s.after / s.before;
  c.coupling.mean *= factor;
  c.coupling.std_error *= factor;
  c.phase_sensitivities.clear();  // moments of the paths as traced
}

ReweightedCouplings by_paths(CouplingTable const& table, PathFactors const& factors) {
  ReweightedCouplings out{{table, {}}, {}};
  std::vector<CouplingClass> lit;
  for (std::size_t k = 0; k < table.classes.size(); ++k) {
    CouplingClass& c = out.light.table.classes[k];
    if (factors[k].empty() || !(c.coupling.mean > 0)) {
      out.light.unknown.push_back(0);
      out.effective.push_back(infinity);
      lit.push_back(std::move(c));
      continue;
    }
    RowSums const s = sums_of(table, c, factors[k]);
    out.light.unknown.push_back(s.unknown / s.before);
    out.effective.push_back(s.after > 0 ? s.after * s.after / s.squares : 0);
    if (!(s.after > 0)) continue;
    for (std::size_t j = 0; j < c.records.size(); ++j)
      if (!std::isnan(factors[k][j])) c.records[j].weight *= std::exp(factors[k][j]);
    scale_replicas(c, s);
    lit.push_back(std::move(c));
  }
  out.light.table.classes = std::move(lit);
  return out;
}

// Factor of a ghost route by the coatings that it meets.
RouteFactor coating_factor(World const& before, World const& after) {
  return [ratios = coating_ratios(before, after)](std::vector<PathStep> const& steps) {
    double factor = 1;
    for (PathStep const& s : steps)
      if (auto const hit = ratios.find(s.group.value); hit != ratios.end())
        factor *= s.event == Event::reflect    ? hit->second.reflect
                  : s.event == Event::transmit ? hit->second.transmit
                                               : 1;
    return factor;
  };
}

void scale_ghosts(CouplingTable& table, RouteFactor const& coatings) {
  CouplingTable ghosts = table;
  std::erase_if(ghosts.classes, [](CouplingClass const& c) { return c.kind != ClassKind::ghost; });
  std::erase_if(table.classes, [](CouplingClass const& c) { return c.kind == ClassKind::ghost; });
  for (CouplingClass& c : scaled_couplings(ghosts, coatings).table.classes) table.classes.push_back(std::move(c));
}

Model as_traced(RunFile const& file, unsigned threads) {
  Model model = model_of(file);
  model.world.block_size = file.trace.coupling.block_size;
  model.waves = file.about.waves;
  light_halo(model, true, threads, {.quiet = true});
  return model;
}

}  // namespace

KeptPaths::KeptPaths(RunFile const& file, unsigned threads)
    : model_(as_traced(file, threads)), laws_(steer(model_.world, threads), file.trace.coupling) {}

std::vector<bool> computed_anew(CouplingTable const& table, MaterialChange const& change) {
  auto const meets = [&](std::vector<PathStep> const& steps) {
    return std::ranges::any_of(
        steps, [&](PathStep const& s) { return std::ranges::find(change.groups, s.group) != change.groups.end(); });
  };
  std::vector<bool> all;
  for (CouplingClass const& c : table.classes) {
    bool const met =
        meets(c.steps) || std::ranges::any_of(c.folded, [&](FoldedRoute const& f) { return meets(f.steps); });
    all.push_back(c.deterministic() && met && c.kind != ClassKind::ghost);
  }
  return all;
}

ReweightedCouplings reweighted(CouplingTable const& table, KeptPaths const& paths, World const& after) {
  PathFactors const factors = paths.laws().factors(after);
  ReweightedCouplings out = by_paths(table, factors);
  for (auto const& of_class : factors)
    out.meets_edge = out.meets_edge || std::ranges::any_of(of_class, [](double f) { return std::isinf(f); });
  scale_ghosts(out.light.table, coating_factor(paths.world(), after));
  return out;
}

namespace {

struct Setting {
  std::string text, name, value;
  std::optional<double> factor;  // of "x2" and "black"
};

constexpr char const* forms =
    "write MATERIAL=x2, MATERIAL=black, BODY.motion=x2, or a value of the scene: steel.brdf=5e-3/sr";

Setting parsed(std::string const& text) {
  std::size_t const equals = text.find('=');
  if (equals == text.npos || equals == 0 || equals + 1 == text.size())
    throw InputError(fmt::format("--set: '{}' sets nothing", text), forms);
  Setting s{text, text.substr(0, equals), text.substr(equals + 1), {}};
  if (s.value == "black") s.factor = 0;
  if (s.value.front() != 'x') return s;
  char* end = nullptr;
  double const factor = std::strtod(s.value.c_str() + 1, &end);
  if (s.value.size() == 1 || end != s.value.c_str() + s.value.size() || !(factor >= 0) || !std::isfinite(factor))
    throw InputError(fmt::format("--set {}: '{}' is not a factor", text, s.value), "write x0.5 or x2");
  s.factor = factor;
  return s;
}

// The keys of `name` occur in `place` in this order, and its last key is the last.
bool leads_to(std::string const& name, std::string const& place) {
  std::vector<std::string> const wanted = scene::keys_of_place(name), keys = scene::keys_of_place(place);
  if (wanted.back() != keys.back()) return false;
  auto at = keys.begin();
  for (std::string const& key : wanted) {
    at = std::find(at, keys.end(), key);
    if (at == keys.end()) return false;
    ++at;
  }
  return true;
}

void add_values(scene::ModelValue const& value, std::string const& place, std::vector<SceneValue>& all) {
  bool const number = value.quantity && std::isfinite(value.quantity->si);
  if (value.kind == Node::Kind::scalar || (!value.given() && number))
    all.push_back({place, value.written, number ? value.quantity : std::nullopt, value.given(),
                   value.how.form == KeyRequest::Form::whole});
  for (std::size_t i = 0; i < value.children.size(); ++i) {
    scene::ModelValue const& child = value.children[i];
    scene::ModelValue const* const name = child.find("name");
    std::string const key = !child.key.empty() ? child.key : name && name->given() ? name->value : fmt::format("{}", i);
    add_values(child, place.empty() ? key : place + "." + key, all);
  }
}

// Where the first key of a name is that of a material, a body or a table: its values, and the nearest of them. Else the
// nearest such key, "did you mean 'steel.brdf'?".
std::string remedy_for(std::string const& name, std::vector<SceneValue> const& all) {
  constexpr std::size_t most = 8;
  std::vector<std::string> const wanted = scene::keys_of_place(name);
  std::string const owner = wanted.front();
  std::vector<std::string> places, last_keys;
  std::set<std::string> owners;
  for (bool const given : {true, false})
    for (SceneValue const& v : all) {
      if (v.given != given) continue;
      std::vector<std::string> const keys = scene::keys_of_place(v.place);
      bool const named = keys.size() > 2 && (keys.front() == "materials" || keys.front() == "bodies");
      owners.insert(named ? keys[1] : keys.front());
      if (std::ranges::find(keys, owner) == keys.end()) continue;
      places.push_back(v.place);
      last_keys.push_back(keys.back());
    }
  if (places.empty()) {
    std::string const near = nearest_word(owner, std::vector<std::string>(owners.begin(), owners.end()));
    return near.empty() ? forms : fmt::format("did you mean '{}'?", near + name.substr(owner.size()));
  }
  std::string const near = nearest_word(wanted.back(), last_keys);
  std::string remedy;
  if (!near.empty())
    remedy = fmt::format("did you mean '{}'? ", places[std::ranges::find(last_keys, near) - last_keys.begin()]);
  bool const more = places.size() > most;
  places.resize(std::min(places.size(), most));
  return remedy + fmt::format("'{}' has {}{}; besides, MATERIAL=x2, MATERIAL=black and BODY.motion=x2 are possible",
                              owner, fmt::join(places, ", "), more ? ", ..." : "");
}

SceneValue value_named(std::string const& name, std::vector<SceneValue> const& all) {
  std::vector<SceneValue> found;
  for (SceneValue const& v : all) {
    if (v.place == name) return v;
    if (leads_to(name, v.place)) found.push_back(v);
  }
  if (found.size() == 1) return found.front();
  std::vector<std::string> several;
  for (SceneValue const& v : found) several.push_back(v.place);
  if (!found.empty())
    throw InputError(fmt::format("--set: '{}' names {} values of the scene", name, found.size()),
                     fmt::format("write one of {}", fmt::join(several, ", ")));
  throw InputError(fmt::format("--set: the scene has no value '{}'", name), remedy_for(name, all));
}

class Changes {
 public:
  explicit Changes(OpenRun& run)
      : run_(run),
        materials_(run.model.traced.materials),
        scattered_(run.model.traced.scattered),
        factor_(materials_.size(), 1) {}

  void add(Setting const& s) {
    std::size_t const point = s.name.rfind('.');
    std::string const owner = s.name.substr(0, point), key = point == s.name.npos ? "" : s.name.substr(point + 1);
    if (auto const m = material(s.name)) return scale(*m, whole_factor(s), s.text);
    if (auto const m = material(owner); m && key == "tis") return scale(*m, tis_factor(*m, s), s.text);
    if (auto const moved = body(owner); moved && key == "motion") return move(s, *moved);
    if (key.empty() && std::ranges::none_of(values(), [&](SceneValue const& v) { return leads_to(s.name, v.place); }))
      throw InputError(fmt::format("--set {}: there is no material or value '{}'", s.text, s.name),
                       did_you_mean(s.name, material_names(), forms));
    set(s);
  }

  // Values of the scene that their keys reject; result() rejects them too.
  void add_errors_of_values(std::vector<InputError>& errors) const {
    std::vector<Override> all = of_materials_;
    all.insert(all.end(), of_projection_.begin(), of_projection_.end());
    if (!all.empty()) collect(errors, [&] { model_with(all); });
  }

  WhatIf result() {
    WhatIf out;
    if (!of_materials_.empty()) change_laws();
    scale_light(out);
    ProjectionModel model =
        of_projection_.empty()
            ? std::move(run_.model)
            : built_with(of_projection_, [&](auto const& texts) { return projection_of(run_.file, texts); });
    for (auto const& [moved, factor] : moved_) model.motion = with_scaled_body(model.motion, moved, factor);
    out.model = std::move(model);
    out.statements = std::move(statements_);
    return out;
  }

 private:
  // A value of the scene: as the user wrote it, and with its place.
  struct Override {
    std::string written, text;
  };

  // Errors in these values are those of --set, not of a command line that nobody wrote.
  template <class Build>
  std::invoke_result_t<Build const&, std::vector<std::string> const&> built_with(std::vector<Override> const& set,
                                                                                 Build const& build) const {
    std::vector<std::string> texts;
    for (Override const& o : set) texts.push_back(o.text);
    try {
      return build(texts);
    } catch (InputError const& e) {
      std::size_t const earlier = run_.file.about.overrides.size();
      std::vector<InputError> errors;
      for (Problem const& p : e.problems) {
        bool const of_set = p.place.file < e.files.size() && e.files[p.place.file] == command_line_name &&
                            p.place.line > earlier && p.place.line <= earlier + set.size();
        if (!of_set) throw;
        errors.emplace_back(fmt::format("--set {}: {}", set[p.place.line - earlier - 1].written, p.what), p.suggestion);
      }
      throw joined(errors);
    }
  }
  Model model_with(std::vector<Override> const& set) const {
    return built_with(set, [&](auto const& texts) { return model_of(run_.file, texts); });
  }

  void scale_light(WhatIf& out) {
    CouplingTable const& light = reweighted_ ? reweighted_->table : run_.file.trace.coupling;
    if (std::ranges::all_of(factor_, [](double f) { return f == 1; })) {
      out.light = light;
      return;
    }
    ScaledCouplings scaled = scaled_couplings(light, [&](std::vector<PathStep> const& steps) {
      double product = 1;
      for (std::size_t m = 0; m < factor_.size(); ++m)
        if (factor_[m] != 1) product *= std::pow(factor_[m], scatters_on(materials_[m], steps));
      return product;
    });
    out.light = std::move(scaled.table);
    if (run_.model.detector) out.warning = about_unnamed(light, scaled.unknown);
  }
  // Rows whose routes are not all named follow those that are.
  std::string about_unnamed(CouplingTable const& light, std::vector<double> const& unknown) const {
    if (std::ranges::all_of(unknown, [](double u) { return u == 0; })) return {};
    NoiseBudget const budget = run_.model.project(light);
    double most = 1e-3;
    std::size_t bin = budget.grid.size();
    for (std::size_t i = 0; i < budget.grid.size(); ++i) {
      double sum = 0;
      for (std::size_t r = 0; r < budget.routes.size(); ++r) sum += unknown[r] * budget.routes[r].psd(i);
      if (double const share = sum / budget.total.psd(i); share > most) {
        most = share;
        bin = i;
      }
    }
    if (bin == budget.grid.size()) return {};
    return fmt::format(
        "--set: routes without a name carry up to {:.2g} % of the noise power as traced, at {:.3g} Hz: how often their "
        "light scatters is not known, and they follow the named routes of their row",
        100 * most, budget.grid.centre(bin));
  }

  std::optional<std::size_t> material(std::string const& name) const {
    for (std::size_t m = 0; m < materials_.size(); ++m)
      if (materials_[m].name == name) return m;
    return {};
  }
  std::vector<std::string> material_names() const {
    std::vector<std::string> names;
    for (MaterialSpread const& m : materials_) names.push_back(m.name);
    return names;
  }
  std::optional<BodyId> body(std::string const& name) const {
    auto const& bodies = run_.model.motion.bodies;
    auto const hit = std::ranges::find(bodies, name);
    if (hit == bodies.end()) return {};
    return BodyId{std::uint32_t(hit - bodies.begin())};
  }

  std::vector<SceneValue> const& values() {
    if (values_.empty()) values_ = scene_values(run_.model.scene);
    return values_;
  }

  static double whole_factor(Setting const& s) {
    if (!s.factor)
      throw InputError(fmt::format("--set {}: a whole material takes a factor", s.text),
                       fmt::format("write {0}=x2, {0}=black or {0}.tis=1e-4", s.name));
    return *s.factor;
  }
  double tis_factor(std::size_t m, Setting const& s) const {
    if (s.factor) return *s.factor;
    char* end = nullptr;
    double const share = std::strtod(s.value.c_str(), &end), now = scattered_[m];
    std::string_view const unit(end);
    double const scale = unit.empty()                      ? 1
                         : unit == "%" || unit == " %"     ? 1e-2
                         : unit == "ppm" || unit == " ppm" ? 1e-6
                                                           : -1;
    if (end == s.value.c_str() || scale < 0 || !(share >= 0))
      throw InputError(fmt::format("--set {}: '{}' is not a share of the light", s.text, s.value),
                       "write 2e-4, 5 ppm or 3 %");
    if (!(now > 0))
      throw InputError(fmt::format("--set {}: it scatters no light", s.text), "trace the scene with a BSDF");
    return share * scale / now;
  }
  void scale(std::size_t m, double factor, std::string const& text) {
    if (factor > 1) refuse_gain(m, factor, text);
    if (materials_[m].of_reflection)
      throw InputError(
          fmt::format("--set {}: what is stated of '{}' is its reflectance, which decides where light goes", text,
                      materials_[m].name),
          "change the scene, and trace it");
    factor_[m] *= factor;
    statements_.push_back(fmt::format("{}: BRDF of {} times {:.4g}", text, materials_[m].name, factor));
  }
  // Scattered, reflected and transmitted light together are at most all of it, at any incidence.
  void refuse_gain(std::size_t m, double factor, std::string const& text) {
    if (!traced_) traced_.emplace(model_of(run_.file));
    LargestFactor const most = largest_factor(traced_->world, materials_[m].name);
    if (factor > most.factor * (1 + 1e-9))
      throw InputError(
          fmt::format("--set {}: '{}' would scatter {:.3g} of the light at {:.0f} degrees of incidence, besides the "
                      "{:.3g} that it reflects and transmits",
                      text, materials_[m].name, factor * most.scattered, most.degrees, most.others),
          fmt::format("at most x{:.3g}", most.factor));
  }
  void move(Setting const& s, BodyId moved) {
    if (!s.factor)
      throw InputError(fmt::format("--set {}: the motion of a body takes a factor", s.text),
                       fmt::format("write {}=x2", s.name));
    moved_.emplace_back(moved, *s.factor);
    statements_.push_back(
        fmt::format("{}: motion of {} times {:.4g}", s.text, run_.model.motion.bodies[moved.value], *s.factor));
  }
  void set(Setting const& s) {
    SceneValue const value = value_named(s.name, values());
    if (s.factor && value.quantity && value.quantity->si == 0)
      throw InputError(fmt::format("--set {}: '{}' is zero", s.text, value.place), "give it a value");
    std::string const text = s.factor ? times(value, *s.factor) : value.place + "=" + s.value;
    if (session::of_projection(value.place)) {
      refuse_other_files(s);
      of_projection_.push_back({s.text, text});
      statements_.push_back(
          fmt::format("{}, instead of {}", text, value.written.empty() ? "its default" : value.written));
    } else if (value.place.starts_with("materials.")) {
      of_materials_.push_back({s.text, text});
    } else {
      throw InputError(fmt::format("--set {}: '{}' changes where light goes", s.text, value.place),
                       fmt::format("trace it: straytrace run SCENE -p \"{}\"", text));
    }
  }
  void refuse_other_files(Setting const& s) const {
    if (run_.projected_with.empty()) return;
    throw InputError(fmt::format("--set {}: the motion or the responses of this run are those of another file", s.text),
                     fmt::format("change the value there: {}", run_.projected_with));
  }

  // Both models are built. Where the law of a material changes by one factor at all angles, its routes count; else the
  // laws at the vertices of the kept paths.
  void change_laws() {
    Model const before = model_of(run_.file), after = model_with(of_materials_);
    WorldView const a = before.world.view(), b = after.world.view();
    std::string text;
    for (Override const& o : of_materials_) text += (text.empty() ? "" : ", ") + o.text;
    std::vector<InputError> errors;
    std::vector<std::pair<std::size_t, double>> strengths;
    bool shape = false;
    for (std::size_t i = 0; i < before.world.materials.size() && i < after.world.materials.size(); ++i) {
      MaterialInfo const &x = before.world.materials[i], &y = after.world.materials[i];
      Optic const &was = a.optics[x.optic], &is = b.optics[y.optic];
      auto const m = material(x.name);
      std::optional<double> const factor = common_factor(a, was, b, is);
      if (!same_coating(a, was, b, is))
        errors.emplace_back(fmt::format("--set: the coating of '{}' changes, and with it where light goes", x.name),
                            "change the scene, and trace it");
      else if (!factor && m)
        shape = true;
      else if (m && *factor != 1)
        strengths.emplace_back(*m, *factor);
    }
    throw_all(errors);
    if (shape) return reweigh(after, text);
    for (auto const& [m, factor] : strengths) scale(m, factor, text);
  }
  // Light that the changed law sends where the run kept no path.
  static void refuse_other_ways(KeptPaths const& paths, World const& is) {
    constexpr double most = 10;  // of light that 512 kept paths may have missed, 2 %
    World const& was = paths.world();
    WorldView const a = was.view(), b = is.view();
    std::vector<double> const seen = paths.laws().largest_ratios(is);
    for (std::size_t m = 0; m < seen.size(); ++m)
      if (seen[m] > 0 &&
          largest_ratio(a, a.optics[was.materials[m].optic], b, b.optics[is.materials[m].optic]) > most * seen[m])
        throw InputError(
            fmt::format("--set: '{}' would scatter most where the run kept no path", was.materials[m].name),
            "change the scene, and trace it");
  }
  void reweigh(Model const& after, std::string const& text) {
    constexpr double fewest = 100;
    statements_.push_back(text + ": the laws at the vertices of the kept paths, of which each route has few");
    KeptPaths const paths(run_.file, 0);
    refuse_other_ways(paths, after.world);
    ReweightedCouplings changed = reweighted(run_.file.trace.coupling, paths, after.world);
    NoiseBudget const budget = run_.model.project(run_.file.trace.coupling);
    std::vector<bool> const computed = computed_anew(run_.file.trace.coupling, change_of(paths.world(), after.world));
    for (std::size_t r = 0; r < budget.routes.size(); ++r) {
      if (changed.effective[r] >= fewest && !computed[r]) continue;
      for (std::size_t i = 0; i < budget.grid.size(); ++i)
        if (budget.routes[r].psd(i) > 0.01 * budget.total.psd(i))
          throw InputError(
              computed[r]
                  ? fmt::format("--set {}: the route '{}' is computed, and has no kept paths", text,
                                budget.routes[r].name)
                  : fmt::format("--set {}: too far from the run: about {:.0f} kept paths of '{}' would carry its light",
                                text, changed.effective[r], budget.routes[r].name),
              "change the scene, and trace it");
    }
    reweighted_ = std::move(changed.light);
  }

  OpenRun& run_;
  std::vector<MaterialSpread> materials_;
  std::vector<double> scattered_;  // by material, at normal incidence
  std::vector<double> factor_;     // by material
  std::vector<std::pair<BodyId, double>> moved_;
  std::vector<Override> of_projection_, of_materials_;
  std::vector<std::string> statements_;
  std::vector<SceneValue> values_;
  std::optional<ScaledCouplings> reweighted_;
  std::optional<Model> traced_;  // with surfaces and materials; where they are needed
};

}  // namespace

std::vector<SceneValue> scene_values(Scene const& scene) {
  std::vector<SceneValue> all;
  add_values(scene::model_tree(scene), "", all);
  std::erase_if(all, [](SceneValue const& v) { return !v.given && !of_projection(v.place); });
  return all;
}

bool of_projection(std::string const& place) {
  std::string const top = scene::keys_of_place(place).front();
  return top == "bodies" || top == "interferometer" || top == "noise";
}

std::string times(SceneValue const& v, double factor) {
  if (!v.quantity) return fmt::format("{}=({}) * {:.17g}", v.place, v.written, factor);
  Value scaled{*v.quantity};
  scaled.quantity.si *= factor;
  return v.place + "=" + scene::si_text(scaled);
}

WhatIf what_if(OpenRun& run, std::vector<std::string> const& settings) {
  Changes changes(run);
  std::vector<InputError> errors;
  for (std::string const& text : settings) try {
      changes.add(parsed(text));
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  if (!errors.empty()) changes.add_errors_of_values(errors);
  throw_all(errors);
  return changes.result();
}

}  // namespace straytrace::session
