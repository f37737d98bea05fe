// SPDX-License-Identifier: BSD-3-Clause
// straytrace maps: the light on the receivers of a run, as pictures and numbers.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/receivers/receivers.hpp"
#include "results/text/picture.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"
#include "world/model/map_areas.hpp"

namespace straytrace::cli {
namespace {

struct MapsOptions {
  std::string input, out;
};

int maps(MapsOptions const& options) {
  RunFile const file = read_run_file(options.input);
  RunContent const content = file.content();
  if (content.receivers.empty())
    throw InputError(fmt::format("'{}' has no receivers", options.input),
                     "add 'receivers: {PD: {on: SURFACE, map: {...}}}' to the scene and repeat the trace");
  OutputFolder const folder(options.out);
  Model const model = model_of(file);
  std::vector<std::vector<double>> areas;
  for (std::size_t i = 0; i < content.receivers.size(); ++i)
    areas.push_back(map_areas(model.world.view(), model.world.receivers().at(i).surface, content.receivers[i]));
  std::vector<std::string> files = write_maps(options.out, content, areas);
  if (files.empty())
    throw InputError(fmt::format("no receiver of '{}' has a map", options.input),
                     "give it 'map', 'angles' or 'quadrants'");
  std::string picture, message;
  for (std::size_t i = 0; i < content.receivers.size() && picture.empty(); ++i)
    if (content.receivers[i].map_size() > 0 || content.receivers[i].angle_bins > 0) {
      picture = file.trace.coupling.receivers[i] + ".png";
      std::replace(picture.begin(), picture.end(), '/', '_');
    }
  bool const drawn =
      picture.empty() || draw_map_pictures(options.input, options.out, options.out + "/" + picture, message);
  for (std::string const& name : files) std::cout << options.out << '/' << name << '\n';
  if (!drawn) std::cerr << "warning: pictures were not drawn: " << message << '\n';
  return done;
}

}  // namespace

void add_maps(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<MapsOptions>();
  MapsOptions& o = *options;
  auto* const command =
      app.add_subcommand("maps", "Write irradiance, angles, fields and quadrants of receivers as CSV, NPY and PNG.");
  command->add_option("run", o.input, "run file (HDF5)")->required();
  command->add_option("-o,--out", o.out, "folder for the maps")->required();
  command->footer(
      "Examples:\n"
      "  straytrace maps out/run.h5 -o out/maps\n"
      "  straytrace maps bench.h5 -o maps/\n"
      "Row 0 is the lowest, column 0 the leftmost, seen from the front of the receiver.");
  command->callback([options, &exit_code] {
    drop_slashes(options->out);
    exit_code = maps(*options);
  });
}

}  // namespace straytrace::cli
