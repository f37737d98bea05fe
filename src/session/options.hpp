// SPDX-License-Identifier: BSD-3-Clause
// What the command line says, and the commands.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace straytrace {

class Scene;

struct Options {
  std::string input, out, motion, response;
  std::vector<std::string> overrides;  // "aperture=60cm"
  std::string format = "text", until;
  std::string backend = "cpu";
  std::optional<std::uint64_t> seed, histories;
  unsigned threads = 0;
  double max_seconds = 0;               // 0: no limit
  double checkpoint_seconds = 1200;     // between writings of the run file while it is traced; infinite: none
  std::uint64_t slice = 1, slices = 1;  // 7/200
  bool force = false, quiet = false, strict = false, resolved = false;
  std::string where;
  std::size_t show = 0;  // 0: as the scene says
  bool csv = false, first_order = false, census = false;
  std::string by;  // what `paths` is about: "port", "receiver"; empty: ports where the run has any

  bool json() const { return format == "json"; }
};

enum ExitCode { done = 0, input_error = 2, numerical_failure = 3, checkpointed = 85 };

// Each adds its sub-command; the chosen one runs when the command line has been parsed and sets `exit_code`.
void add_check(CLI::App&, Options&, int& exit_code);
void add_print(CLI::App&, Options&, int& exit_code);
void add_explain(CLI::App&, Options&, int& exit_code);
void add_schema(CLI::App&, Options&, int& exit_code);
void add_diff(CLI::App&, Options&, int& exit_code);
// The model as `print` shows it, on stdout.
int print_resolved(Scene const&, Options const&);
void add_trace(CLI::App&, Options&, int& exit_code);
void add_run(CLI::App&, Options&, int& exit_code);
void add_merge(CLI::App&, Options&, int& exit_code);
void add_submit(CLI::App&, Options&, int& exit_code);
void add_noise(CLI::App&, Options&, int& exit_code);
void add_paths(CLI::App&, Options&, int& exit_code);
void add_maps(CLI::App&, Options&, int& exit_code);
void add_inspect(CLI::App&, Options&, int& exit_code);
void add_render(CLI::App&, Options&, int& exit_code);
void add_importance(CLI::App&, Options&, int& exit_code);
void add_apertures(CLI::App&, Options&, int& exit_code);
void add_ghosts(CLI::App&, Options&, int& exit_code);
void add_budget(CLI::App&, Options&, int& exit_code);
void add_project(CLI::App&, Options&, int& exit_code);
void add_fringes(CLI::App&, Options&, int& exit_code);
void add_fit(CLI::App&, Options&, int& exit_code);
void add_scan(CLI::App&, Options&, int& exit_code);
void add_couple(CLI::App&, Options&, int& exit_code);
void add_signal(CLI::App&, Options&, int& exit_code);
void add_report(CLI::App&, Options&, int& exit_code);
void add_view(CLI::App&, Options&, int& exit_code);
void add_library(CLI::App&, Options&, int& exit_code);

}  // namespace straytrace
