// SPDX-License-Identifier: BSD-3-Clause
#include "cli/help.hpp"

#include <algorithm>
#include <memory>
#include <sstream>

#include "cli/commands.hpp"

namespace straytrace::cli {
namespace {

struct Task {
  char const* name;
  std::vector<void (*)(CLI::App&, int&)> commands;
};

std::vector<Task> const& tasks() {
  static std::vector<Task> const all = {
      {"Model", {add_check, add_print, add_inspect, add_render, add_view}},
      {"Light", {add_run, add_trace, add_importance, add_apertures, add_wave, add_ghosts, add_ifo}},
      {"Noise",
       {add_noise, add_budget, add_scan, add_sensitivity, add_optimise, add_project, add_fringes, add_sensors}},
      {"Data", {add_signal, add_couple, add_fit}},
      {"Results", {add_paths, add_maps, add_report, add_diff}},
      {"Cluster", {add_submit, add_merge}},
      {"Look-up", {add_library, add_explain, add_schema}},
  };
  return all;
}

struct OptionGroup {
  char const* name;
  std::vector<std::string> options;  // long names
};

std::vector<OptionGroup> const& groups() {
  static std::vector<OptionGroup> const all = {
      {"Model", {"param", "strict", "resolved", "migrate", "units", "entry", "angles", "beyond"}},
      {"Motion",
       {"motion", "response", "set", "body", "axis", "channel", "own-motion", "amplitude", "frequency", "duration"}},
      {"Data", {"witness",    "witness2",     "target",        "force",          "local",         "injection",
                "list",       "gps",          "unit",          "witness-unit",   "witness2-unit", "target-unit",
                "force-unit", "output-unit",  "coupling-unit", "displacement",   "corner",        "ratio",
                "wavelength", "multiplicity", "bounces",       "gain-per-field", "measured",      "sweeps",
                "length",     "before",       "rate",          "segments"}},
      {"Tracing",
       {"histories", "seed", "until", "max-time", "checkpoint", "slice", "history", "floor", "order", "detuning",
        "seam", "no-seam", "grid-check", "by-frequency", "trace", "step"}},
      {"Computing", {"threads", "backend", "jobs", "time", "accounting", "live", "live-port", "open"}},
      {"Analysis", {"invert",        "against",
                    "margin",        "per-frequency",
                    "tolerance",     "compare",
                    "delay",         "drift",
                    "free",          "train",
                    "method",        "false-alarm",
                    "factor",        "paths",
                    "retarded",      "paths-per-route",
                    "realisations",  "significance",
                    "witness-ratio", "target-ratio",
                    "force-ratio",   "accept-incoherent",
                    "threshold",     "modes",
                    "averages",      "z-max",
                    "harmonics",     "estimator",
                    "confidence",    "to",
                    "domain",        "notch",
                    "first-order",   "referred-to"}},
      {"Spectra",
       {"segment", "overlap", "window", "average", "detrend", "stride", "resolution", "points-per-decade", "power",
        "normalise", "q"}},
      {"Camera",
       {"mode", "eye", "look", "up", "fov", "pixels", "from", "cut", "flash", "lamp", "section", "whole", "beams"}},
      {"Selection",
       {"show",     "only", "band", "by",     "where",   "sort",     "without", "census", "path",     "route", "port",
        "moved-by", "beam", "at",   "points", "profile", "distance", "above",   "kind",   "pictures", "rays",  "halo"}},
      {"Output", {"out",         "csv",     "plot",   "html",   "write",   "save",   "save-motion", "subtract", "asd",
                  "spectrogram", "overlay", "export", "title",  "vtk",     "glb",    "copy",        "partial",  "force",
                  "format",      "quiet",   "silent", "events", "unsaved", "fields", "version",     "help"}},
  };
  return all;
}

bool lists(OptionGroup const& group, CLI::Option const& option) {
  return std::ranges::any_of(option.get_lnames(), [&](std::string const& name) {
    return std::ranges::find(group.options, name) != group.options.end();
  });
}

// A footer as declared: lines indented by two spaces are examples, all others are notes.
struct Footer {
  std::string examples, notes;
};

Footer parts_of(std::string const& footer) {
  Footer parts;
  std::istringstream in(footer);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("  "))
      parts.examples += line + "\n";
    else if (line != "Examples:")
      parts.notes += line + "\n";
  return parts;
}

class Layout : public CLI::Formatter {
 public:
  std::string make_help(CLI::App const* app, std::string name, CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::Sub) return make_expanded(app);
    Footer const footer = parts_of(app->get_footer());
    std::string text = make_description(app);
    if (!footer.examples.empty()) text += "\nExamples:\n" + footer.examples;
    text += "\n" + make_usage(app, name) + make_positionals(app);
    for (std::string const& group : option_groups()) {
      auto const options = app->get_options(
          [&](CLI::Option const* option) { return option->get_group() == group && option->nonpositional(); });
      if (!options.empty()) text += make_group(group + " options", false, options);
    }
    text += make_subcommands(app, mode);
    return footer.notes.empty() ? text : text + "\n" + footer.notes;
  }
};

void lay_out(CLI::App& app, std::shared_ptr<Layout> const& layout) {
  app.formatter(layout);
  for (CLI::Option* option : app.get_options())
    if (option->nonpositional() && option->get_group() == "Options")
      for (OptionGroup const& group : groups())
        if (lists(group, *option)) option->group(group.name);
  for (CLI::App* command : app.get_subcommands(nullptr)) lay_out(*command, layout);
}

}  // namespace

void add_commands(CLI::App& app, int& exit_code) {
  for (Task const& task : tasks())
    for (auto* const add : task.commands) {
      add(app, exit_code);
      app.get_subcommands(nullptr).back()->group(task.name);
    }
}

void lay_out_help(CLI::App& app) {
  auto const layout = std::make_shared<Layout>();
  layout->column_width(30);
  lay_out(app, layout);
}

std::vector<std::string> const& option_groups() {
  static std::vector<std::string> const names = [] {
    std::vector<std::string> all;
    for (OptionGroup const& group : groups()) all.emplace_back(group.name);
    return all;
  }();
  return names;
}

}  // namespace straytrace::cli
