// SPDX-License-Identifier: BSD-3-Clause
#include "app/session.hpp"

#include <fmt/format.h>
#include <sys/file.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fcntl.h>
#include <filesystem>
#include <iostream>
#include <unistd.h>

#include "app/build_info.hpp"
#include "app/events.hpp"
#include "app/ghost_noise.hpp"
#include "app/interrupt.hpp"
#include "app/tell.hpp"
#include "base/message.hpp"
#include "report/growing_file.hpp"
#include "report/picture.hpp"
#include "trace/edges.hpp"
#include "trace/estimate/importance.hpp"
#include "trace/trace.hpp"

namespace straytrace {
namespace {

std::string duration(double seconds) {
  if (!(seconds < 1e6)) return "days";
  return seconds < 90 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
}

std::string progress_line(TraceProgress const& p, StopRule const& rule) {
  double left = double(p.wanted_histories - std::min(p.wanted_histories, p.histories)) / p.histories_per_s;
  std::string goal = fmt::format("{:.3g} of {:.3g} histories", double(p.histories), double(p.wanted_histories));
  if (rule.by_error()) {
    double const want = p.wanted_error, ratio = p.error / want;
    goal = std::isfinite(p.error) ? fmt::format("error {:.1f} %  (want {:g} %)", 100 * p.error, 100 * want)
                                  : fmt::format("(want {:g} %)", 100 * want);
    if (std::isfinite(ratio)) left = std::min(left, p.seconds * std::max(ratio * ratio * 1.4 - 1, 0.2));
    if (std::isnan(p.error)) left = infinity;
  }
  if (std::isfinite(rule.max_seconds)) {
    if (!rule.by_error()) goal = fmt::format("{} asked for", duration(rule.max_seconds));
    left = std::fmin(left, std::fmax(rule.max_seconds - p.seconds, 0));
  }
  std::string const time = std::isfinite(left) ? "about " + duration(left) + " left" : "";
  return fmt::format("trace  {}  {:.3g} histories  {:.2g} histories/s  {:.2g} rays/s  {}", goal, double(p.histories),
                     p.histories_per_s, p.rays_per_s, time);
}

// The blocks already traced for this model and seed.
void resume_earlier(Model const& model, Options const& options, std::string const& run_file, TraceSettings& settings) {
  auto const found = earlier_run(run_file, model.hash(), model.seed, options.force);
  if (!found) return;
  RunFile const& earlier = *found;
  if (earlier.about.provenance.version != build_info::version || earlier.about.provenance.commit != build_info::commit)
    throw InputError(
        fmt::format("error: '{}' was traced by straytrace {} ({}), this is {} ({}): their histories are not mixed\n"
                    "  choose another place with -o, or trace it anew with --force",
                    run_file, earlier.about.provenance.version, earlier.about.provenance.commit, build_info::version,
                    build_info::commit));
  if (!options.quiet)
    std::cerr << fmt::format("going on from {:.3g} histories in '{}'\n", double(earlier.trace.total.histories),
                             run_file);
  // Looks count only when they were at the same noise: a rule about h_total depends on motion and detector as well.
  if (earlier.trace.stop_rule == settings.stop_rule && earlier.about.files == model.scene.files() &&
      earlier.about.overrides == model.scene.overrides())
    settings.good_looks = earlier.trace.good_looks;
  settings.resume = earlier.trace.tree;
  settings.seconds_before = earlier.trace.seconds;
}

}  // namespace

void make_folder(std::string const& name) {
  std::error_code code;
  std::filesystem::create_directories(name, code);
  if (code || !std::filesystem::is_directory(name, code))
    throw InputError(fmt::format("error: cannot make the folder '{}': {}\n  choose another one with -o", name,
                                 code ? code.message() : "a file has this name"));
}

FolderLock::FolderLock(std::string const& folder) : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY)) {
  if (descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(descriptor_);
    throw InputError(
        fmt::format("error: another run is writing to '{}'\n  wait for it, or choose another one with -o", folder));
  }
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::optional<RunFile> earlier_run(std::string const& run_file, std::string const& model_hash, std::uint64_t seed,
                                   bool force) {
  std::filesystem::path const folder = std::filesystem::path(run_file).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder))
    throw InputError(fmt::format(
        "error: there is no folder '{}' to write to\n  make it first, or choose another one with -o", folder.string()));
  if (std::filesystem::is_directory(run_file))
    throw InputError(fmt::format("error: '{}' is a folder\n  name a file with -o, for example -o {}", run_file,
                                 (std::filesystem::path(run_file) / "run.h5").lexically_normal().string()));
  GrowingFile const can_be_written(run_file);  // or hours of tracing would be lost
  if (force || !std::filesystem::exists(run_file)) return {};
  RunFile earlier;
  try {
    earlier = read_run(run_file);
  } catch (InputError const& e) {
    throw InputError(fmt::format("error: {}\n  choose another place with -o, or overwrite it with --force", e.what()));
  }
  if (earlier.about.model_hash != model_hash || earlier.trace.coupling.seed != seed)
    throw InputError(
        fmt::format("error: '{}' holds a run of another model or seed; nothing was run\n"
                    "  choose another place with -o, or overwrite it with --force",
                    run_file));
  return earlier;
}

void apply(Options const& options, Model& model) {
  if (options.seed) model.seed = *options.seed;
  if (!options.until.empty()) {
    model.until = parse_stop_rule(options.until);
    if (auto const complaint = complaint_about(model.until, model))
      throw InputError(fmt::format("error: --until: {}\n  {}", complaint->what, complaint->suggestion));
    if (model.until.by_error() && !model.histories_stated) model.histories = no_limit;
  }
  if (options.histories) {
    model.histories = *options.histories;
    if (options.until.empty()) model.until = {};
  }
  if (options.max_seconds > 0) model.until.max_seconds = std::min(model.until.max_seconds, options.max_seconds);
}

TraceResult trace_model(Model& model, Options const& options, std::string const& run_file) {
  TraceSettings settings;
  settings.stop_rule = model.until.error_rule;
  resume_earlier(model, options, run_file, settings);
  settings.seed = model.seed;
  settings.histories = model.histories;
  settings.threads = options.threads;
  settings.max_seconds = model.until.max_seconds;
  if (model.until.by_error()) {
    settings.wanted_error = model.until.wanted_error();
    settings.error = [&](CouplingTable const& table) { return stop_rule_error(model.until, model, table); };
  }
  EdgeClasses const edges = edge_classes(model.world);
  settings.beside = edges.classes;
  GhostClasses ghosts;
  if (auto const wanted = read_ghosts(model.scene)) ghosts = ghosts_beside(model.world, *wanted);
  settings.beside.insert(settings.beside.end(), ghosts.classes.begin(), ghosts.classes.end());
  steer(model.world);
  ProgressLine progress(options.quiet);
  settings.progress = [&](TraceProgress const& p) {
    if (events_told()) return tell_progress(p, progress_line(p, model.until));
    progress.at(p.seconds, [&] { return progress_line(p, model.until); });
  };
  InterruptGuard const guard;
  settings.stop = &guard.stop();
  TraceResult result = trace(model.world, settings, *make_backend("cpu"));
  result.warnings.insert(result.warnings.end(), edges.warnings.begin(), edges.warnings.end());
  result.warnings.insert(result.warnings.end(), ghosts.warnings.begin(), ghosts.warnings.end());
  for (std::string const& warning : result.warnings) tell_warning(warning, options);
  return result;
}

}  // namespace straytrace
