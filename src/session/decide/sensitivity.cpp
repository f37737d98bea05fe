// SPDX-License-Identifier: BSD-3-Clause
#include "session/decide/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include "base/errors.hpp"
#include "noise/bands/elasticity.hpp"
#include "noise/bands/input_band.hpp"
#include "scene/model_tree.hpp"
#include "session/decide/what_if.hpp"
#include "session/session.hpp"

namespace straytrace::session {
namespace {

constexpr double least_effect = 1e-4;  // of an elasticity, to be listed

using Progress = std::function<void(std::string const&)>;

NoiseTrace total_of(ProjectionModel const& model, CouplingTable const& table) {
  return project_noise(table, model.motion, *model.detector, model.noise).total;
}

// Bins where light whose scatters are not counted makes more than composition_limit of the noise.
std::vector<bool> unknown_bins(NoiseBudget const& b, std::vector<double> const& unknown) {
  std::vector<bool> out;
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    double sum = 0;
    for (std::size_t r = 0; r < b.routes.size(); ++r) sum += unknown[r] * b.routes[r].psd(i);
    out.push_back(sum > composition_limit * b.total.psd(i));
  }
  return out;
}

void hide(BinValues& values, std::vector<bool> const& bins) {
  for (std::size_t i = 0; i < bins.size(); ++i)
    if (bins[i]) values.value[i] = values.sigma[i] = not_a_number;
}

std::string name_of(MaterialSpread const& material) { return "material " + material.name; }

// dS/d ln p of the BRDF of a material counts each route as often as it scatters on it (eq. D.1).
SensitiveInput of_material(OpenRun const& run, NoiseBudget const& budget, std::size_t m) {
  MaterialSpread const& material = run.model.traced.materials[m];
  auto const count = [&](std::vector<PathStep> const& steps) { return double(scatters_on(material, steps)); };
  ScaledCouplings const derivative = scaled_couplings(run.file.trace.coupling, count);
  SensitiveInput in;
  in.name = name_of(material);
  double const share = run.model.traced.scattered[m];
  in.value = material.of_reflection ? "reflectance" : fmt::format("scatters {:.3g}", share);
  in.method = "exact, by the scatters of each route";
  in.factor = material.factor;
  in.low = material.low;
  in.high = material.high;
  in.elasticity = elasticity(total_of(run.model, derivative.table), budget.total);
  hide(in.elasticity, unknown_bins(budget, derivative.unknown));
  return in;
}

SensitiveInput of_motion(OpenRun const& run, MotionCause const& cause) {
  SensitiveInput in;
  in.kind = InputClass::motion;
  in.name = cause.name;
  in.method = "projected at 0.9 to 1.1 times its ASD";
  in.factor = cause.uncertainty;
  in.elasticity = central_elasticity([&](double factor) {
    MotionSet const motion = with_scaled_inputs(run.model.motion, cause, [&](double) { return factor; });
    return project_noise(run.file.trace.coupling, motion, *run.model.detector, run.model.noise).total;
  });
  return in;
}

SensitiveInput of_value(OpenRun const& run, SceneValue const& value) {
  SensitiveInput in;
  in.kind = value.place.starts_with("bodies.") ? InputClass::motion : InputClass::response;
  in.name = value.place;
  bool const word = value.written.empty() || std::isalpha(static_cast<unsigned char>(value.written.front()));
  double const rounded = std::strtod(fmt::format("{:.6g}", value.quantity->si).c_str(), nullptr);
  in.value = word ? scene::si_text(Value{{rounded, value.quantity->dimension, {}}, false}) : value.written;
  in.method = "projected at 0.9 to 1.1 times its value";
  in.elasticity = central_elasticity([&](double factor) {
    return total_of(projection_of(run.file, {times(value, factor)}), run.file.trace.coupling);
  });
  return in;
}

// Numbers of the materials that change more than one strength: shapes, one law of several, coatings.
class Shapes {
 public:
  Shapes(OpenRun const& run, NoiseBudget const& budget, unsigned threads)
      : run_(run), budget_(budget), paths_(run.file, threads) {}

  std::vector<SceneValue> values() const {
    std::vector<SceneValue> all;
    for (SceneValue const& v : scene_values(paths_.scene())) {
      bool const of_light = v.place.starts_with("materials.") && v.place.find(".bracket") == v.place.npos &&
                            v.place.find(".uncertainty") == v.place.npos;
      if (of_light && v.quantity && v.quantity->si != 0 && !v.whole) all.push_back(v);
    }
    return all;
  }
  // Nothing where one strength changes, which has a row of its own.
  std::optional<SensitiveInput> of(SceneValue const& value) const {
    Model const high = at(value, step), low = at(value, -step);
    MaterialChange const change = change_of(paths_.world(), high.world);
    if (!change.shape && !change.coating) return {};
    SensitiveInput in;
    in.kind = InputClass::shape;
    in.name = value.place;
    in.value = value.written;
    in.method = "by the laws at the vertices of the kept paths, at 0.98 and 1.02 times its value";
    CouplingTable const& table = run_.file.trace.coupling;
    ReweightedCouplings const more = reweighted(table, paths_, high.world), less = reweighted(table, paths_, low.world);
    if (more.meets_edge || less.meets_edge) {
      in.method = "not known: it moves an edge of the BSDF where light goes; trace it with --trace";
      in.elasticity.value.assign(budget_.grid.size(), not_a_number);
      in.elasticity.sigma = in.elasticity.value;
      return in;
    }
    in.elasticity =
        log_ratio(total_of(run_.model, more.light.table), total_of(run_.model, less.light.table), true, 2 * step);
    for (std::vector<double>* const all : {&in.elasticity.value, &in.elasticity.sigma})
      for (double& x : *all) x /= 2 * step;
    hide(in.elasticity, unknown_bins(budget_, few_paths(more, computed_anew(table, change))));
    return in;
  }

 private:
  static constexpr double step = 0.02, fewest_paths = 100;

  Model at(SceneValue const& value, double step) const { return model_of(run_.file, {times(value, std::exp(step))}); }
  static std::vector<double> few_paths(ReweightedCouplings const& r, std::vector<bool> const& computed) {
    std::vector<double> unknown = r.light.unknown;
    for (std::size_t k = 0; k < unknown.size(); ++k)
      if (r.effective[k] < fewest_paths || computed[k]) unknown[k] = 1;
    return unknown;
  }

  OpenRun const& run_;
  NoiseBudget const& budget_;
  KeptPaths paths_;
};

// Numbers of motion and interferometer that may be scaled.
std::vector<SceneValue> projected_values(OpenRun const& run) {
  std::vector<SceneValue> all;
  if (!run.projected_with.empty()) return all;  // they stand in another file
  for (SceneValue const& v : scene_values(run.model.scene)) {
    bool const table = v.place.starts_with("bodies.") || v.place.starts_with("interferometer.");
    bool const default_of_body = !v.given && v.place.starts_with("bodies.");
    if (table && v.quantity && v.quantity->si != 0 && !v.whole && !default_of_body &&
        v.place.find(".uncertainty") == v.place.npos)
      all.push_back(v);
  }
  return all;
}

bool acts(BinValues const& e) {
  return std::ranges::any_of(e.value, [](double v) { return std::isnan(v) || std::fabs(v) > least_effect; });
}

// A signal ended a trace early: the two ends of a step would have different histories.
struct TraceStopped {};

NoiseTrace traced_total(OpenRun const& run, SceneValue const& value, double factor, TraceOptions const& options) {
  Model model = model_of(run.file, {times(value, factor)});
  model.seed = run.file.trace.coupling.seed;
  model.until = {};
  model.histories = run.file.trace.coupling.histories;
  model.world.block_size = run.file.trace.coupling.block_size;
  apply(options, model);
  TracedModel const traced = trace_model(model, options, "");
  if (traced.result.checkpointed()) throw TraceStopped{};
  return total_of(model, traced.result.coupling);
}

// The largest step up to `first_step` at whose double the scene has as many surfaces at both ends; `first_step` where
// there is none.
constexpr double first_step = 0.03;

std::size_t surfaces_at(OpenRun const& run, SceneValue const& value, double step) {
  return model_of(run.file, {times(value, std::exp(step))}).world.surfaces().size();
}
bool same_surfaces(OpenRun const& run, SceneValue const& value, double step) {
  return surfaces_at(run, value, step) == surfaces_at(run, value, -step);
}
double start_step(OpenRun const& run, SceneValue const& value) {
  for (double step = first_step; step > first_step / 10; step /= 2) try {
      if (same_surfaces(run, value, 2 * step)) return step;
    } catch (InputError const&) {  // no scene so far away
      if (step / 2 <= first_step / 10) throw;
    }
  return first_step;
}

std::string method_of(TracedElasticity const& t, bool chosen, bool same) {
  std::string const step = fmt::format("{:.3g} %", 100 * t.step);
  return fmt::format("traced at {:.4g} and {:.4g} times its value with the same random numbers; step {}{}{}",
                     std::exp(-t.step), std::exp(t.step), step, chosen ? ", chosen" : "",
                     same ? "" : ": the number of surfaces changes, so that this is a finite ratio and no derivative");
}

SensitiveInput of_traces(OpenRun const& run, SceneValue const& value, std::string const& name,
                         SensitivityOrder const& order) {
  FrequencyGrid const& grid = run.model.noise.grid;
  std::vector<std::size_t> bins;
  for (double const hz : order.frequencies)
    if (grid.bin_of(hz) < grid.size()) bins.push_back(grid.bin_of(hz));
  auto const total = [&](double step) { return traced_total(run, value, std::exp(step), order.options); };
  TracedElasticity const found =
      order.step ? traced_elasticity(total, *order.step) : balanced_elasticity(total, start_step(run, value), bins);
  SensitiveInput in;
  in.kind = InputClass::traced;
  in.name = name;
  in.value = value.written;
  in.method = method_of(found, !order.step, same_surfaces(run, value, found.step));
  in.elasticity = found.elasticity;
  in.correlation = found.correlation;
  in.step = found.step;
  in.extrapolated = found.extrapolated;
  return in;
}

SceneValue value_to_trace(OpenRun const& run, std::string const& name) {
  std::vector<std::string> known;
  for (SceneValue const& v : scene_values(run.model.scene)) {
    if (v.place == name || v.place == "params." + name || v.place == "params." + name + ".value") {
      if (v.quantity && v.quantity->si == 0)
        throw InputError(fmt::format("--trace: '{}' is zero", name), "a step needs a value");
      return v;
    }
    known.push_back(v.place.starts_with("params.") ? v.place.substr(7) : v.place);
  }
  throw InputError(
      fmt::format("--trace: the scene has no value '{}'", name),
      did_you_mean(name, known, "name a parameter, or a value by its place: scene.baffle.shape.ring.inner_radius"));
}

void add_shapes(OpenRun const& run, NoiseBudget const& budget, unsigned threads, Progress const& progress,
                std::function<void(SensitiveInput)> const& add) {
  progress("kept paths, traced again");
  Shapes const shapes(run, budget, threads);
  for (SceneValue const& value : shapes.values()) {
    progress(value.place);
    try {
      if (auto in = shapes.of(value)) add(std::move(*in));
    } catch (InputError const&) {  // it cannot be changed alone, as 100 % of reflected light
    }
  }
}

// Shares of the stated standard deviations, and the band that they make, to first order (eq. D.5, D.6).
void share_out(Sensitivity& s) {
  s.band.assign(s.grid.size(), 0);
  s.sampled.assign(s.grid.size(), false);
  auto const part = [](SensitiveInput const& in, std::size_t i) {
    return std::pow(in.elasticity.value[i] * std::log(in.factor), 2);
  };
  for (SensitiveInput const& in : s.inputs)
    for (std::size_t i = 0; in.factor > 1 && i < s.band.size(); ++i) s.band[i] += part(in, i);
  for (SensitiveInput& in : s.inputs)
    for (std::size_t i = 0; in.factor > 1 && i < s.band.size(); ++i) {
      in.share.push_back(s.band[i] == 0 ? 0 : part(in, i) / s.band[i]);
      in.halving.push_back(1 - std::sqrt(1 - 0.75 * in.share.back()));
    }
  for (double& b : s.band) b = std::sqrt(b);
}

// The same by sampling where first order fails. Inputs without an effect have no part.
void sample_shares(Sensitivity& s, OpenRun const& run) {
  auto const listed = [&](std::string const& name) {
    auto const at =
        std::ranges::find_if(s.inputs, [&](SensitiveInput const& in) { return in.factor > 1 && in.name == name; });
    return at == s.inputs.end() ? nullptr : &*at;
  };
  std::vector<MaterialSpread> materials;
  std::vector<MotionCause> causes;
  std::vector<SensitiveInput*> order;
  for (MaterialSpread const& m : run.model.traced.materials)
    if (SensitiveInput* const in = listed(name_of(m))) {
      materials.push_back(m);
      order.push_back(in);
    }
  for (MotionCause const& cause : motion_causes(run.model.motion))
    if (SensitiveInput* const in = listed(cause.name)) {
      causes.push_back(cause);
      order.push_back(in);
    }
  if (order.empty()) return;
  BandShares const all = sampled_shares(
      uncertain_psd(run.file.trace.coupling, materials, run.model.motion, causes, *run.model.detector, run.model.noise),
      s.band);
  for (std::size_t i = 0; i < s.band.size(); ++i) {
    if (!all.sampled[i]) continue;
    s.sampled[i] = true;
    s.band[i] = all.band[i];
    for (std::size_t k = 0; k < order.size(); ++k) {
      order[k]->share[i] = all.share[k][i];
      order[k]->halving[i] = all.halving[k][i];
    }
  }
}

void find_deciding_bin(Sensitivity& s, ProjectionModel const& model, NoiseBudget const& budget) {
  std::size_t const first = s.grid.bin_of(s.frequencies.front());
  s.decides = first < s.grid.size() ? first : 0;
  if (model.design.empty()) return;
  DesignCurve const& line = model.design.front();
  double worst = 0;
  for (std::size_t i = 0; i < s.grid.size(); ++i)
    if (double const ratio = budget.total.asd[i] / line.asd[i]; ratio > worst) {
      worst = ratio;
      s.decides = i;
      s.line = fmt::format("{:.3g} x {}", model.noise.margin, line.name);
    }
}

double largest_at(Sensitivity const& s, SensitiveInput const& in) {
  double largest = 0;
  for (double const hz : s.frequencies)
    if (std::size_t const i = s.grid.bin_of(hz); i < s.grid.size() && std::isfinite(in.elasticity.value[i]))
      largest = std::max(largest, std::fabs(in.elasticity.value[i]));
  return largest;
}

std::vector<SceneValue> values_to_trace(OpenRun const& run, SensitivityOrder const& order,
                                        std::vector<InputError>& errors) {
  std::vector<SceneValue> all;
  for (std::string const& name : order.traced) try {
      all.push_back(value_to_trace(run, name));
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  return all;
}

void add_projected(OpenRun const& run, SensitivityOrder const& order, Progress const& progress,
                   std::function<void(SensitiveInput)> const& add, std::vector<std::string>& idle) {
  if (order.wants(InputClass::motion))
    for (MotionCause const& cause : motion_causes(run.model.motion)) {
      progress(cause.name);
      add(of_motion(run, cause));
    }
  for (SceneValue const& value : projected_values(run)) {
    if (!order.wants(value.place.starts_with("bodies.") ? InputClass::motion : InputClass::response)) continue;
    progress(value.place);
    try {
      add(of_value(run, value));
    } catch (InputError const&) {
      idle.push_back(value.place + " (cannot be changed alone)");
    }
  }
}

}  // namespace

void add_errors_of_traced(OpenRun const& run, SensitivityOrder const& order, std::vector<InputError>& errors) {
  values_to_trace(run, order, errors);
}

Sensitivity sensitivity(OpenRun const& run, SensitivityOrder const& order, Progress const& progress) {
  ProjectionModel const& model = run.model;
  if (!model.detector)
    throw InputError("without an interferometer there is no noise that could depend on anything",
                     "add 'ports' and 'interferometer' to the scene");
  std::vector<InputError> errors;
  std::vector<SceneValue> const to_trace = values_to_trace(run, order, errors);
  throw_all(errors);
  NoiseBudget const budget = model.project(run.file.trace.coupling);
  Sensitivity s;
  s.grid = model.noise.grid;
  s.frequencies = order.frequencies;
  s.total = budget.total;
  if (budget.total.without.empty())
    s.warnings.emplace_back("no route has a Monte-Carlo error: errors of elasticities are those of the traces alone");
  for (std::string const& name : budget.unresolved)
    s.warnings.push_back("unresolved, so its part of every elasticity is a hint: " + name);
  std::function<void(SensitiveInput)> const add = [&](SensitiveInput in) {
    acts(in.elasticity) ? s.inputs.push_back(std::move(in)) : s.idle.push_back(in.name);
  };
  if (order.wants(InputClass::strength))
    for (std::size_t m = 0; m < model.traced.materials.size(); ++m) {
      progress("material " + model.traced.materials[m].name);
      add(of_material(run, budget, m));
    }
  if (order.wants(InputClass::shape)) add_shapes(run, budget, order.options.threads, progress, add);
  add_projected(run, order, progress, add, s.idle);
  for (std::size_t i = 0; i < to_trace.size() && order.wants(InputClass::traced); ++i) try {
      progress(order.traced[i] + ", traced");
      s.inputs.push_back(of_traces(run, to_trace[i], order.traced[i], order));
    } catch (TraceStopped const&) {
      s.stopped = true;
      s.warnings.push_back("stopped: not traced to the end: " + order.traced[i]);
      break;
    }
  std::ranges::stable_sort(s.inputs, std::greater<>{}, [&](SensitiveInput const& in) { return largest_at(s, in); });
  share_out(s);
  sample_shares(s, run);
  find_deciding_bin(s, model, budget);
  return s;
}

}  // namespace straytrace::session
