// SPDX-License-Identifier: BSD-3-Clause
// straytrace submit: files for a batch system that traces a scene in slices. Nothing is submitted.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "base/process/child_process.hpp"
#include "base/text/pattern.hpp"
#include "base/text/words.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/run_file/run_file.hpp"
#include "session/jobs/job_files.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"
#include "trace/run/trace.hpp"

namespace straytrace::cli {
namespace {

namespace fs = std::filesystem;

constexpr double most_jobs = 50000;          // names of all parts fit into one command line of 2 MB
constexpr std::uint64_t usual_array = 1000;  // default MaxArraySize of Slurm

struct SubmitOptions : TraceOptions {
  std::string out;
  std::uint64_t jobs = 0;
  std::string accounting;
  double seconds = 3600;
};

void refuse_what_has_no_slices(Model const& model, std::uint64_t jobs) {
  if (model.until.by_error())
    throw InputError(fmt::format("the stop rule '{}' needs the histories of all jobs, but each job has only its own",
                                 model.until.error_rule),
                     "give the total number of histories, for example --histories 1e9");
  std::uint64_t const blocks = blocks_of(model.histories, model.world.block_size);
  if (jobs > blocks)
    throw InputError(fmt::format("{} histories are {} of {}: too few for {} jobs", model.histories,
                                 counted(blocks, "block"), model.world.block_size, jobs),
                     fmt::format("write --jobs {} or more --histories", blocks));
}

void check_accounting(std::string const& group) {
  if (group.empty() || Pattern("[A-Za-z0-9_.@/+-]+").match(group)) return;
  throw InputError(fmt::format("--accounting '{}' is not a valid name of an account", group),
                   "letters, digits and . _ - + @ / are allowed");
}

// A job needs time to read the scene and to write its part; no cluster allows a year.
double job_time(std::string const& text) {
  double const seconds = parse_duration(text);
  if (seconds >= 60 && seconds <= 366 * 86400.0) return seconds;
  throw InputError(fmt::format("--time '{}': a job takes between 1min and 8784h", text), "write for example 50min");
}

// Parts in the folder must be those of the same division: their jobs resume them.
void check_parts(std::string const& folder, Model const& model, std::uint64_t jobs) {
  std::error_code none;
  for (auto const& entry : fs::directory_iterator(folder, none)) {
    std::string const name = entry.path().filename().string();
    if (!name.starts_with("part") || !name.ends_with(".h5")) continue;
    PartHead const head = read_part_head(entry.path().string());
    require_this_program(head.provenance, head.file, "choose another folder with -o, or remove the old parts");
    if (head.model_hash == model.hash() && head.seed == model.seed && head.slice.of == jobs &&
        head.slice.blocks(head.all_blocks) == head.slice.blocks(blocks_of(model.histories, model.world.block_size)))
      continue;
    throw InputError(
        fmt::format("'{}' is of another run, or of another number of jobs or histories", entry.path().string()),
        "choose another folder with -o, or remove the old parts");
  }
}

// The scene with all included files and parameters in one file: a run without histories.
void write_input(std::string const& file, RunInput const& earlier, Model const& model) {
  TraceSettings settings;
  settings.seed = model.seed;
  TraceResult nothing = result_of(SteeredWorld::as_given(model.world), settings, SumTree{});
  nothing.all_blocks = blocks_of(model.histories, model.world.block_size);
  nothing.stopped = Stopped::by_gaps;
  write_run(file, earlier.completed(content_of(model, nothing, nullptr)));
}

int submit(SubmitOptions const& options) {
  check_accounting(options.accounting);
  RunInput const earlier(options.input);
  Model model = earlier.read_to_the_end(options.overrides);
  apply(options, model);
  refuse_what_has_no_slices(model, options.jobs);
  print_warnings(model, options);
  Jobs jobs;
  jobs.slices = options.jobs;
  jobs.program = program_file().string();
  jobs.scene = options.input;
  jobs.accounting = options.accounting;
  jobs.seconds = options.seconds;
  jobs.threads = std::max(1u, options.threads);
  jobs.noise = model.detector != nullptr;
  NamedTexts files = options.backend == "slurm" ? slurm_files(jobs) : condor_files(jobs);
  std::vector<std::string> names{"input.h5"};
  for (auto const& [name, text] : files) names.push_back(name);
  OutputFolder const folder(options.out, names);
  earlier_run(folder.path("input.h5"), model.hash(), model.seed, options.force);
  check_parts(options.out, model, options.jobs);
  write_input(folder.path("input.h5"), earlier, model);
  for (auto& [name, text] : files) name = folder.path(name);
  write_files(files);
  std::cout << "bash " << shell_word(folder.path("submit.sh")) << '\n';
  if (options.backend == "slurm" && jobs.slices > usual_array)
    print_warning(fmt::format("{} jobs exceed the default limit of a Slurm array\n  compare MaxArraySize of: scontrol "
                              "show config; or take --jobs {}",
                              jobs.slices, usual_array),
                  options);
  if (options.quiet) return done;
  names.erase(names.begin());
  std::cerr << fmt::format(
      "{} of {:.4g} histories; nothing was submitted. Check {} in {}, edit them, then run the "
      "command above\n",
      counted(jobs.slices, "job"), double(model.histories) / double(jobs.slices), fmt::join(names, ", "), options.out);
  return done;
}

}  // namespace

void add_submit(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<SubmitOptions>();
  SubmitOptions& o = *options;
  auto* const command = app.add_subcommand("submit", "Write files for Slurm or HTCondor to trace a scene in slices.");
  add_scene_options(*command, o, "scene file (YAML), or run file (HDF5)");
  command->add_option("--backend", o.backend, "slurm or condor")->required()->check(CLI::IsMember({"slurm", "condor"}));
  command->add_option("--jobs", o.jobs, "number of slices, one job each")
      ->required()
      ->check(whole_between(1, most_jobs, "200"));
  command->add_option("-o,--out", o.out, "folder for the files and the results")->required();
  add_history_options(*command, o);
  command->add_option_function<std::string>(
      "--time", [options](std::string const& text) { options->seconds = job_time(text); },
      "limit of one job, for example 50min; the run continues in another job; default 1h");
  command->add_option("--threads", o.threads, "threads of a job; default 1")->check(whole_between(1, 1024, "4"));
  command->add_option("--accounting", o.accounting, "account or accounting group");
  add_force_option(*command, o.force);
  command->footer(
      "Examples:\n"
      "  straytrace submit examples/virgo_arm.yaml --backend slurm --jobs 200 --histories 1e10 -o jobs/\n"
      "  straytrace submit examples/virgo_arm.yaml --backend condor --jobs 200 --histories 1e10 -o jobs/ "
      "--accounting virgo.prod.o4\n"
      "Nothing is submitted: check and edit the files, then run the printed command.");
  command->callback([options, &exit_code] {
    drop_slashes(options->out);
    exit_code = submit(*options);
  });
}

}  // namespace straytrace::cli
