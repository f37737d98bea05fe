// SPDX-License-Identifier: BSD-3-Clause
#include "session/jobs/job_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "session/jobs/job_files.hpp"

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

}  // namespace straytrace::session
