// SPDX-License-Identifier: BSD-3-Clause
// The front for C: each function calls that of straytrace.hpp, and keeps the texts that it gives.
#include <nlohmann/json.hpp>

#include "base/text/json_text.hpp"
#include "straytrace/straytrace.h"
#include "straytrace/straytrace.hpp"

using nlohmann::json;
using namespace straytrace::api;

struct straytrace_model {
  Model model;
  std::string about;
};

struct straytrace_run {
  Run run;
  std::string about;
};

struct straytrace_noise {
  Noise noise;
  std::string about, paths;
};

namespace {

struct LastError {
  int kind = 0;
  std::string text, table = "[]";
};
thread_local LastError last;

std::string text_of(json const& table) { return straytrace::json_text(table); }

std::string table_of(std::vector<Problem> const& problems) {
  json list = json::array();
  for (Problem const& p : problems)
    list.push_back({{"file", p.file},
                    {"line", p.line},
                    {"column", p.column},
                    {"severity", p.warning ? "warning" : "error"},
                    {"what", p.what},
                    {"suggestion", p.suggestion}});
  return text_of(list);
}

// The result of `function`, or null after an error.
template <class Function>
auto guarded(Function&& function) -> decltype(function()) {
  try {
    return function();
  } catch (InputError const& e) {
    last = {STRAYTRACE_INPUT_ERROR, e.what(), table_of(e.problems())};
  } catch (NumericalError const& e) {
    last = {STRAYTRACE_NUMERICAL_ERROR, e.what(), "[]"};
  } catch (std::exception const& e) {
    last = {STRAYTRACE_OTHER_ERROR, e.what(), "[]"};
  }
  return nullptr;
}

std::string or_empty(char const* text) { return text ? text : ""; }

std::vector<std::string> list_of(char const* const* words) {
  std::vector<std::string> all;
  for (; words && *words; ++words) all.emplace_back(*words);
  return all;
}

TraceSettings settings_of(straytrace_trace_settings const& given) {
  TraceSettings settings;
  if (given.seed) settings.seed = *given.seed;
  if (given.histories) settings.histories = given.histories;
  settings.until = or_empty(given.until);
  settings.threads = given.threads;
  settings.max_seconds = given.max_seconds;
  if (given.progress)
    settings.progress = [&given](Progress const& p) {
      straytrace_progress const state{p.histories, p.wanted_histories, p.seconds, p.histories_per_s,
                                      p.error,     p.wanted_error};
      return given.progress(&state, given.context) != 0;
    };
  return settings;
}

straytrace_run* new_run(Run run) {
  json const about = {{"title", run.title()},
                      {"seed", run.seed()},
                      {"histories", run.histories()},
                      {"complete", run.complete()},
                      {"warnings", run.warnings()}};
  return new straytrace_run{std::move(run), text_of(about)};
}

json pair_of(Value const& x) { return {x.value, x.sigma}; }

json columns_of(PathTable const& table) {
  json all = json::object();
  for (char const* name : {"rank", "port", "sequence", "coupling", "upper_bound", "resolved", "why_not", "share",
                           "strain", "body", "phase_sensitivity", "mean_length"})
    all[name] = json::array();
  for (Path const& p : table.rows) {
    all["rank"].push_back(p.rank);
    all["port"].push_back(p.port);
    all["sequence"].push_back(p.sequence);
    all["coupling"].push_back(pair_of(p.coupling));
    all["upper_bound"].push_back(p.upper_bound);
    all["resolved"].push_back(p.resolved);
    all["why_not"].push_back(p.why_not);
    all["share"].push_back(pair_of(p.share));
    json strain = json::array();
    for (Value const& h : p.strain) strain.push_back(pair_of(h));
    all["strain"].push_back(std::move(strain));
    all["body"].push_back(p.body);
    all["phase_sensitivity"].push_back(p.phase_sensitivity);
    all["mean_length"].push_back(p.mean_length);
  }
  return all;
}

}  // namespace

char const* straytrace_version() {
  static std::string const text = version();
  return text.c_str();
}

int straytrace_error() { return last.kind; }
char const* straytrace_error_text() { return last.text.c_str(); }
char const* straytrace_error_table() { return last.table.c_str(); }

straytrace_model* straytrace_read(char const* file, char const* text, char const* const* set) {
  return guarded([&] {
    Model model = text ? Model::of_text(text, file, list_of(set)) : Model::read(file, list_of(set));
    json const about = {{"title", model.title()},      {"hash", model.hash()},           {"bodies", model.bodies()},
                        {"ports", model.ports()},      {"receivers", model.receivers()}, {"surfaces", model.surfaces()},
                        {"warnings", model.warnings()}};
    return new straytrace_model{std::move(model), text_of(about)};
  });
}
char const* straytrace_model_about(straytrace_model const* model) { return model->about.c_str(); }
void straytrace_free_model(straytrace_model* model) { delete model; }

straytrace_run* straytrace_trace(straytrace_model const* model, straytrace_trace_settings const* settings) {
  return guarded([&] { return new_run(model->model.trace(settings ? settings_of(*settings) : TraceSettings{})); });
}
straytrace_run* straytrace_open(char const* file) {
  return guarded([&] { return new_run(Run::open(file)); });
}
straytrace_run const* straytrace_save(straytrace_run const* run, char const* file) {
  return guarded([&] {
    run->run.save(file);
    return run;
  });
}
char const* straytrace_run_about(straytrace_run const* run) { return run->about.c_str(); }
void straytrace_free_run(straytrace_run* run) { delete run; }

straytrace_noise* straytrace_project(straytrace_run const* run, char const* motion, char const* motion_text,
                                     char const* const* set) {
  return guarded([&] {
    Noise noise = run->run.noise({or_empty(motion), list_of(set), or_empty(motion_text)});
    json design = json::array();
    for (DesignCurve const& curve : noise.design) design.push_back(curve.name);
    json const about = {{"headline", noise.headline},
                        {"unresolved", noise.unresolved},
                        {"warnings", noise.warnings},
                        {"design", std::move(design)}};
    return new straytrace_noise{std::move(noise), text_of(about), ""};
  });
}
char const* straytrace_noise_about(straytrace_noise const* noise) { return noise->about.c_str(); }

double const* straytrace_array(straytrace_noise const* noise, char const* name, size_t* size) {
  Noise const& n = noise->noise;
  std::vector<double> const* found = nullptr;
  std::string const wanted = name;
  for (auto const& [own, values] : {std::pair{"edges", &n.edges},
                                    {"frequency", &n.frequency},
                                    {"asd", &n.asd},
                                    {"sigma", &n.sigma},
                                    {"input_low", &n.input_low},
                                    {"input_high", &n.input_high}})
    if (wanted == own) found = values;
  for (DesignCurve const& curve : n.design)
    if (!found && wanted == curve.name) found = &curve.asd;
  *size = found ? found->size() : 0;
  return found ? found->data() : nullptr;
}

char const* straytrace_paths(straytrace_noise* noise, double const* frequencies, size_t count, double low,
                             double high) {
  return guarded([&]() -> char const* {
    PathSettings settings;
    settings.frequencies.assign(frequencies, frequencies + count);
    settings.low = low;
    settings.high = high;
    noise->paths = text_of(columns_of(noise->noise.paths(settings)));
    return noise->paths.c_str();
  });
}
void straytrace_free_noise(straytrace_noise* noise) { delete noise; }
