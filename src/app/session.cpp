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
#include "base/growing_file.hpp"
#include "base/message.hpp"
#include "report/picture.hpp"
#include "report/run_part.hpp"
#include "trace/early_looks.hpp"
#include "trace/edges.hpp"
#include "trace/estimate/importance.hpp"
#include "trace/ranks.hpp"
#include "trace/trace.hpp"

namespace straytrace {
namespace {

std::string name_of(Slice const& slice, std::uint64_t histories) {
  if (slice.whole()) return "a whole run";
  return fmt::format("slice {}/{} of {} histories", slice.number, slice.of, histories);
}

std::string duration(double seconds) {
  if (!(seconds < 1e6)) return "days";
  return seconds < 90 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
}

std::string progress_line(TraceProgress const& p, StopRule const& rule) {
  double left = double(p.wanted_histories - std::min(p.wanted_histories, p.histories)) / p.histories_per_s;
  std::string goal = fmt::format("{:.3g} of {:.3g} histories", double(p.histories), double(p.wanted_histories));
  if (rule.by_error()) {
    double const want = p.wanted_error, seen = double(p.error_histories);
    goal = std::isfinite(p.error) ? fmt::format("error {:.2g} % at {:.3g}", 100 * p.error, seen)
           : std::isnan(p.error)  ? "no look yet"
                                  : fmt::format("something unresolved at {:.3g}", seen);
    goal += fmt::format("  (want {:g} %)", 100 * want);
    left = infinity;
    if (std::isfinite(p.error)) {  // it falls as the root, and must be seen twice, at looks a factor 1.4 apart
      double const needed = std::max(seen * std::pow(p.error / want, 2), double(p.histories)) * std::sqrt(2.0);
      left = (std::min(needed, double(p.wanted_histories)) - double(p.histories)) / p.histories_per_s;
    }
  }
  if (std::isfinite(rule.max_seconds)) {
    if (!rule.by_error()) goal = fmt::format("{} asked for", duration(rule.max_seconds));
    left = std::fmin(left, std::fmax(rule.max_seconds - p.seconds, 0));
  }
  std::string const time = std::isfinite(left) ? "about " + duration(left) + " left" : "";
  return fmt::format("trace  {}  {:.3g} histories  {:.2g} histories/s  {:.2g} rays/s  {}", goal, double(p.histories),
                     p.histories_per_s, p.rays_per_s, time);
}

// The blocks already traced for this model and seed. Few histories are traced in smaller blocks, which a longer run
// cannot take over.
void resume_earlier(Model& model, Options const& options, std::string const& run_file, TraceSettings& settings) {
  auto const found = earlier_run(run_file, model.hash(), model.seed, options.force);
  if (!found) return;
  RunFile const& earlier = *found;
  require_this_program(earlier.about.provenance, run_file,
                       "choose another place with -o, or trace it anew with --force");
  std::uint64_t& size = model.world.block_size;
  std::uint64_t const size_before = earlier.trace.coupling.block_size, histories = earlier.trace.total.histories;
  Slice const& before = earlier.trace.slice;
  BlockRange const now = settings.slice.blocks(blocks_of(settings.histories, size));
  if (before.number != settings.slice.number || before.of != settings.slice.of ||
      (!before.whole() && (size_before != size || !(before.blocks(earlier.trace.all_blocks) == now))))
    throw InputError(
        fmt::format("error: '{}' holds {}, which is not {}\n  choose another place with -o, or overwrite "
                    "it with --force; parts become one run by straytrace merge",
                    run_file, name_of(before, earlier.trace.all_blocks * size_before),
                    name_of(settings.slice, settings.histories)));
  // Looks count only when they were at the same noise: a rule about h_total depends on motion and detector as well.
  if (earlier.trace.stop_rule == settings.stop_rule && earlier.about.files == model.scene.files() &&
      earlier.about.overrides == model.scene.overrides())
    settings.good_looks = earlier.trace.good_looks;
  bool const enough = histories >= settings.histories || settings.good_looks >= 2,
             anew = size != size_before && !enough;
  if (!options.quiet)
    std::cerr << (anew ? fmt::format("the {:.3g} histories in '{}' are a whole small run: a longer one begins anew\n",
                                     double(histories), run_file)
                       : fmt::format("going on from {:.3g} histories in '{}'\n", double(histories), run_file));
  if (anew) {
    settings.good_looks = 0;
    return;
  }
  size = size_before;
  settings.resume = earlier.trace.tree;
  settings.seconds_before = earlier.trace.seconds;
}

// What stands beside the walk, with what must be known of it.
struct Beside {
  std::vector<CouplingClass> classes;
  std::vector<std::string> warnings;

  explicit Beside(Model const& model) {
    EdgeClasses edges = edge_classes(model.world);
    classes = std::move(edges.classes);
    warnings = std::move(edges.warnings);
    GhostClasses ghosts;
    if (auto const wanted = read_ghosts(model.scene)) ghosts = ghosts_beside(model.world, *wanted);
    classes.insert(classes.end(), ghosts.classes.begin(), ghosts.classes.end());
    warnings.insert(warnings.end(), ghosts.warnings.begin(), ghosts.warnings.end());
  }
  TraceResult completed(TraceResult result) const {
    result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
    return result;
  }
};

// A full disk is no reason to stop: the file that stood there still does.
void save(std::string const& run_file, RunContent const& content, Options const& options) {
  try {
    write_run(run_file, content);
  } catch (InputError const& e) {
    std::string why = e.what();  // "error: what\n  remedy"
    why.resize(std::min(why.find('\n'), why.size()));
    if (why.starts_with("error: ")) why.erase(0, 7);
    tell_warning(
        fmt::format("no checkpoint was written: {}\n  the trace goes on; make room or it ends without a result", why),
        options);
  }
}

// What must be the same on all ranks.
std::string identity_of(Model const& model) {
  return fmt::format("{} {} {} {}", model.hash(), model.seed, build_info::version, build_info::commit);
}

}  // namespace

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
  if (options.histories || model.until.by_error()) model.world.block_size = block_size_of(model.histories);
  if (options.max_seconds > 0) model.until.max_seconds = std::min(model.until.max_seconds, options.max_seconds);
}

void require_this_program(Provenance const& about, std::string const& file, std::string const& remedy) {
  if (about.version == build_info::version && about.commit == build_info::commit) return;
  throw InputError(
      fmt::format("error: '{}' was traced by straytrace {} ({}), this is {} ({}): their histories are not mixed\n  {}",
                  file, about.version, about.commit, build_info::version, build_info::commit, remedy));
}

TraceResult trace_model(Model& model, Options const& options, std::string const& run_file, Transport* transport) {
  InterruptGuard const guard;
  if (model.histories < fewest_histories)
    tell_warning(
        fmt::format("{} histories are too few for an error\n  ask for {} or more", model.histories, fewest_histories),
        options);
  TraceSettings settings;
  settings.stop_rule = model.until.error_rule;
  settings.histories = model.histories;
  settings.slice = {options.slice, options.slices};
  resume_earlier(model, options, run_file, settings);
  settings.seed = model.seed;
  auto const backend = make_backend(transport ? "cpu" : options.backend);
  settings.threads = options.threads > 0 ? options.threads : backend->callers();
  settings.max_seconds = model.until.max_seconds;
  if (model.until.by_error()) {
    settings.wanted_error = model.until.wanted_error();
    settings.error = [&](CouplingTable const& table) { return stop_rule_error(model.until, model, table); };
  }
  Beside const beside(model);
  settings.beside = beside.classes;
  steer(model.world, options.threads);
  ProgressLine progress(options.quiet);
  settings.progress = [&](TraceProgress const& p) {
    if (events_told()) return tell_progress(p, progress_line(p, model.until));
    progress.at(p.seconds, [&] { return progress_line(p, model.until); });
  };
  settings.stop = &guard.stop();
  if (!run_file.empty()) settings.checkpoint_seconds = options.checkpoint_seconds;
  settings.checkpoint = [&](TraceResult const& so_far) {
    TraceResult const result = beside.completed(so_far);
    save(run_file, content_of(model, result, nullptr), options);
  };
  std::optional<Ranks> ranks;
  if (transport) ranks.emplace(Ranks{*transport, identity_of(model), nodes_image, nodes_of_image});
  settings.ranks = ranks ? &*ranks : nullptr;
  TraceResult result = beside.completed(trace_to_rule(model.world, settings, *backend));
  for (std::string const& warning : result.warnings) tell_warning(warning, options);
  return result;
}

TraceResult result_of(Model& model, SumTree tree, Options const& options) {
  Beside const beside(model);
  TraceSettings settings;
  settings.seed = model.seed;
  settings.beside = beside.classes;
  steer(model.world, options.threads);
  TraceResult result = beside.completed(result_of(model.world, settings, std::move(tree)));
  for (std::string const& warning : result.warnings) tell_warning(warning, options);
  return result;
}

void work_for_rank_0(Model& model, Options const& options, Transport& transport) {
  InterruptGuard const guard;
  steer(model.world, options.threads);
  TraceSettings settings;
  settings.seed = model.seed;
  settings.threads = options.threads;
  settings.stop = &guard.stop();
  work_for_rank_0(model.world, settings, *make_backend("cpu"),
                  {transport, identity_of(model), nodes_image, nodes_of_image});
}

}  // namespace straytrace
