// SPDX-License-Identifier: BSD-3-Clause
// straytrace optimise: least cost or least noise over parameters of a scene, under limits.
#include "session/optimise/optimise.hpp"

#include <CLI/CLI.hpp>

#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"

namespace straytrace::cli {

void add_optimise(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<OptimiseOptions>();
  OptimiseOptions& o = *options;
  auto* const command = app.add_subcommand(
      "optimise", "Find the least cost or the least noise over parameters of a scene, under limits.");
  add_scene_options(*command, o);
  add_trace_options(*command, o);
  command
      ->add_option("-o,--out", o.out,
                   "folder for best.yaml, best/run.h5, optimise.html, optimise.txt, optimise.json, optimise.png, "
                   "candidates.csv and the runs")
      ->required();
  command
      ->add_option("--minimise", o.words.minimise,
                   "expression of parameters with count(ENTRY), area(ENTRY) in m^2 and price(PARAMETER), or h_total; "
                   "default: of the table 'optimise'")
      ->group("Model");
  command
      ->add_option("--vary", o.words.vary,
                   "NAME=lo..hi, NAME=lo..hi:integer or NAME=a,b,c, of a parameter or a place such as "
                   "scene.baffle.material, instead of the table; may be repeated")
      ->allow_extra_args(false)
      ->group("Model");
  command
      ->add_option("--subject", o.words.subject,
                   "limit, instead of the table: \"h_total < 0.1 x et-d-points with 95 %\", \"power(baffles) < 1 W\", "
                   "\"rim > 34 cm\"; may be repeated")
      ->allow_extra_args(false)
      ->group("Model");
  command
      ->add_flag("--pareto", o.pareto, "also search with limits 0.35 to 2.8 times as high: the front of cost and noise")
      ->group("Analysis");
  command->add_option("--tolerance", o.tolerance, "width of the region, over the ranges, at which a search ends")
      ->check(number_between(1e-6, 0.5, "0.01"));
  command->add_option("--most", o.most, "candidates of one search at most; default 60")
      ->check(whole_between(1, 10000, "60"))
      ->group("Analysis");
  command
      ->add_option("--most-histories", o.most_histories,
                   "histories of a candidate at most, from --histories on by factors of 4, where the error would hide "
                   "the next step; default: --histories")
      ->check(whole_between(1, 1000000000, "1000000"))
      ->group("Analysis");
  command->footer(
      "Examples:\n"
      "  straytrace optimise examples/et_hf_arm.yaml --minimise \"count(baffles*)\" --vary rim=34cm..36cm --subject "
      "\"h_total < 0.5 x line with 95 %\" --histories 65536 -o best/\n"
      "  straytrace optimise examples/et_hf_arm.yaml --minimise h_total --vary baffle_angle=30deg..50deg --histories "
      "65536 -o quiet/\n"
      "Exit code 4: no candidate meets the limits; the closest is printed.\n"
      "After Ctrl-C it keeps the finished traces and exits with 85; the same command resumes.");
  command->callback([options, &exit_code] {
    drop_slashes(options->out);
    exit_code = optimise(*options);
  });
}

}  // namespace straytrace::cli
