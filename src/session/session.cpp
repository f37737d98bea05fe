// SPDX-License-Identifier: BSD-3-Clause
#include "session/session.hpp"

#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <unistd.h>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "results/receivers/receivers.hpp"
#include "results/route_table/route_sums.hpp"
#include "results/run_file/run_file.hpp"
#include "results/text/columns.hpp"
#include "results/text/picture.hpp"
#include "session/build_info.hpp"
#include "session/interrupt.hpp"
#include "session/light/cavity_waves.hpp"
#include "session/light/ghost_search.hpp"
#include "session/light/lit_table.hpp"
#include "session/open_run.hpp"
#include "trace/deterministic/edges.hpp"
#include "trace/deterministic/halo.hpp"
#include "trace/deterministic/wave_rims.hpp"
#include "trace/importance/importance.hpp"
#include "trace/run/ranks.hpp"
#include "trace/run/trace.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {
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
  std::string goal, count = fmt::format("{:.3g} histories", double(p.histories));
  if (rule.by_error()) {
    double const want = p.wanted_error, seen = double(p.error_histories);
    goal = std::isfinite(p.error) ? fmt::format("error {:.2g} % at {:.3g}", 100 * p.error, seen)
           : std::isnan(p.error)  ? "no error yet"
                                  : fmt::format("unresolved at {:.3g}", seen);
    goal += fmt::format("  (want {:g} %)  ", 100 * want);
    left = infinity;
    if (std::isfinite(p.error)) {  // it falls as the root, and must hold at two checks a factor 1.4 apart
      double const needed = std::max(seen * std::pow(p.error / want, 2), double(p.histories)) * std::sqrt(2.0);
      left = (std::min(needed, double(p.wanted_histories)) - double(p.histories)) / p.histories_per_s;
    }
  }
  if (std::isfinite(rule.max_seconds)) {
    if (!rule.by_error()) goal = fmt::format("at most {}  ", duration(rule.max_seconds));
    left = std::fmin(left, std::fmax(rule.max_seconds - p.seconds, 0));
  }
  std::string const time = std::isfinite(left) ? "about " + duration(left) + " left" : "";
  if (goal.empty()) count = fmt::format("{:.3g} of {:.3g} histories", double(p.histories), double(p.wanted_histories));
  return fmt::format("trace  {}{}  {:.2g} histories/s  {:.2g} rays/s  {}", goal, count, p.histories_per_s, p.rays_per_s,
                     time);
}

// The blocks already traced for this model and seed. Few histories are traced in smaller blocks, which a longer run
// cannot take over.
void resume_earlier(Model& model, TraceOptions const& options, std::string const& run_file, TraceSettings& settings) {
  auto const found = earlier_run(run_file, model.hash(), model.seed, options.force);
  if (!found) return;
  RunFile const& earlier = *found;
  if (earlier.about.waves) model.waves = earlier.about.waves;
  model.seam = earlier.about.seam;
  require_this_program(earlier.about.provenance, run_file, "choose another file with -o, or trace again with --force");
  std::uint64_t& size = model.world.block_size;
  std::uint64_t const size_before = earlier.trace.coupling.block_size, histories = earlier.trace.total.histories;
  Slice const& before = earlier.trace.slice;
  BlockRange const now = settings.slice.blocks(blocks_of(settings.histories, size));
  if (before.number != settings.slice.number || before.of != settings.slice.of ||
      (!before.whole() && (size_before != size || !(before.blocks(earlier.trace.all_blocks) == now))))
    throw InputError(fmt::format("'{}' contains {}, which is not {}", run_file,
                                 name_of(before, earlier.trace.all_blocks * size_before),
                                 name_of(settings.slice, settings.histories)),
                     "choose another file with -o, or overwrite it with --force; straytrace merge combines parts");
  // Checks count only for the same noise: a rule about h_total also depends on motion and detector.
  if (earlier.trace.stop_rule == settings.stop_rule && earlier.about.files == model.scene.files() &&
      earlier.about.overrides == model.scene.overrides())
    settings.good_checks = earlier.trace.good_checks;
  bool const enough = histories >= settings.histories || settings.good_checks >= 2,
             anew = size != size_before && !enough;
  if (!options.quiet)
    std::cerr << (anew ? fmt::format(
                             "the {:.3g} histories in '{}' are a complete small run: a longer one starts again\n",
                             double(histories), run_file)
                       : fmt::format("resuming from {:.3g} histories in '{}'\n", double(histories), run_file));
  if (anew) {
    settings.good_checks = 0;
    return;
  }
  size = size_before;
  settings.resume = earlier.trace.tree;
  settings.seconds_before = earlier.trace.seconds;
}

// The deterministic classes of a world, with their coherence and bounds.
struct DeterministicLight {
  std::vector<CouplingClass> classes;
  std::vector<std::string> warnings;

  DeterministicLight(Model& model, unsigned threads, PrintOptions const& options) {
    EdgeClasses edges = edge_classes(model.world);
    classes = std::move(edges.classes);
    warnings = std::move(edges.warnings);
    if (model.world.wave.present && model.world.wave.ring)
      warnings.push_back(
          "wave: the field of a cavity of three mirrors or more adds no noise; 'straytrace wave' prints its losses and "
          "levers");
    else if (model.world.wave.present) {
      ArmWaves const waves = solved_or_known(model, threads, options);
      std::vector<CouplingClass> rims = wave_rim_classes(model.world, waves);
      std::ranges::copy(waves.arm.warnings, std::back_inserter(warnings));
      if (rims.empty()) warnings.push_back("wave: no inner edge couples light into a port; the field adds no noise");
      std::ranges::move(rims, std::back_inserter(classes));
      light_halo(model, true, threads, options);
      HaloClasses halo = halo_classes(model.world, waves);
      std::ranges::move(halo.classes, std::back_inserter(classes));
      std::ranges::move(halo.warnings, std::back_inserter(warnings));
    }
    if (counts_rims(model.scene)) {
      MovingRimClasses rims = moving_rim_classes(model.world);
      std::ranges::move(rims.classes, std::back_inserter(classes));
      std::ranges::move(rims.warnings, std::back_inserter(warnings));
    }
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

constexpr double seconds_between_looks = 1;  // of TraceControl::so_far

// A full disk is no reason to stop: the previous file remains.
void save(std::string const& run_file, RunContent const& content, PrintOptions const& options) {
  try {
    write_run(run_file, content);
  } catch (InputError const& e) {
    print_warning(
        fmt::format(
            "no checkpoint was written: {}\n  the trace continues; free disk space, or it ends without a result",
            e.reason()),
        options);
  }
}

// Damaged runs may be overwritten, and empty files; nothing else is, since no run is lost there but data of the user.
void refuse_other_content(std::string const& run_file) {
  constexpr std::string_view mark = "straytrace-run ";
  std::string const head = head_of_file(run_file, mark.size());
  if (head.empty() || head == mark) return;
  throw InputError(fmt::format("'{}' exists and is not a run file of straytrace; it is not overwritten, even with "
                               "--force",
                               run_file),
                   "choose another name with -o, or remove the file first");
}

// Must be equal on all ranks.
std::string identity_of(Model const& model) {
  return fmt::format("{} {} {} {}", model.hash(), model.seed, build_info::version, build_info::commit);
}
Ranks ranks_of(Transport& transport, Model const& model) {
  return {transport, identity_of(model), nodes_image, nodes_of_image};
}

}  // namespace

FolderLock::FolderLock(std::string const& folder) : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY)) {
  if (descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(descriptor_);
    throw InputError(fmt::format("another run is writing to '{}'", folder),
                     "wait for it, or choose another one with -o");
  }
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::optional<RunFile> earlier_run(std::string const& run_file, std::string const& model_hash, std::uint64_t seed,
                                   bool force) {
  if (std::filesystem::is_directory(run_file))
    throw InputError(fmt::format("'{}' is a folder", run_file),
                     fmt::format("name a file with -o, for example -o {}",
                                 (std::filesystem::path(run_file) / "run.h5").lexically_normal().string()));
  check_writable(run_file);  // or hours of tracing would be lost
  refuse_other_content(run_file);
  if (force || !std::filesystem::exists(run_file)) return {};
  RunFile earlier;
  try {
    earlier = read_run(run_file);
  } catch (InputError const& e) {
    throw InputError(e.reason(), "choose another place with -o, or overwrite it with --force");
  }
  if (earlier.about.model_hash != model_hash || earlier.trace.coupling.seed != seed)
    throw InputError(fmt::format("'{}' contains a run of another model or seed; nothing was run", run_file),
                     "choose another place with -o, or overwrite it with --force");
  return earlier;
}

void apply(TraceOptions const& options, Model& model) {
  if (options.seed) model.seed = *options.seed;
  if (!options.until.empty()) {
    model.until = parse_stop_rule(options.until);
    if (auto const complaint = complaint_about(model.until, model))
      throw InputError(fmt::format("--until: {}", complaint->what), complaint->suggestion);
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
  throw InputError(fmt::format("'{}' was traced by straytrace {} ({}), this is {} ({}): their histories are not mixed",
                               file, about.version, about.commit, build_info::version, build_info::commit),
                   remedy);
}

namespace {

TraceSettings settings_of(Model& model, TraceOptions const& options, std::string const& run_file) {
  TraceSettings settings;
  settings.stop_rule = model.until.error_rule;
  settings.histories = model.histories;
  settings.slice = {options.slice, options.slices};
  resume_earlier(model, options, run_file, settings);
  settings.seed = model.seed;
  settings.max_seconds = model.until.max_seconds;
  if (model.until.by_error()) {
    settings.wanted_error = model.until.wanted_error();
    settings.error = [&model](CouplingTable const& table) { return stop_rule_error(model.until, model, table); };
  }
  return settings;
}

}  // namespace

TracedModel trace_model(Model& model, TraceOptions const& options, std::string const& run_file,
                        TraceControl const& control) {
  InterruptGuard const guard(control.stop);
  if (model.histories < fewest_histories)
    print_warning(
        fmt::format("{} histories are too few for an error\n  ask for {} or more", model.histories, fewest_histories),
        options);
  TraceSettings settings = settings_of(model, options, run_file);
  auto const backend = make_backend(control.transport ? "cpu" : options.backend);
  settings.threads = options.threads > 0 ? options.threads : backend->callers();
  DeterministicLight const beside(model, options.threads, options);
  settings.deterministic = beside.classes;
  SteeredWorld world = steer(model.world, options.threads);
  ProgressLine progress(options.quiet);
  settings.progress = [&](TraceProgress const& p) {
    if (control.watch) control.watch(p);
    if (control.progress) return control.progress(p);
    if (events_on()) return print_progress(p, progress_line(p, model.until));
    progress.at(p.seconds, [&] { return progress_line(p, model.until); });
  };
  settings.stop = &guard.stop();
  if (!run_file.empty()) settings.checkpoint_seconds = options.checkpoint_seconds;
  double const between_files = settings.checkpoint_seconds;
  if (control.so_far) settings.checkpoint_seconds = std::min(between_files, seconds_between_looks);
  double saved = 0;  // s of the trace
  settings.checkpoint = [&](TraceResult const& so_far) {
    TraceResult const result = beside.completed(so_far);
    if (control.so_far) control.so_far(result);
    double const now = so_far.seconds - settings.seconds_before;
    if (control.so_far && now - saved < between_files) return;
    save(run_file, content_of(model, result, nullptr), options);
    saved = now;
  };
  std::optional<Ranks> ranks;
  if (control.transport) {
    ranks.emplace(ranks_of(*control.transport, model));
    if (starts_in_field(model)) ranks->data = wave_image(*model.waves);
  }
  settings.ranks = ranks ? &*ranks : nullptr;
  TraceResult result = beside.completed(trace_to_rule(world, settings, *backend));
  model.world.block_size = world.block_size = result.coupling.block_size;
  if (model.seam && model.seam->histories != histories_of_seam(result.coupling.histories)) model.seam.reset();
  for (std::string const& warning : result.warnings) print_warning(warning, options);
  return {world, std::move(result)};
}

TraceResult result_of(Model& model, SumTree tree, PrintOptions const& options) {
  DeterministicLight const beside(model, 0, options);
  TraceSettings settings;
  settings.seed = model.seed;
  settings.deterministic = beside.classes;
  TraceResult result = beside.completed(result_of(steer(model.world), settings, std::move(tree)));
  for (std::string const& warning : result.warnings) print_warning(warning, options);
  return result;
}

TraceResult nothing_traced(Model& model, unsigned threads, PrintOptions const& options) {
  DeterministicLight const beside(model, threads, options);
  TraceSettings settings;
  settings.seed = model.seed;
  settings.deterministic = beside.classes;
  TraceResult result = beside.completed(result_of(SteeredWorld::as_given(model.world), settings, SumTree{}));
  result.all_blocks = blocks_of(model.histories, model.world.block_size);
  result.stopped = Stopped::by_gaps;
  return result;
}

void work_for_rank_0(Model& model, unsigned threads, Transport& transport) {
  InterruptGuard const guard;
  Ranks const ranks = ranks_of(transport, model);
  if (starts_in_field(model)) {
    std::optional<std::string> const field = data_of_rank_0(ranks);
    if (!field) return;
    model.waves = std::make_shared<WaveRecord const>(wave_of_image(*field));
  }
  light_halo(model, true, threads, {});
  SteeredWorld const world = steer(model.world, threads);
  TraceSettings settings;
  settings.seed = model.seed;
  settings.threads = threads;
  settings.stop = &guard.stop();
  work_for_rank_0(world, settings, *make_backend("cpu"), ranks);
}

PathTable table_for(CouplingTable const& coupling, NoiseBudget const* budget, ProjectionModel const& model) {
  return path_table(coupling, budget, budget ? &model.motion : nullptr, {});
}

RunContent content_of(Model const& model, TraceResult const& traced, NoiseBudget const* budget) {
  RunContent content;
  content.files = model.scene.files();
  content.main_file = model.scene.main_file();
  content.title = model.scene.title();
  content.overrides = model.scene.overrides();
  content.resolved = model.scene.resolved();
  content.model_hash = model.hash();
  content.interferometer = model.detector ? model.detector->description() : "";
  if (!model.warnings.empty()) content.warnings.push_back(model.warnings);
  content.receivers = model.world.receivers();
  for (Receiver const& r : content.receivers) content.map_areas.push_back(map_areas(model.world.view(), r.surface, r));
  content.importance = importance_map(model.world);
  content.beam_power = model.world.beam_power;
  if (model.arm) content.waves = model.waves;
  if (model.ring) content.ring = model.ring_waves;
  content.seam = model.seam;
  content.projection = model.traced;
  content.provenance.version = build_info::version;
  content.provenance.commit = build_info::commit;
  content.provenance.build_flags = build_info::flags;
  content.provenance.created = utc_now();
  content.trace = &traced;
  content.noise = budget;
  return content;
}

std::string write_results(std::string const& folder, RunContent const& content, PathTable const& paths,
                          ProjectionModel const& model) {
  write_run(folder + "/run.h5", content);
  std::vector<std::pair<std::string, std::string>> texts{
      {folder + "/paths.csv", path_csv(paths, content)},
      {folder + "/report.txt", text_report(content, paths, model.paths_shown, model.assumptions())}};
  if (content.noise) texts.emplace_back(folder + "/h_asd.txt", asd_text(content));
  if (!content.receivers.empty())
    texts.emplace_back(folder + "/receivers.csv", receiver_csv(receiver_table(content), content));
  write_files(texts);
  std::string message;
  return draw_picture(folder + "/run.h5", folder + "/report.png", message) ? "" : message;
}

std::string results_line(std::string const& folder, RunContent const& content, std::string const& page, bool drawn) {
  return fmt::format("results in {}:{}{} report.txt{} paths.csv{} run.h5\n", folder, page.empty() ? "" : " " + page,
                     drawn ? " report.png" : "", content.noise ? " h_asd.txt" : "",
                     content.receivers.empty() ? "" : " receivers.csv");
}

void print_traced(RunContent const& content, Model const& model, std::string const& run_file,
                  PrintOptions const& options) {
  PathTable const paths = table_for(content.trace->coupling, nullptr, model);
  if (options.json()) {
    std::cout << path_json(paths, content) << '\n';
  } else {
    if (model.detector) std::cout << path_text(paths, model.paths_shown) << '\n';
    if (!content.receivers.empty()) std::cout << receiver_text(receiver_table(content), model.paths_shown) << '\n';
    std::cout << "Where the light went\n\n" << energy_balance_text(content) << '\n' << objects_text(content);
  }
  if (options.quiet) return;
  std::cerr << merit_text(merits(content), merits_shown);
  if (model.detector)
    std::cerr << fmt::format("coupling table in {}; project motion with: straytrace noise {}\n", run_file, run_file);
  else
    std::cerr << fmt::format("light on receivers in {}; more with: straytrace paths {} --census\n", run_file, run_file);
}

void print_warnings(NoiseBudget const& budget, PrintOptions const& options, std::string const& where) {
  for (std::string const& warning : budget.warnings)
    print_warning(fmt::format("{}{}{}", where, where.empty() ? "" : ": ", warning), options);
}

// Reason for a total that is zero everywhere. Motion outside the band causes no noise in it while its phase is small.
static std::string silence(NoiseBudget const& budget) {
  if (budget.routes.empty()) return "no traced light has rejoined a port: trace more histories, or check the ports";
  double phase = 0;
  for (NoiseTrace const& t : budget.routes) phase = std::max(phase, std::sqrt(t.mean_square_phase));
  if (!(phase > 0)) return "stray light causes no strain noise here: nothing on its routes moves";
  return fmt::format(
      "stray light causes no strain noise between {:g} and {:g} Hz: bodies on its routes move at other "
      "frequencies, by {:.2g} rad rms at most, which does not wrap into this band",
      budget.grid.edges.front(), budget.grid.edges.back(), phase);
}

std::string headline(NoiseBudget const& budget, PathTable const& paths) {
  std::string values, at, ratios, lines;
  auto const outside = [&](double f) {
    return budget.grid.size() > 0 && !(f >= budget.grid.edges.front() && f < budget.grid.edges.back());
  };
  bool const nowhere = std::all_of(paths.frequencies.begin(), paths.frequencies.end(), outside);
  for (std::size_t i = 0; i < paths.frequencies.size(); ++i) {
    double const f = paths.frequencies[i];
    if (outside(f) && !nowhere) continue;
    char const* const comma = values.empty() ? "" : ", ";
    at += fmt::format("{}{:g}", comma, f);
    values += comma + with_error(paths.total_strain[i]);
    if (!std::isnan(paths.lines[i].rms.value))
      lines += fmt::format("; at {:g} Hz a line of {} rms", f, with_error(paths.lines[i].rms));
    if (budget.design.empty()) continue;
    double const design = design_at(budget.design.front(), budget.grid, f);
    ratios += comma + with_error(paths.total_strain[i].over(design));
  }
  if (budget.total.resolved &&
      std::all_of(budget.total.asd.begin(), budget.total.asd.end(), [](double h) { return h == 0; }))
    return silence(budget);
  std::string line = fmt::format("stray light h = {} /sqrt(Hz) at {} Hz", values, at);
  if (!ratios.empty()) line += fmt::format("; over {}: {}", budget.design.front().name, ratios);
  line += lines;
  if (paths.missing() == 0) return line;
  return line + fmt::format("  ({})", bound_text(paths.has_upper_bounds(), paths.missing()));
}

namespace {

namespace fs = std::filesystem;

// Folders alone, and empty ones.
void remove_empty(std::vector<fs::path> const& folders) {
  for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder) ::rmdir(folder->c_str());
}

// With its parents; returns why it was not made.
std::string make(fs::path const& folder, std::vector<fs::path>& made) {
  fs::path above;
  int error = 0;  // of the last part
  for (fs::path const& part : fs::absolute(folder)) {
    above /= part;
    error = ::mkdir(above.c_str(), 0777) == 0 ? 0 : errno;
    if (error == 0) made.push_back(above);
  }
  std::error_code code;
  if (fs::is_directory(folder, code)) return "";
  if (fs::is_symlink(folder, code)) return "a link has this name, but its target does not exist";
  return fs::exists(folder, code) ? "a file has this name" : std::strerror(error);
}

[[noreturn]] void refuse_folder(std::string const& verb, fs::path const& folder, std::string const& why) {
  throw InputError(fmt::format("cannot {} the folder '{}': {}", verb, folder.string(), why),
                   "choose another one with -o");
}

}  // namespace

OutputFolder::OutputFolder(std::string const& name, std::vector<std::string> const& files) : folder_(name) {
  if (std::string const why = make(folder_, made_); !why.empty()) {
    remove_empty(made_);
    refuse_folder("make", folder_, why);
  }
  if (::faccessat(AT_FDCWD, folder_.c_str(), W_OK | X_OK, AT_EACCESS) != 0) {
    std::string const why = std::strerror(errno);
    remove_empty(made_);
    refuse_folder("write to", folder_, why);
  }
  std::error_code ignored;
  for (std::string const& file : files)
    if (fs::is_directory(folder_ / file, ignored))
      refuse_folder("write to", folder_, fmt::format("'{}' is a folder", file));
}

OutputFolder::~OutputFolder() { remove_empty(made_); }

}  // namespace straytrace::session
