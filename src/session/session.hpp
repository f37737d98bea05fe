// SPDX-License-Identifier: BSD-3-Clause
// What the commands share: tracing with progress and interruption, and the files of a result.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "results/results.hpp"
#include "session/model.hpp"
#include "session/options.hpp"
#include "trace/result.hpp"
#include "trace/steered_world.hpp"

namespace straytrace::trace {
class Transport;
}  // namespace straytrace::trace

namespace straytrace::session {

// Lets the command line overrule the scene: seed, histories, stop rule.
void apply(TraceOptions const&, Model&);

// The world of a model as it was traced, and the result. Refers to the model.
struct TracedModel {
  SteeredWorld world;
  TraceResult result;
};
// Traces, or resumes the run file at `run_file` if it has the same model and seed. Progress goes to stderr; Ctrl-C
// finishes the blocks under way. From time to time the blocks done so far are written to `run_file`, unless it is
// empty. Throws InputError if that would overwrite the run of another model without --force. `transport`: rank 0 of
// several.
TracedModel trace_model(Model&, TraceOptions const&, std::string const& run_file, Transport* transport = nullptr);

// The result of these sums; traces nothing.
TraceResult result_of(Model&, SumTree, PrintOptions const&);

// This process is rank 1 or higher: works for rank 0 until rank 0 stops it.
void work_for_rank_0(Model&, unsigned threads, Transport&);

// Throws InputError when this program would not trace the same bits as the one that wrote `about`.
void require_this_program(Provenance const& about, std::string const& file, std::string const& remedy);

// The run that stands where this one will be written, if any. Throws InputError when it is of another model or seed and
// may not be overwritten (`force`), or when nothing can be written there.
std::optional<RunFile> earlier_run(std::string const& run_file, std::string const& model_hash, std::uint64_t seed,
                                   bool force);

// Holds a folder as long as it lives, so that two runs cannot write into one. Throws InputError when another holds it.
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
// run.h5, h_asd.txt, paths.csv, report.txt, report.png in the folder; returns what could not be drawn.
std::string write_results(std::string const& folder, RunContent const&, PathTable const&, ProjectionModel const&);

// What a trace has found: coupling table, receivers, energy balance on stdout; merits, and what to do next, on stderr.
void print_traced(RunContent const&, Model const&, std::string const& run_file, PrintOptions const&);

// The line that matters: total strain at 10, 30, 100 Hz with errors, and the ratio to the first design curve.
std::string headline(NoiseBudget const&, PathTable const&);

PathTable table_for(CouplingTable const&, NoiseBudget const*, ProjectionModel const&);

// What a reader of the noise must know, to stderr unless that is to be quiet. `where`: a point of a scan, or empty.
void print_warnings(NoiseBudget const&, PrintOptions const&, std::string const& where = {});

// A folder for results that is there before anything is computed, and gone again when nothing came of it.

class OutputFolder {
 public:
  // Made with its parents. Throws InputError when it cannot be made or written to, or when one of the `files` it is for
  // is a folder.
  explicit OutputFolder(std::string const& name, std::vector<std::string> const& files = {});
  ~OutputFolder();  // removes what was made and is still empty
  OutputFolder(OutputFolder const&) = delete;
  OutputFolder& operator=(OutputFolder const&) = delete;
  std::string path(std::string const& file) const { return (folder_ / file).string(); }

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  // the outermost first
};

}  // namespace straytrace::session
