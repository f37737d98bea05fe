// SPDX-License-Identifier: BSD-3-Clause
#include "app/scan_jobs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <map>
#include <unistd.h>

#include "base/message.hpp"
#include "base/threads.hpp"

namespace straytrace {
namespace {

using Settings = std::vector<std::string>;

struct Job {
  Settings const* point = nullptr;
  std::string run;  // name of its file
};

// One point for each model; points that cannot be read are left out.
std::vector<Job> different_models(std::vector<Settings> const& points, Options const& options) {
  std::vector<Job> jobs;
  std::set<std::string> known;
  for (Settings const& point : points) try {
      std::vector<std::string> overrides = options.overrides;
      overrides.insert(overrides.end(), point.begin(), point.end());
      Model model = read_model(options.input, overrides);
      apply(options, model);
      std::string const run = run_name(model.hash(), model.seed);
      if (known.insert(run).second) jobs.push_back({&point, run});
    } catch (InputError const&) {
    }
  return jobs;
}

// A child; it ends its blocks and writes when the scan is killed.
[[noreturn]] void work(Job const& job, Options options, Requirement const& requirement, unsigned jobs) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  options.quiet = true;
  if (options.threads == 0) options.threads = std::max(1u, thread_count(0) / jobs);
  int code = input_error;
  try {
    code = Scanner(options, requirement, options.out).at(*job.point).complete ? done : checkpointed;
  } catch (std::exception const&) {  // said again, to people, by the scan that follows
  }
  ::_exit(code);
}

// What a run file is, to see whether a job changed it.
std::filesystem::file_time_type age(std::string const& folder, std::string const& run) {
  std::error_code none;
  return std::filesystem::last_write_time(fmt::format("{}/runs/{}.h5", folder, run), none);
}

}  // namespace

std::set<std::string> trace_together(std::vector<Settings> const& points, Options const& options,
                                     Requirement const& requirement, unsigned jobs, std::atomic<bool> const& stop) {
  std::vector<Job> const all = different_models(points, options);
  std::map<std::string, std::filesystem::file_time_type> before;
  for (Job const& job : all) before[job.run] = age(options.out, job.run);
  std::map<pid_t, Job const*> running;
  std::size_t next = 0, finished = 0;
  while (next < all.size() || !running.empty()) {
    while (next < all.size() && running.size() < jobs && !stop) {
      std::cout.flush();
      pid_t const child = ::fork();
      if (child == 0) work(all[next], options, requirement, jobs);
      if (child < 0) throw InputError("error: no further process can be started\n  take fewer with --jobs");
      running[child] = &all[next++];
    }
    if (running.empty()) break;  // stopped
    int status = 0;
    pid_t const child = ::waitpid(-1, &status, 0);
    if (child < 0 && errno == EINTR) {  // Ctrl-C the jobs have had too; what was sent to this process alone goes on
      for (auto const& [process, ignored] : running)
        if (stop) ::kill(process, SIGTERM);
      continue;
    }
    auto const job = running.find(child);
    if (job == running.end()) continue;
    ++finished;
    if (!options.quiet)
      std::cerr << fmt::format("scan  traced {} of {}: {}\n", finished, all.size(),
                               fmt::join(*job->second->point, ", "));
    running.erase(job);
  }
  std::set<std::string> made;
  for (auto const& [run, time] : before)
    if (age(options.out, run) != time) made.insert(run);
  return made;
}

}  // namespace straytrace
