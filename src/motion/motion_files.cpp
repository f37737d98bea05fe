// SPDX-License-Identifier: BSD-3-Clause
#include "motion/motion_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/math/linear_algebra.hpp"
#include "base/text/words.hpp"
#include "io/delimited_text.hpp"
#include "spectra/curve.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::motion {
namespace {

using Response = TransferFunction::Response;

constexpr double standard_gravity = 9.80665;  // m/s^2
constexpr char const* links =
    "write {resonance: {frequency: 8 Hz, quality: 50}}, {pendulum: {frequency: 0.6 Hz, quality: 10}}, {zeros: [...], "
    "poles: [...], gain: 1} or {file: FILE, columns: [Hz, re, im]}";

TransferFunction read_oscillator(Node const& t, Response response, std::string_view what) {
  double const frequency = t.number("frequency", dim::frequency, required, 1e-6),
               quality = t.number("quality", dim::plain, required, 0.5);
  t.refuse_unknown(what);
  return std::isfinite(frequency * quality) ? TransferFunction::oscillator(frequency, quality, response)
                                            : TransferFunction({}, {}, 1);
}

TransferFunction read_chain_of_masses(Node const& t) {
  std::vector<double> masses, lengths;
  for (Node const& m : t.list("masses")) masses.push_back(m.as_number(dim::mass, 1e-6));
  for (Node const& l : t.list("lengths")) lengths.push_back(l.as_number(dim::length, 1e-6));
  double const quality = t.number("quality", dim::plain, required, 0.5);
  t.refuse_unknown("'pendulum'");
  TransferFunction chain({}, {}, 1);
  if (masses.empty() || masses.size() != lengths.size()) {
    t.problem("a chain of pendulums has as many lengths as masses",
              "write 'masses: [30 kg, 40 kg], lengths: [1 m, 0.7 m]'");
    return chain;
  }
  for (std::size_t i = 0; i < masses.size(); ++i)
    if (!std::isfinite(masses[i] * lengths[i] * quality)) return chain;  // reported already
  for (double const hz : pendulum_modes(masses, lengths))
    chain = TransferFunction::product(chain, TransferFunction::oscillator(hz, quality, Response::inertial));
  return chain;
}

TransferFunction read_table_or_roots(Node const& link) {
  if (!link.has("beyond")) return read_transfer_function(link, {});
  constexpr std::array<std::string_view, 1> only = {"hold"};
  bool const holds = !link.choice("beyond", only).empty();
  TransferFunction const t = read_transfer_function(link, {});
  return holds ? t.holding_ends() : t;
}

TransferFunction read_link(Node const& link) {
  bool const resonance = link.has("resonance"), pendulum = link.has("pendulum"), mode = link.has("mode");
  if (link.kind() != Node::Kind::table || resonance + pendulum + mode > 1) {
    link.problem("this is not one link of a chain", links);
    return {{}, {}, 1};
  }
  if (!resonance && !pendulum && !mode) {
    if (link.has("file") || link.has("gain") || link.has("zeros") || link.has("poles"))
      return read_table_or_roots(link);
    std::string near;
    std::vector<std::string> const words = {"resonance", "pendulum", "mode", "file", "zeros", "poles", "gain"};
    for (auto const& entry : link.items())
      if (near.empty()) near = nearest_word(entry.first, words);
    link.problem("the kind of this link of a chain is missing",
                 near.empty() ? links : fmt::format("did you mean '{}'?", near));
    return {{}, {}, 1};
  }
  TransferFunction const t = resonance ? read_oscillator(link.table("resonance"), Response::support, "'resonance'")
                             : mode    ? read_oscillator(link.table("mode"), Response::relative, "'mode'")
                                       : read_stages(link["pendulum"]);
  link.refuse_unknown("a link of a chain");
  return t;
}

}  // namespace

Transfer chained(Transfer const& a, Transfer const& b) {
  if (!a || !b) return a ? a : b;
  return std::make_shared<TransferFunction const>(TransferFunction::product(*a, *b));
}

bool covers(Transfer const& t, double low, double high, Node const& where) {
  constexpr double edge = 1e-9;  // relative, of a printed number
  Band const known = t ? t->range() : Band{0, infinity};
  if (low >= known.low * (1 - edge) && high <= known.high * (1 + edge)) return true;
  where.problem(fmt::format("the chain covers {:g} Hz to {:g} Hz, but the motion {:g} Hz to {:g} Hz", known.low,
                            known.high, low, high),
                "give a file that covers it, end the motion there, or write 'beyond: hold' with the file");
  return false;
}

std::complex<double> at_tone(Transfer const& t, double hz, Node const& where) {
  return t && covers(t, hz, hz, where) ? std::conj((*t)(hz)) : 1;
}

Transfer read_chain(Node const& through) {
  if (!through) return {};
  TransferFunction chain({}, {}, 1);
  for (Node const& link : through.as_list()) chain = TransferFunction::product(chain, read_link(link));
  return std::make_shared<TransferFunction const>(std::move(chain));
}

TransferFunction read_stages(Node const& stages) {
  if (stages.kind() == Node::Kind::table && stages.has("masses")) return read_chain_of_masses(stages);
  TransferFunction chain({}, {}, 1);
  for (Node const& stage : stages.as_list()) {
    if (stage.kind() == Node::Kind::table)
      chain = TransferFunction::product(chain, read_oscillator(stage, Response::inertial, "'pendulum'"));
    else
      stage.problem("a stage of a suspension is a table", "write {frequency: 0.6 Hz, quality: 10}");
  }
  return chain;
}

std::vector<double> pendulum_modes(std::vector<double> const& masses, std::vector<double> const& lengths) {
  auto const n = std::ssize(masses);
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);  // stiffness, weighted with the masses: M^-1/2 K M^-1/2
  double below = 0;                                 // mass that the thread carries
  for (auto i = n - 1; i >= 0; --i) {
    below += masses[std::size_t(i)];
    double const stiffness = standard_gravity * below / lengths[std::size_t(i)], m = masses[std::size_t(i)];
    k(i, i) += stiffness / m;
    if (i == 0) break;
    double const above = masses[std::size_t(i - 1)];
    k(i - 1, i - 1) += stiffness / above;
    k(i, i - 1) = k(i - 1, i) = -stiffness / std::sqrt(m * above);
  }
  std::vector<double> hz;
  for (double const square : symmetric_eigenvalues(k)) hz.push_back(std::sqrt(square) / (2 * pi));
  return hz;
}

namespace {

constexpr double edge = 0.02;           // relative, half a bin of the usual grid
constexpr double slowest = 0.1;         // Hz: below the microseism the speed is negligible
constexpr double largest_over_rms = 4;  // of a Gaussian speed

// "below 5 Hz and above 100 Hz"; empty when the file covers the whole band.
std::string missing_part(Band const& have, Band const& noise) {
  bool const below = have.low > noise.low * (1 + edge), above = have.high < noise.high * (1 - edge);
  std::string text = below ? fmt::format("below {:.4g} Hz", have.low) : "";
  if (above) text += fmt::format("{}above {:.4g} Hz", below ? " and " : "", have.high);
  return text;
}

}  // namespace

Band joined(Band a, std::span<Band const> others) {
  for (bool grew = true; grew;) {
    grew = false;
    for (Band const& b : others) {
      if (b.low > a.high * (1 + edge) || b.high < a.low * (1 - edge)) continue;
      grew = grew || b.low < a.low || b.high > a.high;
      a = {std::min(a.low, b.low), std::max(a.high, b.high)};
    }
  }
  return a;
}

double reach_of_missing(MotionFile const& file, double wavelength) {
  double const f = file.covered.low;
  if (!(f > slowest) || f < file.known.low) return 0;
  double const speed = 2 * pi * file.asd_low * f * f * std::sqrt(1 / slowest - 1 / f);
  return largest_over_rms * 2 * speed / wavelength;
}

std::vector<Problem> warnings_of_gaps(std::span<MotionFile const> files, Band noise, double wavelength) {
  std::vector<Problem> all;
  std::set<std::string> told;
  for (MotionFile const& file : files) {
    std::string const missing = missing_part(file.covered, noise);
    double const reach = reach_of_missing(file, wavelength);
    bool const slow = reach > noise.low, begins_above = file.covered.low > noise.low * (1 + edge);
    if ((missing.empty() && !slow) || !told.insert(file.name).second) continue;
    std::string what = fmt::format(
        "'{}' gives the motion of '{}' from {:.4g} Hz to {:.4g} Hz, and the noise covers {:.4g} Hz to {:.4g} Hz",
        file.name, file.coordinate, file.known.low, file.known.high, noise.low, noise.high);
    if (!missing.empty()) what += fmt::format(": {} the body counts as still", missing);
    if (slow)
      what += fmt::format(
          "{} motion below {:.4g} Hz changes how fringes wrap: continued as f^-2 it would add noise up "
          "to about {:.2g} Hz",
          missing.empty() ? ": missing" : "; the missing", file.covered.low, reach);
    else if (begins_above)
      what += "; slow motion that is missing also changes how fringes wrap";
    all.push_back({file.place, std::move(what),
                   "give a file that covers it, add a model for the rest in a list, [{...}, {power-law: ...}], choose "
                   "'band' in 'noise' inside it, or write 'beyond: zero' beside the file where there is no motion",
                   Severity::warning, std::max(1u, code_points(file.name))});
  }
  return all;
}

namespace {

double psd(Calibration const& c, double hz, double value) {
  double const squared = c.is_psd ? c.factor * c.factor * value : std::pow(c.factor * value, 2);
  return squared / std::pow(2 * pi * hz, 2 * c.derivatives);
}

std::size_t column_number(Node const& node) {
  double const n = node.as_number(dim::plain, 1, 1000);
  if (std::isfinite(n) && n != std::floor(n))
    node.problem("columns are counted in whole numbers from 1", "write 'use: [1, 2]'");
  return std::isfinite(n) ? static_cast<std::size_t>(n) : 1;
}

struct Columns {
  std::size_t frequency = 1, value = 2;  // counted from 1
  double hz = 1;                         // unit of the frequency column
  Calibration calibration;
};

std::optional<Columns> read_columns(Node const& spec, bool rotation) {
  std::string const example = rotation ? "columns: [Hz, rad/sqrt(Hz)]" : "columns: [Hz, m/sqrt(Hz)]";
  std::vector<Node> units = spec.list("columns"), use = spec.list("use");
  if (Node const file = spec["asd"]; units.empty() && file.text().find("sqrt(Hz)") != std::string::npos) {
    file.problem(
        fmt::format("'asd' names a file, got a value, \"{}\"", file.text()),
        fmt::format("for one level write {{power-law: {{asd: {}, at: 10 Hz, exponent: 0, from: 1 Hz, to: 1 kHz}}}}",
                    file.text()));
    return {};
  }
  if (units.size() < 2 || (units.size() > 2 && use.empty()) || (!use.empty() && use.size() != 2)) {
    spec.problem("name the two columns to read and their units",
                 fmt::format("write '{}', and 'use: [1, 3]' to pick two", example));
    return {};
  }
  Columns c;
  if (!use.empty()) {
    c.frequency = column_number(use[0]);
    c.value = column_number(use[1]);
    if (units.size() > 2 && std::max(c.frequency, c.value) > units.size()) {
      spec.problem(fmt::format("'use' names a column beyond the {} of 'columns'", units.size()),
                   "name the unit of every column");
      return {};
    }
    if (units.size() > 2) units = {units[c.frequency - 1], units[c.value - 1]};
  }
  auto const hz = parse_unit(units[0].as_word()), value = parse_unit(units[1].as_word());
  auto const how = value ? read_calibration(spec, *value, units[1].text(), true, rotation, units[1]) : std::nullopt;
  if (!hz || hz->dimension != dim::frequency)
    units[0].problem(fmt::format("\"{}\" is not a unit of frequency", units[0].text()), "write 'Hz'");
  if (!value)
    units[1].problem(fmt::format("\"{}\" is not a unit", units[1].text()),
                     fmt::format("write for example '{}'", example));
  if (!hz || hz->dimension != dim::frequency || !how) return {};
  c.hz = hz->si;
  c.calibration = *how;
  return c;
}

}  // namespace

Spectrum read_spectrum_file(Node const& spec, bool rotation) {
  Node const file = spec["asd"];
  std::string const name = file.as_word();
  auto const columns = read_columns(spec, rotation);
  if (name.empty() || !columns) return {};
  constexpr char const* remedy = "give columns of numbers with increasing frequency";
  auto const table = read_numbers(file, 0, remedy);
  if (!table) return {};
  std::size_t const there = table->column.size(), wanted = std::max(columns->frequency, columns->value);
  if (wanted > there) {
    (spec.has("use") ? spec["use"] : file)
        .problem(fmt::format("'{}' has {}; column {} does not exist", name, counted(there, "column"), wanted),
                 "write the numbers of the columns of frequency and motion, for example 'use: [1, 2]'");
    return {};
  }
  if (there > 2 && !spec.has("use") && spec.list("columns").size() != there) {
    file.problem(fmt::format("'{}' has {} columns, and 'columns' names two", name, there),
                 "pick two with 'use: [1, 2]'; write decimal points, 0.5, not commas");
    return {};
  }
  Curve curve = curve_of(*table, columns->frequency, columns->value);
  for (Problem const& p : curve.problems) file.file_problem(name, p.place.line, p.place.column, p.what, remedy);
  if (!curve.problems.empty()) return {};
  for (std::size_t i = 0; i < curve.hz.size(); ++i) {
    curve.hz[i] *= columns->hz;
    curve.value[i] = psd(columns->calibration, curve.hz[i], curve.value[i]);
  }
  Spectrum const s(std::move(curve.hz), std::move(curve.value));
  Transfer const& response = columns->calibration.response;
  if (!response || !covers(response, s.lowest(), s.highest(), spec["calibration"])) return s;
  return filtered(
      s, [&](double f) { return std::norm((*response)(f)); }, response->features());
}

namespace {

struct Scale {
  Quantity per_value{1, {}, {}};
  Transfer response = {};
};

// Empty after a problem.
std::optional<Scale> read_scale(Node const& node) {
  if (!node) return Scale{};
  if (node.kind() != Node::Kind::table) {
    Quantity const q = node.as_quantity();
    return std::isfinite(q.si) && q.si != 0 ? std::optional(Scale{q, {}}) : std::nullopt;
  }
  std::string const text = node.word("unit");
  auto const unit = parse_unit(text);
  if (!text.empty() && !unit)
    node["unit"].problem(fmt::format("\"{}\" is not a unit", text),
                         "write motion per reading, for example 'um/s^2/count'");
  bool const flat = !node.has("file") && !node.has("gain") && !node.has("zeros") && !node.has("poles");
  if (flat && !node.has("resonance") && !node.has("pendulum") && !node.has("mode")) {
    node.problem("the calibration has a unit but no response of the sensor",
                 fmt::format("write 'calibration: 1 {}', or add zeros, poles and gain, or a file", text));
    return {};
  }
  Transfer response = read_chain(node);
  return unit ? std::optional(Scale{*unit, std::move(response)}) : std::nullopt;
}

void refuse(Quantity const& unit, std::string const& written, bool of_density, bool rotation, bool calibrated,
            Node const& at) {
  char const* const good = rotation     ? (of_density ? "'rad/sqrt(Hz)' or 'rad^2/Hz'" : "'rad', 'rad/s' or 'rad/s^2'")
                           : of_density ? "'m/sqrt(Hz)' or 'm^2/Hz' (velocity and acceleration: 'm/s/sqrt(Hz)', "
                                          "'m/s^2/sqrt(Hz)')"
                                        : "'m', 'm/s' or 'm/s^2'";
  std::string const what = fmt::format("\"{}\" is not a unit of a {}{}", written, rotation ? "rotation" : "motion",
                                       of_density ? " spectrum" : "");
  bool const raw = unit.dimension.count != 0 || unit.dimension.volt != 0;
  if (calibrated)
    at.problem(what + ", nor is it with this calibration",
               "the calibration is the motion per unit of the reading, for example '6.1 um/s^2/count'");
  else
    at.problem(what, raw ? "add the motion per unit, for example 'calibration: 6.1 um/s^2/count'"
                         : fmt::format("write {}", good));
}

}  // namespace

std::optional<Calibration> read_calibration(Node const& spec, Quantity const& unit, std::string const& written,
                                            bool of_density, bool rotation, Node const& unit_at) {
  auto const scale = read_scale(spec["calibration"]);
  if (!scale) return {};
  for (int derivatives = 0; derivatives <= 2; ++derivatives) {
    Dimension motion = rotation ? dim::angle : dim::length;
    motion.second = static_cast<std::int8_t>(motion.second - 2 * derivatives);
    auto const reading = times(motion, scale->per_value.dimension, -1);
    if (!reading) continue;
    Dimension asd = *reading;
    asd.second = static_cast<std::int8_t>(asd.second + (of_density ? 1 : 0));
    if (unit.dimension == asd) return Calibration{unit.si * scale->per_value.si, false, derivatives, scale->response};
    auto const psd = times(asd, asd);
    if (of_density && psd && unit.dimension == *psd)
      return Calibration{std::sqrt(unit.si) * scale->per_value.si, true, derivatives, scale->response};
  }
  refuse(unit, written, of_density, rotation, spec.has("calibration"), unit_at);
  return {};
}

}  // namespace straytrace::motion
