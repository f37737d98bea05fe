// SPDX-License-Identifier: BSD-3-Clause
// The C++ library include/straytrace/straytrace.hpp over the functions of `session`.
#include <atomic>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "base/errors.hpp"
#include "results/curves/band.hpp"
#include "scene/scene_document.hpp"
#include "session/build_info.hpp"
#include "session/decide/what_if.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"
#include "straytrace/straytrace.hpp"

namespace straytrace::api {

InputError as_public(straytrace::InputError const&);

template <class Function>
auto with_public_errors(Function&& function) {
  try {
    return std::forward<Function>(function)();
  } catch (straytrace::InputError const& e) {
    throw as_public(e);
  } catch (straytrace::NumericalError const& e) {
    throw NumericalError(e.what());
  }
}

// What the objects of the library hold, and texts that they read in place of files.

struct Model::Source {
  session::Model model;
};

struct Run::Source {
  RunFile file;
};

// A text in place of a file, while this object lives.
class TextInPlace {
 public:
  TextInPlace(std::string name, std::string const& text) : name_(std::move(name)) { scene::set_unsaved(name_, text); }
  ~TextInPlace() { scene::forget_unsaved(name_); }
  TextInPlace(TextInPlace const&) = delete;
  TextInPlace& operator=(TextInPlace const&) = delete;

 private:
  std::string name_;
};

std::string version() { return build_info::version; }

InputError::InputError(std::string const& text, std::vector<Problem> found)
    : std::runtime_error(text), problems_(std::make_shared<std::vector<Problem> const>(std::move(found))) {}
InputError::~InputError() = default;
NumericalError::~NumericalError() = default;

InputError as_public(straytrace::InputError const& e) {
  std::vector<Problem> found;
  for (straytrace::Problem const& p : e.problems) {
    bool const placed = p.place.line > 0 && p.place.file < e.files.size();
    found.push_back({placed ? e.files[p.place.file] : "", p.place.line, p.place.column, p.severity == Severity::warning,
                     p.what, p.suggestion});
  }
  return {e.what(), std::move(found)};
}

namespace {

std::mutex working;  // the flag that stops a trace is that of the whole process

// The scene once more, from the texts that the first reading kept: tracing changes a model.
session::Model read_again(session::Model const& model) {
  return read_model(model.scene.main_file(), model.scene.overrides(), &model.scene.files());
}

TraceOptions options_of(TraceSettings const& settings) {
  TraceOptions options;
  options.quiet = true;
  options.seed = settings.seed;
  options.histories = settings.histories;
  options.until = settings.until;
  options.threads = settings.threads;
  options.max_seconds = settings.max_seconds;
  options.force = settings.overwrite;
  return options;
}

Progress as_public(TraceProgress const& p) {
  return {p.histories, p.wanted_histories, p.seconds, p.histories_per_s, p.error, p.wanted_error};
}

}  // namespace

Model::Model(std::shared_ptr<Source const> source) : source_(std::move(source)) {}

Model Model::read(std::string const& file, std::vector<std::string> const& set) {
  return with_public_errors([&] {
    std::lock_guard const alone(working);
    return Model(std::make_shared<Source const>(Source{read_model(file, set)}));
  });
}

Model Model::of_text(std::string const& text, std::string const& name, std::vector<std::string> const& set) {
  return with_public_errors([&] {
    std::lock_guard const alone(working);
    TextInPlace const held(name, text);
    return Model(std::make_shared<Source const>(Source{read_model(name, set)}));
  });
}

std::string Model::title() const { return source_->model.scene.title(); }
std::string Model::hash() const { return source_->model.hash(); }
std::vector<std::string> Model::bodies() const { return source_->model.traced.bodies; }
std::vector<std::string> Model::ports() const { return source_->model.world.ports(); }
std::vector<std::string> Model::receivers() const { return source_->model.world.receiver_names(); }
std::size_t Model::surfaces() const { return source_->model.world.surfaces().size(); }
std::string Model::warnings() const { return source_->model.warnings; }

Run Model::trace(TraceSettings const& settings) const {
  return with_public_errors([&] {
    std::lock_guard const alone(working);
    session::Model model = read_again(source_->model);
    TraceOptions const options = options_of(settings);
    apply(options, model);
    std::atomic<bool> stop = false;
    TraceControl control;
    control.stop = &stop;
    control.progress = [&](TraceProgress const& p) {
      if (settings.progress && !settings.progress(as_public(p))) stop = true;
    };
    auto traced = trace_model(model, options, settings.run_file, control);
    RunFile file;
    file.about = content_of(model, traced.result, nullptr);
    file.about.trace = nullptr;
    file.complete = !traced.result.checkpointed();
    file.trace = std::move(traced.result);
    if (!settings.run_file.empty()) write_run(settings.run_file, file.content());
    return Run(std::make_shared<Run::Source const>(Run::Source{std::move(file)}));
  });
}

// What a table of paths needs besides the curves.
struct Noise::Budget {
  OpenRun run;
  std::optional<WhatIf> changed;  // with other inputs than those of the run
  NoiseBudget noise;

  Budget(RunFile const& file, NoiseSettings const& settings) : run(file, settings.motion) {
    if (!run.model.detector)
      throw straytrace::InputError("this run has light on receivers but no port into an interferometer: no noise",
                                   "give the scene a port, and trace it again");
    if (!settings.set.empty()) changed.emplace(what_if(run, settings.set));
    noise = model().project_with_bands(light());
  }
  ProjectionModel const& model() const { return changed ? changed->model : run.model; }
  CouplingTable const& light() const { return changed ? changed->light : run.file.trace.coupling; }
};

namespace {

constexpr std::size_t rows_printed = std::numeric_limits<std::size_t>::max();

Value as_public(WithError const& x) { return {x.value, x.sigma}; }

Path as_public(PathRow const& row) {
  Path path;
  path.rank = row.rank;
  path.port = row.port;
  path.sequence = row.sequence;
  path.coupling = {row.coupling.mean, row.coupling.std_error};
  path.upper_bound = row.upper_bound();
  path.resolved = row.resolved;
  path.why_not = row.why_not;
  path.share = as_public(row.share);
  for (WithError const& h : row.strain) path.strain.push_back(as_public(h));
  path.body = row.body;
  path.phase_sensitivity = row.sensitivity();
  path.mean_length = row.length_mean;
  return path;
}

PathTable as_public(results::PathTable const& table) {
  PathTable all;
  all.frequencies = table.frequencies;
  for (PathRow const& row : table.rows) all.rows.push_back(as_public(row));
  all.text = path_text(table, rows_printed);
  return all;
}

Noise as_public(NoiseBudget const& budget) {
  Noise noise;
  noise.edges = budget.grid.edges;
  for (std::size_t i = 0; i < budget.grid.size(); ++i) noise.frequency.push_back(budget.grid.centre(i));
  noise.asd = budget.total.asd;
  noise.sigma = budget.total.sigma;
  noise.input_low = budget.bands.input_low;
  noise.input_high = budget.bands.input_high;
  for (noise::DesignCurve const& d : budget.design) noise.design.push_back({d.name, d.asd});
  noise.unresolved = budget.unresolved;
  noise.warnings = budget.warnings;
  return noise;
}

}  // namespace

Run::Run(std::shared_ptr<Source const> source) : source_(std::move(source)) {}

Run Run::open(std::string const& file) {
  return with_public_errors([&] { return Run(std::make_shared<Source const>(Source{read_run_file(file)})); });
}

void Run::save(std::string const& file) const {
  with_public_errors([&] {
    OpenRun const run(source_->file);
    RunContent content = run.file.content();
    std::optional<NoiseBudget> noise;
    if (!content.noise && run.model.detector) {
      noise = run.model.project_with_bands(run.file.trace.coupling);
      content.noise = &*noise;
    }
    write_run(file, content);
  });
}

std::string Run::title() const { return source_->file.about.title; }
std::uint64_t Run::seed() const { return source_->file.trace.coupling.seed; }
std::uint64_t Run::histories() const { return source_->file.trace.total.histories; }
bool Run::complete() const { return source_->file.complete; }
std::vector<std::string> Run::warnings() const { return source_->file.content().all_warnings(); }

Noise Run::noise(NoiseSettings const& settings) const {
  return with_public_errors([&] {
    std::optional<TextInPlace> held;
    if (!settings.motion_text.empty()) held.emplace(settings.motion, settings.motion_text);
    auto const budget = std::make_shared<Noise::Budget const>(source_->file, settings);
    Noise noise = as_public(budget->noise);
    for (std::string const& warning : {budget->run.model.warnings, budget->changed ? budget->changed->warning : ""})
      if (!warning.empty()) noise.warnings.push_back(warning);
    noise.headline = headline(budget->noise, table_for(budget->light(), &budget->noise, budget->model()));
    noise.budget_ = budget;
    return noise;
  });
}

PathTable Run::paths() const {
  return with_public_errors([&] { return as_public(path_table(source_->file.trace.coupling, nullptr, nullptr, {})); });
}

Value Noise::at(double hz) const {
  if (!budget_) return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  return as_public(strain_at(budget_->noise.total, budget_->noise.grid, hz));
}

PathTable Noise::paths(PathSettings const& settings) const {
  return with_public_errors([&] {
    if (!budget_) throw straytrace::InputError("this noise is of no run", "take that of Run::noise()");
    TableSettings const table{settings.frequencies, settings.low, settings.high};
    return as_public(path_table(budget_->light(), &budget_->noise, &budget_->model().motion, table));
  });
}

}  // namespace straytrace::api
