// SPDX-License-Identifier: BSD-3-Clause
#include "session/records/route_predictions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/math/constants.hpp"
#include "base/text/json_text.hpp"
#include "io/delimited_text.hpp"
#include "motion/axis_motion.hpp"
#include "noise/bands/speckle_band.hpp"
#include "results/route_table/route_sums.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"

namespace straytrace::session {
namespace {

// Weighted sums over the paths of a route: phase per metre of a body along each axis, and per radian about it.
struct PhaseSensitivities {
  double weight = 0;
  std::array<double, 6> sum{}, square{};
};

PhaseSensitivities phase_sensitivities_of(CouplingClass const& c, std::uint32_t body) {
  PhaseSensitivities out;
  for (PathRecord const& r : c.records) {
    out.weight += r.weight;
    for (PhaseSensitivity const& phase_sensitivity : r.phase_sensitivities)
      for (std::size_t a = 0; a < 6; ++a) {
        if (phase_sensitivity.body.value != body) continue;
        out.sum[a] += r.weight * phase_sensitivity.d[a];
        out.square[a] += r.weight * phase_sensitivity.d[a] * phase_sensitivity.d[a];
      }
  }
  return out;
}

std::uint32_t body_named(CouplingTable const& table, std::string const& name) {
  auto const at = std::find(table.bodies.begin(), table.bodies.end(), name);
  if (at != table.bodies.end()) return std::uint32_t(at - table.bodies.begin());
  throw InputError(fmt::format("--body: the run has no body '{}'", name),
                   fmt::format("it is one of: {}", fmt::join(table.bodies, ", ")));
}

// The requested axis, or that with most phase among those that the witness can measure.
std::size_t axis_of(std::string const& asked, PhaseSensitivities const& phase_sensitivities, bool rotation) {
  std::size_t const first = rotation ? 3 : 0;
  auto const from = phase_sensitivities.square.begin() + std::ptrdiff_t(first);
  if (asked.empty()) return first + std::size_t(std::max_element(from, from + 3) - from);
  auto const a = std::size_t(std::find(std::begin(axis_names), std::end(axis_names), asked) - std::begin(axis_names));
  if ((a > 2) == rotation) return a;
  throw InputError(fmt::format("--axis: {} is {}, and the witness measures {}", asked,
                               rotation ? "a direction" : "a rotation", rotation ? "an angle" : "a displacement"),
                   fmt::format("write --axis {}", rotation ? "rx, ry or rz" : "x, y or z"));
}

// rms phase sensitivity and its spread in units of 2k (m for rotations), with the sign of the mean where that is clear.
void find_multiplicity(RoutePrediction& p, CouplingTable const& table, CouplingClass const& c, std::string const& axis,
                       bool rotation) {
  PhaseSensitivities const phase_sensitivities = phase_sensitivities_of(c, body_named(table, p.body));
  std::size_t const a = axis_of(axis, phase_sensitivities, rotation);
  p.axis = axis_names[a];
  double const two_k = 4 * pi / table.wavelength, mean = phase_sensitivities.sum[a] / phase_sensitivities.weight;
  double const rms = std::sqrt(phase_sensitivities.square[a] / phase_sensitivities.weight);
  if (!(rms > 0))
    throw InputError(
        fmt::format("motion of '{}' along {} does not change the phase of path {}", p.body, p.axis, p.rank),
        "choose another --body or --axis");
  p.multiplicity = (mean < 0 ? -1 : 1) * rms / two_k;
  p.spread = std::sqrt(std::max(0.0, rms * rms - mean * mean)) / two_k;
}

}  // namespace

std::vector<RoutePrediction> route_predictions(PredictedRoutes const& o, bool rotation) {
  auto const run = std::make_shared<OpenRun const>(o.run);
  RunFile const& file = run->file;
  if (!run->model.detector)
    throw InputError(fmt::format("{} has no interferometer", o.run), "fit without a run, or project one");
  CouplingTable const& table = file.trace.coupling;
  PathTable const rows = table_for(table, file.noise ? &*file.noise : nullptr, run->model);
  std::vector<RoutePrediction> out;
  for (std::size_t const rank : o.rows.empty() ? std::vector<std::size_t>{1} : o.rows) {
    if (rank < 1 || rank > rows.rows.size())
      throw InputError(fmt::format("--path: the run has rows 1 to {}, not {}", rows.rows.size(), rank),
                       fmt::format("see straytrace paths {}", o.run));
    PathRow const& row = rows.rows[rank - 1];
    CouplingClass const& c = table.classes[class_of(table, row)];
    RoutePrediction p;
    p.rank = rank;
    p.route = row.sequence;
    p.port = row.port;
    p.body = o.body.empty() ? row.body : o.body;
    p.coupling = row.resolved ? row.coupling.mean * row.reverse : not_a_number;
    p.sigma = row.coupling.std_error * row.reverse;
    p.speckle = !c.deterministic();
    find_multiplicity(p, table, c, o.axis, rotation);
    p.phase = [run, port = c.port](double hz) { return run->model.detector->strain_per_phase(port, hz); };
    p.amplitude = [run, port = c.port](double hz) { return run->model.detector->strain_per_amplitude(port, hz); };
    out.push_back(std::move(p));
  }
  return out;
}

AgainstPrediction against(FittedPath const& p, RoutePrediction const& r) {
  double const f = p.amplitude.value;
  AgainstPrediction a;
  a.fraction = {f * f, 2 * f * p.amplitude.sigma};
  a.ratio.value = a.fraction.value / r.coupling;
  a.ratio.sigma = a.ratio.value * std::hypot(a.fraction.sigma / a.fraction.value, r.sigma / r.coupling);
  if (!r.speckle) return a;
  a.low = speckle_percentile(0.05);
  a.high = speckle_percentile(0.95);
  a.within = a.ratio.value + 2 * a.ratio.sigma > a.low && a.ratio.value - 2 * a.ratio.sigma < a.high;
  return a;
}

namespace {

constexpr double joined_spacing = 0.0115;  // spacing over frequency: 200 points per decade
constexpr char const* measured_columns =
    "write columns: frequency [Hz], ASD [1/sqrt(Hz)], standard error of the ASD where it is known";

void add_point(MeasuredStrain& m, double hz, double psd, double sigma) {
  m.hz.push_back(hz);
  m.asd.push_back(std::sqrt(psd));
  m.low.push_back(std::sqrt(std::max(psd - sigma, 0.0)));
  m.high.push_back(std::sqrt(psd + sigma));
}

nlohmann::json numbers_or_null(std::vector<double> const& values) {
  nlohmann::json all = nlohmann::json::array();
  for (double const v : values)
    all.push_back(std::isfinite(v) ? read_json(fmt::format("{:.6g}", v)) : nlohmann::json(nullptr));
  return all;
}

}  // namespace

MeasuredStrain measured_from(WelchSpectrum const& s, WelchSettings const& settings, double low, double high) {
  MeasuredStrain m;
  double const step = s.hz[1] - s.hz[0];
  for (std::size_t k = 1; k + 1 < s.hz.size();) {
    auto const joined = std::max<std::size_t>(1, std::size_t(joined_spacing * double(k)));
    std::size_t const end = std::min(k + joined, s.hz.size() - 1);
    double const from = s.hz[k] - step / 2, to = s.hz[end - 1] + step / 2, middle = (from + to) / 2;
    if (middle >= low && middle <= high) {
      if (end == k + 1) {
        add_point(m, s.hz[k], s.psd[k], s.sigma[k]);
      } else {
        BandPower const p = band_power(s, settings, from, to);
        add_point(m, middle, p.power / (to - from), p.sigma / (to - from));
      }
    }
    k = end;
  }
  return m;
}

MeasuredStrain parse_measured(std::string const& text, std::string const& file, double low, double high) {
  refuse_binary(text, file);
  NumberTable table = parse_numbers(text, NonFinite::refused, HeaderRow::allowed);
  for (Problem& p : table.problems) p.suggestion = measured_columns;
  if (table.problems.empty() && table.column.size() < 2)
    table.problems.push_back({{}, "it has one column, not frequency and ASD", measured_columns});
  MeasuredStrain m;
  for (std::size_t i = 0; table.problems.empty() && i < table.rows(); ++i) {
    double const hz = table.column[0][i], asd = table.column[1][i];
    double const sigma = table.column.size() > 2 ? table.column[2][i] : not_a_number;
    if (!(hz >= 0 && asd >= 0 && !(sigma < 0)) || (i > 0 && !(hz > table.column[0][i - 1]))) {
      table.problems.push_back(
          {{0, table.line[i], 1}, "frequencies rise from row to row, and no number is negative", measured_columns});
    } else if (hz >= low && hz <= high) {
      m.hz.push_back(hz);
      m.asd.push_back(asd);
      m.low.push_back(std::max(asd - sigma, 0.0) + 0 * sigma);
      m.high.push_back(asd + sigma);
    }
  }
  if (!table.problems.empty()) throw errors_in(file, std::move(table.problems));
  m.source = table.column.size() > 2 ? file : file + ", without errors";
  return m;
}

std::string measured_json(std::vector<MeasuredStrain> const& all) {
  nlohmann::json list = nlohmann::json::array();
  for (MeasuredStrain const& m : all)
    list.push_back({{"name", m.name},
                    {"source", m.source},
                    {"frequency", numbers_or_null(m.hz)},
                    {"asd", numbers_or_null(m.asd)},
                    {"low", numbers_or_null(m.low)},
                    {"high", numbers_or_null(m.high)}});
  return json_text(list);
}

}  // namespace straytrace::session
