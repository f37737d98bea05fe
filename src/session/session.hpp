// SPDX-License-Identifier: BSD-3-Clause
// Common parts of the commands: tracing with progress and interruption, and the files of a result.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "results/results.hpp"
#include "session/model.hpp"
#include "session/options.hpp"
#include "trace/result.hpp"
#include "trace/run/trace.hpp"
#include "trace/steered_world.hpp"

namespace straytrace::trace {
class Transport;
}  // namespace straytrace::trace

namespace straytrace::session {

// Lets the command line overrule the scene: seed, histories, stop rule.
void apply(TraceOptions const&, Model&);

// How the caller follows a trace, where not by stderr and Ctrl-C.
struct TraceControl {
  Transport* transport = nullptr;                           // this process is rank 0 of several
  std::atomic<bool> const* stop = nullptr;                  // ends the trace with a valid result, in place of signals
  std::function<void(TraceProgress const&)> progress = {};  // in place of the line on stderr
  std::function<void(TraceProgress const&)> watch = {};     // besides it
  // Every second, or less often so as to take a tenth of the time at most; changes no result.
  std::function<void(TraceResult const&)> so_far = {};
};

// The world of a model as it was traced, and the result. Refers to the model.
struct TracedModel {
  SteeredWorld world;
  TraceResult result;
};
// Traces, or resumes the run file at `run_file` if it has the same model and seed. Progress goes to stderr; Ctrl-C
// finishes the blocks in progress. From time to time the blocks done so far are written to `run_file`, unless it is
// empty. Throws InputError if that would overwrite the run of another model without --force.
TracedModel trace_model(Model&, TraceOptions const&, std::string const& run_file, TraceControl const& = {});

// The result of these sums; traces nothing.
TraceResult result_of(Model&, SumTree, PrintOptions const&);

// A run without histories: the routes that are computed, with the field of the table `wave`. It can be resumed.
TraceResult nothing_traced(Model&, unsigned threads, PrintOptions const&);

// This process is rank 1 or higher: works for rank 0 until rank 0 stops it.
void work_for_rank_0(Model&, unsigned threads, Transport&);

// Throws InputError when this program would not trace the same bits as the one that wrote `about`.
void require_this_program(Provenance const& about, std::string const& file, std::string const& remedy);

// The existing run at the place of this one, if any. Throws InputError when it is of another model or seed and
// may not be overwritten (`force`), when the file there is no run, or when nothing can be written there.
std::optional<RunFile> earlier_run(std::string const& run_file, std::string const& model_hash, std::uint64_t seed,
                                   bool force);

// Locks a folder while it lives, so that two runs cannot write to it. Throws InputError when another run has the lock.
class FolderLock {
 public:
  explicit FolderLock(std::string const& folder);
  ~FolderLock();
  FolderLock(FolderLock const&) = delete;
  FolderLock& operator=(FolderLock const&) = delete;

 private:
  int descriptor_;
};

inline constexpr std::size_t merits_shown = 3;  // routes whose figure of merit is printed
inline constexpr char no_way_to_go_on[] = "stopped early; with -o FOLDER the same command would resume from here\n";
inline constexpr char how_to_go_on[] = "stopped early with a valid result; the same command resumes from here\n";

RunContent content_of(Model const&, TraceResult const&, NoiseBudget const*);
// run.h5, h_asd.txt, paths.csv, report.txt, report.png in the folder; returns failures of pictures.
std::string write_results(std::string const& folder, RunContent const&, PathTable const&, ProjectionModel const&);
// "results in FOLDER: report.png ... run.h5\n". `page`: its page, if any; `drawn`: with the picture.
std::string results_line(std::string const& folder, RunContent const&, std::string const& page, bool drawn);

// Results of a trace: coupling table, receivers, energy balance on stdout; figures of merit and next steps on stderr.
void print_traced(RunContent const&, Model const&, std::string const& run_file, PrintOptions const&);

// The summary line: total strain at 10, 30, 100 Hz with errors, and the ratio to the first design curve.
std::string headline(NoiseBudget const&, PathTable const&);

PathTable table_for(CouplingTable const&, NoiseBudget const*, ProjectionModel const&);

// Warnings about the noise, to stderr unless quiet. `where`: a point of a scan, or empty.
void print_warnings(NoiseBudget const&, PrintOptions const&, std::string const& where = {});

// A folder for results that is created before the computation and removed again without a result.

class OutputFolder {
 public:
  // Made with its parents. Throws InputError when it cannot be made or written to, or when one of the `files` it is for
  // is a folder.
  explicit OutputFolder(std::string const& name, std::vector<std::string> const& files = {});
  ~OutputFolder();  // removes the folders made that are still empty
  OutputFolder(OutputFolder const&) = delete;
  OutputFolder& operator=(OutputFolder const&) = delete;
  std::string path(std::string const& file) const { return (folder_ / file).string(); }

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  // the outermost first
};

}  // namespace straytrace::session
