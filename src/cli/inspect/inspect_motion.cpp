// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <iostream>

#include "cli/inspect/inspect.hpp"
#include "noise/classes/motion_classes.hpp"
#include "results/curves/curve_file.hpp"
#include "session/diagnostics.hpp"
#include "session/model.hpp"

namespace straytrace::cli {
namespace {

constexpr std::array<double, 3> bands_from = {0.1, 1, 10};  // Hz

void print_json(std::vector<CoordinateMotion> const& rows) {
  nlohmann::json out = nlohmann::json::array();
  for (CoordinateMotion const& r : rows) {
    nlohmann::json above = nlohmann::json::object();
    for (std::size_t b = 0; b < bands_from.size(); ++b) above[fmt::format("{:g}", bands_from[b])] = r.above[b];
    out.push_back({{"body", r.body},
                   {"coordinate", r.axis},
                   {"unit", r.unit},
                   {"rms", r.rms},
                   {"rms_above_Hz", above},
                   {"rms_rate_per_s", r.rate},
                   {"drift_per_s", r.drift}});
  }
  std::cout << nlohmann::json{{"motion", out}}.dump() << '\n';
}

void print_table(std::vector<CoordinateMotion> const& rows) {
  std::cout << fmt::format("{:<20}{:<6}{:>12}", "body", "", "rms");
  for (double const f : bands_from) std::cout << fmt::format("{:>13}", fmt::format("> {:g} Hz", f));
  std::cout << fmt::format("{:>14}{:>14}\n", "rms per s", "drift per s");
  for (CoordinateMotion const& r : rows) {
    std::cout << fmt::format("{:<20}{:<6}{:>12}", r.body, r.axis, fmt::format("{:.3e}", r.rms));
    for (double const a : r.above) std::cout << fmt::format("{:>13}", fmt::format("{:.3e}", a));
    std::cout << fmt::format("{:>14}{:>14}  {}\n", fmt::format("{:.3e}", r.rate),
                             r.drift > 0 ? fmt::format("{:.3e}", r.drift) : "-", r.unit);
  }
}

// ASDs on 200 frequencies a decade; tones and drifts have none.
CurveSheet sheet_of(std::vector<CoordinateMotion> const& rows, std::vector<MotionClass> const& classes) {
  double low = infinity, high = 0;
  for (MotionClass const& c : classes) {
    if (c.tone_frequency > 0 || c.drift) continue;
    low = std::min(low, c.reference.lowest());
    high = std::max(high, c.reference.highest());
  }
  if (!(low < high)) throw InputError("no motion of this file has a spectrum to draw", "remove --plot");
  CurveSheet sheet;
  sheet.title = "Motion of bodies, amplitude spectral density";
  sheet.notes = {"tones and drifts are not drawn"};
  sheet.x = {"frequency", "Hz", {}};
  auto const n = static_cast<std::size_t>(200 * std::log10(high / low)) + 2;
  for (std::size_t i = 0; i < n; ++i) sheet.x.values.push_back(low * std::pow(high / low, double(i) / double(n - 1)));
  for (CoordinateMotion const& r : rows) {
    CurveColumn curve{r.body + " " + r.axis, r.unit + "/sqrt(Hz)", {}};
    for (double const f : sheet.x.values) curve.values.push_back(r.asd(classes, f));
    sheet.y.push_back(std::move(curve));
  }
  return sheet;
}

}  // namespace

bool shows_motion(Scene const& scene) { return scene.table("bodies") && !scene.root().has("materials"); }

int inspect_motion(Scene const& scene, std::string const& plot, PrintOptions const& options) {
  if (!plot.empty()) check_curve_ending(plot, "--plot");
  MotionSet const motion = read_motion_file(scene);
  print_warnings(scene, options);
  std::vector<MotionClass> const classes = group_by_shape(motion);
  std::vector<CoordinateMotion> const rows = coordinate_motions(motion, classes, bands_from);
  if (options.json())
    print_json(rows);
  else
    print_table(rows);
  if (plot.empty()) return done;
  write_curves({plot}, sheet_of(rows, classes));
  if (!options.json()) std::cout << "\npicture: " << plot << '\n';
  return done;
}

}  // namespace straytrace::cli
