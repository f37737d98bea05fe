// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "app/build_info.hpp"
#include "app/importance_map.hpp"
#include "app/session.hpp"
#include "app/tell.hpp"
#include "base/counted.hpp"
#include "report/columns.hpp"
#include "report/merit.hpp"
#include "report/picture.hpp"
#include "report/receivers.hpp"

namespace straytrace {

PathTable table_for(CouplingTable const& coupling, NoiseBudget const* budget, Model const& model) {
  return path_table(coupling, budget, budget ? &model.motion : nullptr, {});
}

RunContent content_of(Model const& model, TraceResult const& traced, NoiseBudget const* budget) {
  RunContent content;
  content.files = model.scene.files();
  content.main_file = model.scene.main_file();
  content.title = model.scene.title();
  content.overrides = model.scene.overrides();
  content.resolved = model.scene.resolved();
  content.model_hash = model.hash();
  content.interferometer = model.detector ? model.detector->description() : "";
  if (!model.warnings.empty()) content.warnings.push_back(model.warnings);
  content.receivers = model.world.receivers();
  content.importance = importance_map(model.world);
  content.beam_power = model.world.beam_power;
  content.provenance.version = build_info::version;
  content.provenance.commit = build_info::commit;
  content.provenance.build_flags = build_info::flags;
  content.provenance.created = utc_now();
  content.trace = &traced;
  content.noise = budget;
  return content;
}

std::string write_results(std::string const& folder, RunContent const& content, PathTable const& paths,
                          Model const& model) {
  write_run(folder + "/run.h5", content);
  std::vector<std::pair<std::string, std::string>> texts{
      {folder + "/paths.csv", path_csv(paths, content)},
      {folder + "/report.txt", text_report(content, paths, model.paths_shown, model.assumptions())}};
  if (content.noise) texts.emplace_back(folder + "/h_asd.txt", asd_text(content));
  if (!content.receivers.empty())
    texts.emplace_back(folder + "/receivers.csv", receiver_csv(receiver_table(content), content));
  write_files(texts);
  std::string message;
  return draw_picture(folder + "/run.h5", folder + "/report.png", message) ? "" : message;
}

void tell_traced(RunContent const& content, Model const& model, Options const& options) {
  PathTable const paths = table_for(content.trace->coupling, nullptr, model);
  if (options.json()) {
    std::cout << path_json(paths, content) << '\n';
  } else {
    if (model.detector) std::cout << path_text(paths, model.paths_shown) << '\n';
    if (!content.receivers.empty()) std::cout << receiver_text(receiver_table(content), model.paths_shown) << '\n';
    std::cout << "Where the light went\n\n" << books_text(content) << '\n' << objects_text(content);
  }
  if (options.quiet) return;
  std::cerr << merit_text(merits(content), merits_shown);
  if (model.detector)
    std::cerr << fmt::format("coupling table in {}; project motion with: straytrace noise {}\n", options.out,
                             options.out);
  else
    std::cerr << fmt::format("light on receivers in {}; more with: straytrace paths {} --census\n", options.out,
                             options.out);
}

void tell_warnings(NoiseBudget const& budget, Options const& options, std::string const& where) {
  for (std::string const& warning : budget.warnings)
    tell_warning(fmt::format("{}{}{}", where, where.empty() ? "" : ": ", warning), options);
}

// Of a total that is zero everywhere: why. Motion outside the band makes nothing in it as long as its phase is small.
static std::string silence(NoiseBudget const& budget) {
  double phase = 0;
  for (NoiseTrace const& t : budget.routes) phase = std::max(phase, std::sqrt(t.mean_square_phase));
  if (!(phase > 0)) return "stray light makes no strain noise here: nothing on its routes moves";
  return fmt::format(
      "stray light makes no strain noise between {:g} and {:g} Hz: what moves on its routes moves at other "
      "frequencies, "
      "by {:.2g} rad rms at most, which does not wrap into this band",
      budget.grid.edges.front(), budget.grid.edges.back(), phase);
}

std::string headline(NoiseBudget const& budget, PathTable const& paths) {
  std::string values, at, ratios, lines;
  bool bound = false;
  auto const outside = [&](double f) {
    return budget.grid.size() > 0 && !(f >= budget.grid.edges.front() && f < budget.grid.edges.back());
  };
  bool const nowhere = std::all_of(paths.frequencies.begin(), paths.frequencies.end(), outside);
  for (std::size_t i = 0; i < paths.frequencies.size(); ++i) {
    double const f = paths.frequencies[i];
    if (outside(f) && !nowhere) continue;
    char const* const comma = values.empty() ? "" : ", ";
    at += fmt::format("{}{:g}", comma, f);
    values += comma + with_error(paths.total_strain[i]);
    bound = bound || paths.total_strain[i].at_most;
    if (!std::isnan(paths.lines[i].rms.value))
      lines += fmt::format("; at {:g} Hz a line of {} rms", f, with_error(paths.lines[i].rms));
    if (budget.design.empty()) continue;
    double const design = design_at(budget.design.front(), budget.grid, f);
    ratios += comma + with_error(paths.total_strain[i].over(design));
  }
  if (budget.total.resolved &&
      std::all_of(budget.total.asd.begin(), budget.total.asd.end(), [](double h) { return h == 0; }))
    return silence(budget);
  std::string line = fmt::format("stray light h = {} /sqrt(Hz) at {} Hz", values, at);
  if (!ratios.empty()) line += fmt::format("; over {}: {}", budget.design.front().name, ratios);
  line += lines;
  if (!paths.lower_bound()) return line;
  return line + fmt::format("  ({}: {} unresolved)", bound ? "not of all light" : "lower bound",
                            counted(paths.unresolved - paths.faint, "route"));
}

}  // namespace straytrace
