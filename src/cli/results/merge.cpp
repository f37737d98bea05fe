// SPDX-License-Identifier: BSD-3-Clause
// straytrace merge: slices -> the complete run.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "base/text/words.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "session/jobs/job_files.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"

namespace straytrace::cli {
namespace {

struct MergeOptions : PrintOptions {
  std::vector<std::string> files;
  std::string out;
  bool partial = false, force = false;
};

void report_other_texts(RunParts const& parts, MergeOptions const& options) {
  auto const differs = [&](PartHead const& head) { return head.texts_hash != parts.heads.front().texts_hash; };
  auto const other = std::find_if(parts.heads.begin(), parts.heads.end(), differs);
  if (other == parts.heads.end()) return;
  print_warning(
      fmt::format("'{}' and '{}' were traced from different texts, for example of motion; those of '{}' go into "
                  "the run",
                  other->file, parts.heads.front().file, parts.heads.front().file),
      options);
}

void refuse_gaps(RunParts const& parts) {
  std::string text = missing_text(parts);
  text.pop_back();  // the end of its last line
  throw InputError(text, "merge again when they exist, or merge the existing parts with --partial");
}

// An existing run may contain histories that are in no part.
void refuse_loss(RunParts const& parts, MergeOptions const& options) {
  if (!earlier_run(options.out, parts.heads.front().model_hash, parts.heads.front().seed, options.force)) return;
  std::uint64_t blocks = 0;
  for (BlockRange const& range : lost_with(read_part_head(options.out), parts)) blocks += range.size();
  if (blocks > 0)
    throw InputError(fmt::format("'{}' contains {} of histories that are in no part and would be lost", options.out,
                                 counted(blocks, "block")),
                     "choose another file with -o, or overwrite it with --force");
}

TraceResult merged(RunParts const& parts, Model& model, MergeOptions const& options) {
  TraceResult result = result_of(model, merged_sums(parts), options);
  result.all_blocks = parts.all_blocks;
  result.stopped = parts.missing.empty() ? Stopped::by_histories : Stopped::by_gaps;
  for (PartHead const& head : parts.heads) result.seconds += head.seconds;
  return result;
}

int merge(MergeOptions const& options) {
  std::vector<std::string> const& files = options.files;
  RunParts const parts = read_parts(files);
  if (!parts.missing.empty() && !options.partial) refuse_gaps(parts);
  if (std::find(files.begin(), files.end(), options.out) == files.end()) refuse_loss(parts, options);
  report_other_texts(parts, options);
  RunInput const first(parts.heads.front().file);
  Model model = first.read({});
  print_warnings(model, options);
  TraceResult const result = merged(parts, model, options);
  RunContent const content = first.completed(content_of(model, result, nullptr));
  write_run(options.out, content);
  print_traced(content, model, options.out, options);
  if (!parts.missing.empty()) print_warning(missing_text(parts), options);
  if (!options.quiet)
    std::cerr << fmt::format("{}, {:.6g} histories in {}; data {}\n", counted(files.size(), "part"),
                             double(result.total.histories), options.out, data_hash(options.out).substr(0, 16));
  return done;
}

}  // namespace

void add_merge(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<MergeOptions>();
  MergeOptions& o = *options;
  auto* const command =
      app.add_subcommand("merge", "Merge the slices of a run into one run, with the same bits as an uncut run.");
  command->add_option("parts", o.files, "run files of trace --slice")->required();
  command->add_option("-o,--out", o.out, "run file to write (HDF5)")->required();
  command->add_flag("--partial", o.partial, "if parts are missing: merge the existing ones into a smaller run");
  command->add_flag("--quiet", o.quiet, "no warnings");
  add_force_option(*command, o.force);
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace merge part*.h5 -o run.h5\n"
      "  straytrace merge part*.h5 -o run.h5 --partial\n"
      "Missing slices are listed with the commands to trace them. straytrace trace run.h5 fills the gaps of a run "
      "that\n"
      "merged with --partial.");
  command->callback([options, &exit_code] { exit_code = merge(*options); });
}

}  // namespace straytrace::cli
