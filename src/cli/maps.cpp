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

// Of the cells of each receiver within the rim of its surface, m^2. The model is built only for a file that does not
// state them, where a map has cells.
std::vector<std::vector<double>> areas_of(RunFile const& file, std::vector<Receiver> const& receivers) {
  if (!file.about.map_areas.empty()) return file.about.map_areas;
  std::vector<std::vector<double>> areas(receivers.size());
  if (std::ranges::none_of(receivers, [](Receiver const& r) { return r.map_size() > 0; })) return areas;
  Model const model = model_of(file);
  for (std::size_t i = 0; i < receivers.size(); ++i)
    areas[i] = map_areas(model.world.view(), model.world.receivers().at(i).surface, receivers[i]);
  return areas;
}

int maps(MapsOptions const& options) {
  RunFile const file = read_run_file(options.input);
  RunContent const content = file.content();
  if (content.receivers.empty())
    throw InputError(fmt::format("'{}' has no receivers", options.input),
                     "add 'receivers: {PD: {on: SURFACE, map: {...}}}' to the scene and repeat the trace");
  OutputFolder const folder(options.out);
  std::vector<std::string> const files = write_maps(options.out, content, areas_of(file, content.receivers));
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
