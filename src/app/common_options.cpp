// SPDX-License-Identifier: BSD-3-Clause
#include "app/common_options.hpp"

namespace straytrace {

void add_format_option(CLI::App& command, Options& options) {
  command.add_option("--format", options.format, "text or json")->check(CLI::IsMember({"text", "json"}));
}

void add_scene_options(CLI::App& command, Options& options) {
  command.add_option("scene", options.input, "scene file (YAML)")->required();
  command.add_option("-p,--param", options.overrides, "set a parameter, for example -p aperture=60cm")
      ->allow_extra_args(false);
  command.add_flag("--quiet", options.quiet, "no progress, no warnings");
  add_format_option(command, options);
}

void add_trace_options(CLI::App& command, Options& options) {
  command
      .add_option_function<double>(
          "--histories", [&](double n) { options.histories = std::uint64_t(n); },
          "at most so many histories, rounded up to whole blocks of 4096")
      ->check(CLI::Range(1.0, 1e12));
  command.add_option("--until", options.until,
                     "stop rule: \"h_total < 5 %\", \"routes < 10 %\", \"10 min\", or a list");
  command.add_option("--seed", options.seed, "of the random numbers; the same seed gives the same bits");
  command.add_option("--threads", options.threads, "default: all cores; does not change the result")
      ->check(CLI::Range(1u, 1024u));
  command
      .add_option("--max-time", options.max_seconds, "stop after so many seconds with a result that can be continued")
      ->check(CLI::PositiveNumber);
  command.add_flag("--force", options.force, "overwrite the results of another model");
}

}  // namespace straytrace
