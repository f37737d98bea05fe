// SPDX-License-Identifier: BSD-3-Clause
// straytrace fit baffle: parameters of a scene from the power on photodiodes of its baffles.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <numeric>

#include "base/text/json_text.hpp"
#include "cli/fit/fit_report.hpp"
#include "cli/options.hpp"
#include "results/text/columns.hpp"
#include "session/light/baffle_fit.hpp"

namespace straytrace::cli {
namespace {

constexpr double rejected = 1e-3;  // a smaller probability of chi^2

struct BaffleFitOptions : BaffleFitRequest {
  std::size_t show = 12;
};

std::string parameters_text(BaffleFit const& b) {
  Columns table{{"parameter", "value", "unit", "range"}, {true, false, true, true}, {}};
  for (std::size_t i = 0; i < b.parameters.size(); ++i) {
    FreeParameter const& p = b.parameters[i];
    DiodeFit::Parameter const& found = b.fit.parameters[i];
    std::string const range =
        fmt::format("{:g} to {:g}{}", p.range.low, p.range.high, found.at_end ? ", at its end" : "");
    table.rows.push_back(
        {p.name, found.determined ? with_error(found.value, found.sigma) : "not determined", p.unit, range});
  }
  return aligned(table);
}

std::string undetermined_text(BaffleFit const& b) {
  std::string text;
  for (Eigen::VectorXd const& v : b.fit.undetermined) {
    std::string sum;
    for (std::size_t i = 0; i < b.parameters.size(); ++i) {
      double const part = v[Eigen::Index(i)];
      if (std::fabs(part) < 0.05) continue;
      sum += fmt::format("{}{:.2f} {}", sum.empty() ? (part < 0 ? "-" : "") : (part < 0 ? " - " : " + "),
                         std::fabs(part), b.parameters[i].name);
    }
    text += fmt::format("the data do not determine {} (in half ranges); it stays at the middle\n", sum);
  }
  return text;
}

double pull(BaffleFit const& b, std::size_t i) {
  auto const n = Eigen::Index(i);
  return (b.measured[i] - b.fit.mean[n]) / b.fit.sigma[n];
}

std::string diodes_text(BaffleFit const& b, std::size_t show) {
  std::vector<std::size_t> order(b.diodes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return std::fabs(pull(b, i)); });
  Columns table{{"photodiode", "measured/W", "error", "model/W", "speckle", "pull"}, {true}, {}};
  for (std::size_t k = 0; k < std::min(show, order.size()); ++k) {
    std::size_t const i = order[k];
    double const sigma = b.fit.sigma[Eigen::Index(i)];
    table.rows.push_back({b.diodes[i], fmt::format("{:.4g}", b.measured[i]), fmt::format("{:.2g}", b.error[i]),
                          fmt::format("{:.4g}", b.fit.mean[Eigen::Index(i)]),
                          fmt::format("{:.2g}", sigma * std::sqrt(std::max(0.0, b.speckle[i]))),
                          fmt::format("{:+.2f}", pull(b, i))});
  }
  std::string const more =
      order.size() > show ? fmt::format("and {} more; --show N has more rows\n", order.size() - show) : "";
  return "speckle: one standard deviation of the model over heights of the mirrors that no map states; pull: measured\n"
         "less model over both errors. Largest first.\n\n" +
         aligned(table) + more;
}

std::string fit_text(BaffleFit const& b, std::size_t show) {
  DiodeFit const& f = b.fit;
  std::string out = fmt::format("{} photodiodes, {:g} W in '{}'{}\n\n", b.diodes.size(), b.arm_power, b.beam,
                                b.left_out > 0 ? fmt::format("; {} of the scene are not measured", b.left_out) : "");
  out += parameters_text(b) + undetermined_text(b);
  out +=
      fmt::format("\nchi^2 {:.1f} for {} degrees of freedom, {:.1f} effective with speckle; probability {:.2g}: {}\n",
                  f.chi2, f.degrees, f.effective_degrees, f.probability,
                  f.probability < rejected ? "the data REJECT the model" : "the model describes the data");
  return out + "\n" + diodes_text(b, show);
}

nlohmann::ordered_json fit_json(BaffleFit const& b) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::array(), diodes = parameters, correlation = parameters,
                         undetermined = parameters;
  for (std::size_t i = 0; i < b.parameters.size(); ++i) {
    FreeParameter const& p = b.parameters[i];
    DiodeFit::Parameter const& found = b.fit.parameters[i];
    nlohmann::ordered_json j{{"name", p.name},
                             {"unit", p.unit},
                             {"determined", found.determined},
                             {"at_end_of_range", found.at_end},
                             {"range", {p.range.low, p.range.high}}};
    if (found.determined) j["value"] = found.value, j["sigma"] = found.sigma;
    parameters.push_back(std::move(j));
    std::vector<double> row;
    for (Eigen::Index k = 0; k < b.fit.correlation.cols(); ++k) row.push_back(b.fit.correlation(Eigen::Index(i), k));
    correlation.push_back(row);
  }
  for (Eigen::VectorXd const& v : b.fit.undetermined) undetermined.push_back(std::vector<double>(v.begin(), v.end()));
  for (std::size_t i = 0; i < b.diodes.size(); ++i)
    diodes.push_back({{"photodiode", b.diodes[i]},
                      {"measured_w", b.measured[i]},
                      {"error_w", b.error[i]},
                      {"model_w", b.fit.mean[Eigen::Index(i)]},
                      {"sigma_w", b.fit.sigma[Eigen::Index(i)]},
                      {"speckle_share_of_variance", b.speckle[i]},
                      {"pull", pull(b, i)}});
  return {{"beam", b.beam},
          {"arm_power_w", b.arm_power},
          {"parameters", parameters},
          {"correlation", correlation},
          {"undetermined_in_half_ranges", undetermined},
          {"chi2", b.fit.chi2},
          {"degrees", b.fit.degrees},
          {"effective_degrees", b.fit.effective_degrees},
          {"probability", b.fit.probability},
          {"rejected", b.fit.probability < rejected},
          {"photodiodes", diodes}};
}

int baffle(BaffleFitOptions const& o) {
  BaffleFit const found = fit_baffle(o);
  if (o.scene.json())
    std::cout << json_text(fit_json(found)) << '\n';
  else
    std::cout << fit_text(found, o.show);
  return done;
}

}  // namespace

void add_fit_baffle(CLI::App& fit, int& exit_code) {
  auto* const command =
      fit.add_subcommand("baffle", "Fit parameters of a scene to the power measured on photodiodes of its baffles.");
  auto const options = std::make_shared<BaffleFitOptions>();
  BaffleFitOptions& o = *options;
  add_scene_options(*command, o.scene);
  command->add_option("--measured", o.measured, "CSV with the columns photodiode, power [W] and error [W]")->required();
  command
      ->add_option("--free", o.free,
                   "parameter of the scene with the range that is searched: \"tilt=-1..1 urad\"; may be repeated")
      ->allow_extra_args(false)
      ->required();
  command->add_option("--show", o.show, "rows of photodiodes, worst first")->check(whole_between(1, 1e6, "20"));
  command->add_option("--threads", o.threads, "0: all cores")->check(whole_between(0, 4096, "8"));
  command->footer(
      "Examples:\n"
      "  straytrace fit baffle examples/instrumented_baffle.yaml --measured examples/data/baffle_watts.csv --free "
      "\"shift_x=-2..2 mm\" --free \"shift_y=-2..2 mm\"\n"
      "  straytrace fit baffle examples/instrumented_baffle.yaml --measured examples/data/baffle_watts.csv --free "
      "\"shift_x=-2..2 mm\" --format json");
  command->callback([options, &exit_code] { exit_code = baffle(*options); });
}

}  // namespace straytrace::cli
