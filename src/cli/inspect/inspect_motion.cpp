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
constexpr std::array<char const*, 6> coordinates = {"x", "y", "z", "rx", "ry", "rz"};

// One coordinate of one body: as the phase with a phase sensitivity of 1 on it alone.
struct MotionRow {
  std::string body, axis, unit;
  double rms = 0, rate = 0, drift = 0;            // m, m/s, m/s (rad); random motion and tones
  std::array<double, bands_from.size()> above{};  // rms above a frequency
  std::vector<double> kappa = {};

  bool moves() const { return rms > 0 || drift != 0; }
};

MotionRow row_of(MotionSet const& motion, std::vector<MotionClass> const& classes, std::uint32_t body, int axis) {
  PhaseSensitivity phase_sensitivity{BodyId{body}, {}};
  phase_sensitivity.d[axis] = 1;
  bool const mode = motion.bodies[body].find('/') != std::string::npos;
  MotionRow row{motion.bodies[body], mode ? "q" : coordinates[std::size_t(axis)], axis < 3 ? "m" : "rad"};
  row.kappa = kappa_of(motion, classes, {&phase_sensitivity, 1});
  double total = 0, rate = 0;
  std::array<double, bands_from.size()> above{};
  for (std::size_t c = 0; c < classes.size(); ++c) {
    MotionClass const& of = classes[c];
    double const k = row.kappa[c], tone = of.tone_frequency;
    if (of.drift) row.drift = std::sqrt(k);
    total += k * of.variance();
    rate += tone > 0 ? k / 2 * std::pow(2 * pi * tone, 2) : k * of.reference.rate_power(infinity);
    for (std::size_t b = 0; b < above.size(); ++b)
      above[b] += tone > 0 ? (tone >= bands_from[b] ? k / 2 : 0) : k * of.reference.power(bands_from[b], infinity);
  }
  row.rms = std::sqrt(std::max(0.0, total));
  row.rate = std::sqrt(std::max(0.0, rate));
  for (std::size_t b = 0; b < above.size(); ++b) row.above[b] = std::sqrt(std::max(0.0, above[b]));
  return row;
}

std::vector<MotionRow> rows_of(MotionSet const& motion, std::vector<MotionClass> const& classes) {
  std::vector<MotionRow> rows;
  for (std::uint32_t body = 0; body < motion.bodies.size(); ++body)
    for (int axis = 0; axis < 6; ++axis)
      if (MotionRow row = row_of(motion, classes, body, axis); row.moves()) rows.push_back(std::move(row));
  return rows;
}

void print_json(std::vector<MotionRow> const& rows) {
  nlohmann::json out = nlohmann::json::array();
  for (MotionRow const& r : rows) {
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

void print_table(std::vector<MotionRow> const& rows) {
  std::cout << fmt::format("{:<20}{:<6}{:>12}", "body", "", "rms");
  for (double const f : bands_from) std::cout << fmt::format("{:>13}", fmt::format("> {:g} Hz", f));
  std::cout << fmt::format("{:>14}{:>14}\n", "rms per s", "drift per s");
  for (MotionRow const& r : rows) {
    std::cout << fmt::format("{:<20}{:<6}{:>12}", r.body, r.axis, fmt::format("{:.3e}", r.rms));
    for (double const a : r.above) std::cout << fmt::format("{:>13}", fmt::format("{:.3e}", a));
    std::cout << fmt::format("{:>14}{:>14}  {}\n", fmt::format("{:.3e}", r.rate),
                             r.drift > 0 ? fmt::format("{:.3e}", r.drift) : "-", r.unit);
  }
}

// ASDs on 200 frequencies a decade; tones and drifts have none.
CurveSheet sheet_of(std::vector<MotionRow> const& rows, std::vector<MotionClass> const& classes) {
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
  for (MotionRow const& r : rows) {
    CurveColumn curve{r.body + " " + r.axis, r.unit + "/sqrt(Hz)", {}};
    for (double const f : sheet.x.values) {
      double psd = 0;
      for (std::size_t c = 0; c < classes.size(); ++c) psd += r.kappa[c] * classes[c].reference.at(f);
      curve.values.push_back(std::sqrt(std::max(0.0, psd)));
    }
    sheet.y.push_back(std::move(curve));
  }
  return sheet;
}

}  // namespace

bool shows_motion(Scene const& scene) { return scene.table("bodies") && !scene.root().has("materials"); }

int inspect_motion(Scene const& scene, std::string const& plot, PrintOptions const& options) {
  MotionSet const motion = read_motion_file(scene);
  print_warnings(scene, options);
  std::vector<MotionClass> const classes = group_by_shape(motion);
  std::vector<MotionRow> const rows = rows_of(motion, classes);
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
