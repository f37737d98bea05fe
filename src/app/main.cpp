// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <iostream>

#include "app/build_info.hpp"
#include "app/options.hpp"
#include "base/message.hpp"

int main(int argc, char** argv) {
  using namespace straytrace;
  CLI::App app{"straytrace: stray-light noise of interferometric gravitational-wave detectors"};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("straytrace ") + build_info::version + " (" + build_info::commit + ")");
  app.footer("Every command explains itself: straytrace run --help");
  Options options;
  int exit_code = done;
  for (auto* add : {add_run, add_check, add_trace, add_noise, add_paths}) add(app, options, exit_code);
  try {
    app.parse(argc, argv);
  } catch (CLI::ParseError const& e) {
    return app.exit(e) == 0 ? done : input_error;
  } catch (InputError const& e) {
    std::cerr << (options.json() ? problems_as_json(e) : e.what()) << '\n';
    return input_error;
  } catch (std::exception const& e) {
    std::cerr << "error: " << e.what() << '\n';
    return numerical_failure;
  }
  return exit_code;
}
