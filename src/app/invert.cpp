// SPDX-License-Identifier: BSD-3-Clause
#include "app/invert.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <regex>

#include "app/invert_text.hpp"
#include "app/open_run.hpp"
#include "app/output_folder.hpp"
#include "app/tell.hpp"
#include "base/form.hpp"
#include "base/message.hpp"
#include "noise/inversion.hpp"
#include "world/scattered_share.hpp"

namespace straytrace {
namespace {

// What a one-run inversion needs.
struct Traced {
  std::unique_ptr<RunFile> file;  // of a run: the model refers to its texts
  Model model;
  CouplingTable coupling;
  bool complete = true;
};

// Refuses before anything is traced.
void ask(Requirement const& requirement, Model& model, Options const& options) {
  apply(requirement, model);
  tell_warnings(model, options);
  if (!model.detector)
    throw InputError(
        "error: a requirement needs noise, and the scene has no 'interferometer'\n  add one, with 'ports'");
  if (model.design.empty())
    throw InputError("error: there is no line to stay under\n  name a design curve, for example --against adv-lal");
}

Traced traced(Options const& options, Requirement const& requirement) {
  Traced t;
  if (options.input.ends_with(".h5")) {
    t.file = std::make_unique<RunFile>(read_run(options.input));
    t.model = model_of(*t.file);
    ask(requirement, t.model, options);
    t.coupling = std::move(t.file->trace.coupling);
  } else {
    t.model = read_model(options.input, options.overrides);
    apply(options, t.model);
    ask(requirement, t.model, options);
    std::string const run = options.out.empty() ? "" : options.out + "/run.h5";
    std::optional<OutputFolder> folder;
    if (!options.out.empty()) folder.emplace(options.out);
    TraceResult result = trace_model(t.model, options, run);
    t.complete = !result.checkpointed();
    if (!run.empty()) write_run(run, content_of(t.model, result, nullptr));
    t.coupling = std::move(result.coupling);
  }
  return t;
}

[[noreturn]] void refuse_name(std::string const& word, char const* kind, std::vector<std::string> const& known) {
  std::string const near = nearest_word(word, known);
  throw InputError(fmt::format(
      "error: --invert: there is no {} '{}' here\n  {}", kind, word,
      near.empty() ? fmt::format("known: {}", fmt::join(known, ", ")) : fmt::format("did you mean '{}'?", near)));
}

Answer scatter_answer(Traced const& t, std::string const& name, Options const& options) {
  std::vector<std::string> names;
  for (MaterialSpread const& m : material_spreads(t.model.world)) names.push_back(m.name);
  for (MaterialSpread const& m : material_spreads(t.model.world)) {
    if (m.name != name) continue;
    NoiseBudget const budget = t.model.project(t.coupling);
    tell_warnings(budget, options);
    Answer a = answer_about(t.model, budget, invert_scatter(budget, t.coupling, m, line_of(t.model)));
    for (MaterialInfo const& info : t.model.world.materials)
      if (info.name == name) a.tis = scattered_share(t.model.world, info);
    a.subject = Answer::Subject::scatter;
    return a;
  }
  refuse_name(name, "material that scatters", names);
}

Answer motion_answer(Traced const& t, std::string const& name, Options const& options) {
  std::vector<std::string> const& bodies = t.model.motion.bodies;
  auto const hit = std::find(bodies.begin(), bodies.end(), name);
  if (hit == bodies.end()) refuse_name(name, "body", bodies);
  BodyId const body{std::uint32_t(hit - bodies.begin())};
  NoiseBudget const budget = t.model.project(t.coupling);
  tell_warnings(budget, options);
  auto const at = [&](double scale) {
    return project_noise(t.coupling, with_scaled_body(t.model.motion, body, scale), *t.model.detector, t.model.noise)
        .total;
  };
  Answer a = answer_about(t.model, budget, invert_motion(at, line_of(t.model)));
  a.subject = Answer::Subject::motion;
  a.motion = root_spectrum(t.model.motion, body, t.model.noise.grid);
  return a;
}

void print(Answer const& a, Options const& options, bool per_frequency) {
  std::cout << (options.json() ? answer_json(a) : answer_text(a, per_frequency));
}

}  // namespace

int invert(Options const& options, Requirement const& requirement, InvertOrder const& order,
           std::vector<ScanAxis> const& axes) {
  static std::regex const form(R"(\s*(brdf|motion|param)\s*\(\s*(.+?)\s*\)\s*)");
  std::smatch m;
  if (!has_form(order.what, m, form))
    throw InputError(
        fmt::format("error: --invert: '{}' is not a question\n  write \"brdf(MATERIAL)\", \"motion(BODY)\" "
                    "or \"param(NAME)\" with NAME=lo..hi",
                    order.what));
  std::string const kind = m[1], name = m[2];
  if (kind == "param") return invert_parameter(options, requirement, order, name, axes);
  if (!axes.empty())
    throw InputError(fmt::format("error: --invert \"{}\" looks at one model\n  set parameters with -p", order.what));
  Traced const t = traced(options, requirement);
  Answer answer = kind == "brdf" ? scatter_answer(t, name, options) : motion_answer(t, name, options);
  answer.what = order.what;
  answer.complete = t.complete;
  print(answer, options, order.per_frequency);
  return t.complete ? done : checkpointed;
}

}  // namespace straytrace
