// SPDX-License-Identifier: BSD-3-Clause
#include "session/jobs/job_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "session/session.hpp"

namespace straytrace::session {
namespace {

// A job ends before its time limit, and a kill loses no more than the work since the last checkpoint.
std::string times(Jobs const& jobs) {
  return fmt::format("--max-time {:.0f}s --checkpoint {:.0f}s", std::floor(jobs.seconds * 5 / 6),
                     std::ceil(std::min(1200.0, jobs.seconds / 3)));
}

std::size_t digits(std::uint64_t slices) { return std::to_string(slices).size(); }

// For a comment: its lines stay comments.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }, '?');
  return text;
}

std::string clock_time(double seconds) {
  auto const all = std::uint64_t(std::ceil(seconds));
  return fmt::format("{:02}:{:02}:{:02}", all / 3600, all / 60 % 60, all % 60);
}

std::string slurm_head(Jobs const& jobs, std::string const& what) {
  return fmt::format(
      "#!/bin/bash\n"
      "# {} of {}; made by straytrace submit, to be read and edited\n"
      "{}",
      what, one_line(jobs.scene),
      jobs.accounting.empty() ? "" : fmt::format("#SBATCH --account={}\n", jobs.accounting));
}

std::string slurm_slices(Jobs const& jobs) {
  return slurm_head(jobs, fmt::format("{} slices", jobs.slices)) +
         fmt::format(R"(#SBATCH --job-name=straytrace-slices
#SBATCH --array=1-{slices}
#SBATCH --time={time}
#SBATCH --cpus-per-task={threads}
#SBATCH --mem-per-cpu=2G
#SBATCH --output=slice_%a.log
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --signal=B:TERM@60

program={program}
part=$(printf 'part%0{digits}d.h5' "$SLURM_ARRAY_TASK_ID")

"$program" trace input.h5 --slice "$SLURM_ARRAY_TASK_ID/{slices}" -o "$part" {times} --threads {threads} --quiet >/dev/null &
trace=$!
trap 'kill -TERM "$trace"' TERM USR1 USR2   # a warning of the system: finish the blocks under way, write, exit with 85
wait "$trace"
code=$?
while kill -0 "$trace" 2>/dev/null; do   # a signal ends a wait
  wait "$trace"
  code=$?
done

# 85: stopped early with a result to resume from, so requeue the job.
if [ "$code" -eq 85 ] && [ "${{SLURM_RESTART_COUNT:-0}}" -lt 500 ]; then
  scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID" && exit 0
fi
exit "$code"
)",
                     fmt::arg("slices", jobs.slices), fmt::arg("time", clock_time(jobs.seconds)),
                     fmt::arg("threads", jobs.threads), fmt::arg("program", shell_word(jobs.program)),
                     fmt::arg("digits", digits(jobs.slices)), fmt::arg("times", times(jobs)));
}

std::string slurm_finish(Jobs const& jobs) {
  return slurm_head(jobs, "merge, noise and report") +
         fmt::format(R"(#SBATCH --job-name=straytrace-finish
#SBATCH --time=01:00:00
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=4G
#SBATCH --output=finish.log

set -e
program={}
"$program" merge part*.h5 -o run.h5
)",
                     shell_word(jobs.program)) +
         (jobs.noise ? "\"$program\" noise run.h5 -o results\n\"$program\" report results/run.h5 -o report.html\n"
                     : "\"$program\" report run.h5 -o report.html\n");
}

// A line of a submit file: no quotes, no macros, no new line.
std::string condor_path(std::string const& path) {
  if (path.find_first_of("\"'$\\\n\r\t ") == path.npos) return path;
  throw InputError(fmt::format("a submit file cannot contain the path of the program, '{}'", one_line(path)),
                   "install straytrace in a path without spaces, quotes or dollar signs");
}

std::string condor_head(Jobs const& jobs, std::string const& what, std::string const& log) {
  return fmt::format(
      "# {} of {}; made by straytrace submit, to be read and edited\n"
      "universe = vanilla\n"
      "executable = {}\n"
      "# False where all machines see the program; True sends it along, if it needs nothing that is not there.\n"
      "transfer_executable = False\n"
      "should_transfer_files = YES\n"
      "when_to_transfer_output = ON_EXIT\n"
      "log = condor.log\n"
      "output = {}.out\n"
      "error = {}.err\n"
      "{}",
      what, one_line(jobs.scene), condor_path(jobs.program), log, log,
      jobs.accounting.empty() ? "" : fmt::format("accounting_group = {}\n", jobs.accounting));
}

std::string condor_slices(Jobs const& jobs) {
  return condor_head(jobs, fmt::format("{} slices", jobs.slices), "slice_$(Process)") +
         fmt::format(R"(request_cpus = {threads}
request_memory = 2 GB
request_disk = 1 GB
number = $(Process) + 1
part = part$INT(number,%0{digits}d).h5
arguments = "trace input.h5 --slice $INT(number)/{slices} -o $(part) {times} --threads {threads} --quiet"
transfer_input_files = input.h5
transfer_output_files = $(part)
# 85: stopped early; the job keeps its part and resumes from it, here or on another machine.
checkpoint_exit_code = 85
transfer_checkpoint_files = $(part)
queue {slices}
)",
                     fmt::arg("slices", jobs.slices), fmt::arg("threads", jobs.threads),
                     fmt::arg("digits", digits(jobs.slices)), fmt::arg("times", times(jobs)));
}

struct Step {
  std::string name, arguments, in, out;
};

std::string condor_step(Jobs const& jobs, Step const& step) {
  return condor_head(jobs, step.name, step.name) + fmt::format(
                                                       "request_cpus = 1\nrequest_memory = 4 GB\nrequest_disk = 4 GB\n"
                                                       "arguments = \"{}\"\ntransfer_input_files = {}\n"
                                                       "transfer_output_files = {}\nqueue\n",
                                                       step.arguments, step.in, step.out);
}

std::vector<Step> steps_of(Jobs const& jobs) {
  std::string parts, listed;
  for (std::uint64_t i = 1; i <= jobs.slices; ++i) {
    parts += part_name(i, jobs.slices) + " ";
    listed += (i > 1 ? ", " : "") + part_name(i, jobs.slices);
  }
  std::vector<Step> steps{{"merge", fmt::format("merge {}-o run.h5 --quiet", parts), listed, "run.h5"}};
  if (jobs.noise) {
    steps.push_back({"noise", "noise run.h5 -o results --quiet", "run.h5", "results"});
    steps.push_back({"report", "report run.h5 -o report.html", "results/run.h5", "report.html"});
  } else {
    steps.push_back({"report", "report run.h5 -o report.html", "run.h5", "report.html"});
  }
  return steps;
}

constexpr char go_there[] = "#!/bin/bash\nset -euo pipefail\ncd -- \"$(dirname -- \"${BASH_SOURCE[0]}\")\"\n";

}  // namespace

std::string part_name(std::uint64_t number, std::uint64_t of) {
  return fmt::format("part{:0{}}.h5", number, digits(of));
}

NamedTexts slurm_files(Jobs const& jobs) {
  return {
      {"slices.sbatch", slurm_slices(jobs)},
      {"finish.sbatch", slurm_finish(jobs)},
      {"submit.sh", go_there + std::string("slices=$(sbatch --parsable slices.sbatch)\n"
                                           "sbatch --dependency=\"afterok:${slices%%;*}\" --kill-on-invalid-dep=yes "
                                           "finish.sbatch\n")}};
}

NamedTexts condor_files(Jobs const& jobs) {
  NamedTexts files{{"slices.sub", condor_slices(jobs)}};
  std::string dag = fmt::format("# slices, then one after the other\nJOB slices slices.sub\nRETRY slices 3\n");
  std::string before = "slices";
  for (Step const& step : steps_of(jobs)) {
    files.emplace_back(step.name + ".sub", condor_step(jobs, step));
    dag += fmt::format("JOB {0} {0}.sub\nRETRY {0} 2\nPARENT {1} CHILD {0}\n", step.name, before);
    before = step.name;
  }
  files.emplace_back("run.dag", dag);
  files.emplace_back("submit.sh", go_there + std::string("condor_submit_dag run.dag\n"));
  return files;
}

namespace {

constexpr std::size_t lines_shown = 20;

std::vector<InputError> disagreements(std::vector<PartHead> const& heads) {
  std::vector<InputError> errors;
  auto const complain = [&](std::string what, std::string remedy) {
    errors.emplace_back(std::move(what), std::move(remedy));
  };
  PartHead const& first = heads.front();
  for (PartHead const& head : heads) {
    if (errors.size() == lines_shown) break;
    try {
      require_this_program(head.provenance, head.file, "merge with that version, or trace again with this one");
    } catch (InputError const& e) {
      errors.push_back(e);
    }
    if (head.model_hash != first.model_hash)
      complain(fmt::format("'{}' has another model than '{}'", head.file, first.file),
               "remove one of them; straytrace diff shows the difference");
    else if (head.seed != first.seed)
      complain(fmt::format("'{}' has seed {}, '{}' has seed {}: their histories differ", head.file, head.seed,
                           first.file, first.seed),
               "leave one of them out");
    else if (head.block_size != first.block_size)
      complain(fmt::format("'{}' and '{}' are parts of runs with different numbers of histories: blocks of {} and {}",
                           head.file, first.file, head.block_size, first.block_size),
               "leave one of them out");
  }
  return errors;
}

std::string name_of(BlockRange const& range) {
  return range.size() == 1 ? fmt::format("block {}", range.first)
                           : fmt::format("blocks {} to {}", range.first, range.end - 1);
}

struct Held {
  BlockRange range;
  std::size_t part;
};
std::vector<Held> held_by(std::vector<PartHead> const& heads) {
  std::vector<Held> all;
  for (std::size_t i = 0; i < heads.size(); ++i)
    for (BlockRange const& range : heads[i].done) all.push_back({range, i});
  std::sort(all.begin(), all.end(), [](Held const& a, Held const& b) {
    return a.range.first != b.range.first ? a.range.first < b.range.first : a.part < b.part;
  });
  return all;
}

std::vector<InputError> overlaps(std::vector<PartHead> const& heads) {
  std::vector<InputError> errors;
  Held const* reaches = nullptr;  // furthest so far
  std::vector<Held> const all = held_by(heads);
  for (Held const& held : all) {
    if (reaches && held.range.first < reaches->range.end && errors.size() < lines_shown)
      errors.emplace_back(fmt::format("'{}' and '{}' both contain {}", heads[reaches->part].file, heads[held.part].file,
                                      name_of({held.range.first, std::min(held.range.end, reaches->range.end)})),
                          "leave one of them out");
    if (!reaches || held.range.end > reaches->range.end) reaches = &held;
  }
  return errors;
}

std::vector<BlockRange> gaps(std::vector<PartHead> const& heads, std::uint64_t all_blocks) {
  std::vector<BlockRange> missing;
  std::uint64_t next = 0;
  for (Held const& held : held_by(heads)) {
    if (held.range.first > next) missing.push_back({next, held.range.first});
    next = std::max(next, held.range.end);
  }
  if (next < all_blocks) missing.push_back({next, all_blocks});
  return missing;
}

// The slices that hold a missing block, when all parts are slices of one division; by number.
std::vector<std::uint64_t> missing_slices(RunParts const& parts) {
  Slice const division = parts.heads.front().slice;
  for (PartHead const& head : parts.heads)
    if (head.slice.of != division.of || head.all_blocks != parts.all_blocks || division.whole()) return {};
  std::vector<std::uint64_t> numbers;
  std::uint64_t number = 1;
  for (BlockRange const& gap : parts.missing)
    for (; number <= division.of; ++number) {
      BlockRange const blocks = Slice{number, division.of}.blocks(parts.all_blocks);
      if (blocks.first >= gap.end) break;
      if (blocks.end > gap.first && blocks.size() > 0 && (numbers.empty() || numbers.back() != number))
        numbers.push_back(number);
      if (blocks.end > gap.end) break;
    }
  return numbers;
}

// "part007.h5" of part 7 becomes "part012.h5" of part 12.
std::string file_like(PartHead const& head, std::uint64_t number) {
  std::filesystem::path const path(head.file);
  std::string name = path.filename().string();
  std::size_t const end = name.find_last_of("0123456789");
  std::size_t begin = end == name.npos ? 0 : end + 1;
  while (begin > 0 && name[begin - 1] >= '0' && name[begin - 1] <= '9') --begin;
  std::string const digits = end == name.npos ? "" : name.substr(begin, end + 1 - begin);
  if (!digits.empty() && digits.size() < 10 && std::stoull(digits) == head.slice.number)
    name.replace(begin, digits.size(), fmt::format("{:0{}}", number, digits.size()));
  else
    name = fmt::format("part{}.h5", number);
  return (path.parent_path() / name).string();
}

// "3, 9 to 12, 200"
std::string runs_of(std::vector<std::uint64_t> const& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", numbers[i]);
    if (last > i) text += fmt::format(" to {}", numbers[last]);
    i = last;
  }
  return text;
}

// Started slices are resumed; missing ones are traced from the model in another part.
std::vector<std::string> commands(RunParts const& parts, std::vector<std::uint64_t> const& slices) {
  std::map<std::uint64_t, PartHead const*> there;
  for (PartHead const& head : parts.heads) there[head.slice.number] = &head;
  PartHead const& model = parts.heads.front();
  std::vector<std::string> lines;
  for (std::uint64_t const number : slices)
    if (auto const begun = there.find(number); begun != there.end())
      lines.push_back(fmt::format("straytrace trace {}", shell_word(begun->second->file)));
    else
      lines.push_back(fmt::format("straytrace trace {} --slice {}/{} -o {}", shell_word(model.file), number,
                                  model.slice.of, shell_word(file_like(model, number))));
  return lines;
}

std::string listed(std::vector<std::string> const& lines) {
  std::string text;
  for (std::size_t i = 0; i < std::min(lines.size(), lines_shown); ++i) text += "  " + lines[i] + '\n';
  if (lines.size() > lines_shown) text += fmt::format("  ... and {} more\n", lines.size() - lines_shown);
  return text;
}

}  // namespace

RunParts read_parts(std::vector<std::string> const& files) {
  RunParts parts;
  std::vector<InputError> errors;
  for (std::string const& file : files) try {
      parts.heads.push_back(read_part_head(file));
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  throw_all(errors);
  throw_all(disagreements(parts.heads));
  throw_all(overlaps(parts.heads));
  auto const first = [](PartHead const& head) { return head.done.empty() ? ~0ull : head.done.front().first; };
  std::stable_sort(parts.heads.begin(), parts.heads.end(),
                   [&](PartHead const& a, PartHead const& b) { return first(a) < first(b); });
  for (PartHead const& head : parts.heads) parts.all_blocks = std::max(parts.all_blocks, head.all_blocks);
  parts.missing = gaps(parts.heads, parts.all_blocks);
  return parts;
}

std::vector<BlockRange> lost_with(PartHead const& there, RunParts const& parts) {
  std::vector<BlockRange> lost;
  std::uint64_t const end = there.done.empty() ? 0 : there.done.back().end;
  for (BlockRange const& gap : gaps(parts.heads, std::max(parts.all_blocks, end)))
    for (BlockRange const& range : there.done) {
      BlockRange const both{std::max(gap.first, range.first), std::min(gap.end, range.end)};
      if (both.first < both.end) lost.push_back(both);
    }
  return lost;
}

std::string missing_text(RunParts const& parts) {
  std::uint64_t blocks = 0;
  std::vector<std::string> ranges;
  for (BlockRange const& gap : parts.missing) {
    blocks += gap.size();
    ranges.push_back(name_of(gap));
  }
  std::string text = fmt::format("{} of {} of histories {} missing\n{}", blocks, counted(parts.all_blocks, "block"),
                                 blocks == 1 ? "is" : "are", listed(ranges));
  std::vector<std::uint64_t> const slices = missing_slices(parts);
  if (slices.empty()) return text;
  return text + fmt::format("of slices {} of {}; to trace them:\n{}", runs_of(slices), parts.heads.front().slice.of,
                            listed(commands(parts, slices)));
}

SumTree merged_sums(RunParts const& parts) {
  SumTree tree;
  for (PartHead const& head : parts.heads) {
    SumTree const part = read_part_sums(head.file);
    for (auto const& [place, sums] : part.nodes()) tree.add(place.second, place.first >> place.second, sums);
  }
  return tree;
}

}  // namespace straytrace::session
