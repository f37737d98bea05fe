// SPDX-License-Identifier: BSD-3-Clause
#include "cli/ifo/ifo_sheets.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace straytrace::cli {
namespace {

constexpr double per_degree = 180 / pi;

Sheet::Column angle(std::string const& key) { return {key, "rad", 6, per_degree, "deg"}; }

Sheet readouts_sheet(OperatingPoint const& point) {
  Sheet s{"readouts",
          "Read-outs; -: rounding, below 1e-12 of the power of the beam.",
          {{"readout", ""}, {"beam", ""}, {"value", "W", 8}},
          {}};
  for (ReadoutValue const& r : point.readouts) s.rows.push_back({r.name, r.beam, r.value});
  return s;
}

Sheet cavities_sheet(OperatingPoint const& point) {
  Sheet s{
      "cavities",
      "Resonators: phase of the carrier after a round trip (0: resonant); gain: power of all carriers over that of\n"
      "the lasers.",
      {{"cavity", ""},
       {"length", "m", 8},
       {"free_spectral_range", "Hz", 8},
       {"finesse", ""},
       {"pole", "Hz"},
       {"loss", ""},
       angle("phase"),
       {"power", "W", 8},
       {"gain", ""}},
      {}};
  for (CavityPower const& c : point.cavities)
    s.rows.push_back({c.cavity.name, c.cavity.length, c.cavity.free_spectral_range(), c.cavity.finesse(),
                      c.cavity.pole(), 1 - c.cavity.round_trip * c.cavity.round_trip, c.cavity.phase, c.power, c.gain});
  return s;
}

Sheet ports_sheet(OperatingPoint const& point) {
  std::vector<std::string> carriers;
  for (double const hz : point.carriers) carriers.push_back(fmt::format("{:.10g}", hz));
  Sheet s{"ports",
          fmt::format("Power of {} at the ports of the components; open: without a space{}.",
                      carriers.size() == 1 ? std::string("the carrier")
                                           : fmt::format("the carriers {} Hz", fmt::join(carriers, ", ")),
                      point.modes ? ";\nfundamental: share of mode (0,0) in what leaves" : ""),
          {{"port", ""}, {"enters", "W", 8}, {"leaves", "W", 8}, {"open", ""}},
          {}};
  if (point.modes) s.columns.push_back({"fundamental", "", 8});
  for (PortPower const& p : point.ports) {
    s.rows.push_back({p.port, p.in, p.out, std::string(p.open ? "open" : "")});
    if (point.modes) s.rows.back().emplace_back(p.out > 0 ? p.fundamental / p.out : not_a_number);
  }
  return s;
}

Sheet energy_sheet(OperatingPoint const& point) {
  constexpr std::array<char const*, 4> names = {"emitted by", "leaves at", "absorbed in", "lost in"};
  Sheet s{"energy",
          fmt::format("Energy balance: what the lasers emit, less all else, is {:.1e} of it.",
                      point.missing / point.emitted),
          {{"light", ""}, {"where", ""}, {"power", "W", 8}, {"share", ""}},
          {}};
  for (EnergyRow const& row : point.energy)
    s.rows.push_back({std::string(names[std::size_t(row.kind)]), row.name, row.power, row.power / point.emitted});
  return s;
}

}  // namespace

std::vector<Sheet> point_sheets(OperatingPoint const& point) {
  std::vector<Sheet> all;
  if (!point.readouts.empty()) all.push_back(readouts_sheet(point));
  if (!point.cavities.empty()) all.push_back(cavities_sheet(point));
  all.push_back(ports_sheet(point));
  all.push_back(energy_sheet(point));
  return all;
}

namespace {

Sheet resonances_sheet(ModeTable const& table) {
  Sheet s{
      "resonances",
      "Modes of cavities: stability (A + D)/2 of a round trip along x and y, lag per order; where the modes (1,0),\n"
      "(0,1) and (2,0) resonate, in round trips beyond (0,0) (eq. N.10); basis: the network uses this mode.",
      {{"cavity", ""},
       {"start", ""},
       {"stability_x", "", 8},
       {"stability_y", "", 8},
       angle("gouy_x"),
       angle("gouy_y"),
       {"at_10", "", 6},
       {"at_01", "", 6},
       {"at_20", "", 6},
       {"basis", ""}},
      {}};
  for (Resonance const& r : table.resonances) {
    auto const of_stable = [&](double v) { return r.stable ? v : not_a_number; };
    auto const at = [&](int n, int m) { return of_stable(r.mode.phase_beyond(n, m) / (2 * pi)); };
    s.rows.push_back({r.cavity, r.start, r.mode.stability[0], r.mode.stability[1], of_stable(r.mode.gouy[0]),
                      of_stable(r.mode.gouy[1]), at(1, 0), at(0, 1), at(2, 0), std::string(r.basis ? "basis" : "")});
  }
  return s;
}

Sheet contents_sheet(ModeTable const& table) {
  Sheet s{"content",
          "Light that leaves the ports: radii of the basis, and shares of its power by order n + m.",
          {{"port", ""}, {"power", "W", 8}, {"w_x", "m", 6}, {"w_y", "m", 6}},
          {}};
  for (int order = 0; order <= table.truncation.order; ++order)
    s.columns.push_back({fmt::format("order_{}", order), "", 8});
  for (BeamModes const& b : table.beams) {
    std::vector<Sheet::Cell> row{b.port, b.power, b.w[0], b.w[1]};
    for (double const share : b.share) row.emplace_back(share);
    s.rows.push_back(std::move(row));
  }
  return s;
}

Sheet truncation_sheet(Truncation const& t) {
  Sheet s{"truncation",
          fmt::format("Do the modes suffice? change: of the power of a beam from order {} to {}, the largest; missing: "
                      "light that\nthe modes do not take. Limit of both: {:g}.",
                      t.lower, t.order, Truncation::most_change),
          {{"order", ""}, {"beam", ""}, {"change", ""}, {"missing", "W"}, {"missing_share", ""}, {"verdict", ""}},
          {}};
  s.rows.push_back(
      {double(t.order), t.beam, t.change, t.missing, t.missing / t.emitted,
       std::string(t.converged() ? "converged" : "not converged: raise 'order', or use the wave model of the scene")});
  return s;
}

}  // namespace

std::vector<Sheet> mode_sheets(ModeTable const& table) {
  std::vector<Sheet> all{resonances_sheet(table)};
  if (!table.mismatches.empty()) {
    Sheet s{"mismatch",
            "Where bases meet: share of the power of 00 that goes to other modes, 1 - |K_00|^2 (eq. N.7).",
            {{"from", ""}, {"to", ""}, {"mismatch", ""}},
            {}};
    for (BasisMismatch const& m : table.mismatches) s.rows.push_back({m.from, m.to, m.mismatch});
    all.push_back(std::move(s));
  }
  all.push_back(contents_sheet(table));
  all.push_back(truncation_sheet(table.truncation));
  return all;
}

Sheet scan_sheet(NetworkModel const& model, NetworkScan const& scan) {
  std::vector<std::string> names;
  for (ScanAxis const& axis : scan.axes) names.push_back(fmt::format("'{}'", axis.parameter.name));
  Sheet s{"scan", fmt::format("Read-outs against {}; -: rounding.", fmt::join(names, " and ")), {}, {}};
  for (ScanAxis const& axis : scan.axes) {
    Dimension const d = axis.parameter.dimension;
    s.columns.push_back(d == dim::angle
                            ? angle(axis.parameter.name)
                            : Sheet::Column{axis.parameter.name, d == dim::plain ? "" : example_unit(d), 8});
  }
  for (NamedReadout const& r : model.readouts) s.columns.push_back({r.name, unit_of(r.readout), 8});
  for (std::size_t i = 0; i < scan.values.front().size(); ++i) {
    std::vector<Sheet::Cell> row;
    std::size_t rest = i;
    for (ScanAxis const& axis : scan.axes) {
      row.emplace_back(axis.at(rest % axis.points));
      rest /= axis.points;
    }
    for (auto const& values : scan.values) row.emplace_back(values[i]);
    s.rows.push_back(std::move(row));
  }
  return s;
}

Sheet slopes_sheet(NamedReadout const& readout, std::vector<ParameterSlope> const& slopes) {
  Sheet s{"slopes",
          fmt::format("Slope of '{}' with respect to the numbers of the network (eq. N.3), per SI unit; -: rounding.",
                      readout.name),
          {{"parameter", ""}, {"value", ""}, {"unit", ""}, {"slope", ""}, {"slope_unit", ""}},
          {}};
  for (ParameterSlope const& p : slopes) {
    Dimension const d = p.parameter.dimension;
    std::string const unit = d == dim::plain ? "" : d == dim::angle ? "rad" : example_unit(d);
    std::string per = unit_of(readout.readout);
    if (!unit.empty()) per += unit.find('/') == unit.npos ? "/" + unit : "/(" + unit + ")";
    s.rows.push_back({p.parameter.name, p.parameter.value, unit, p.slope, per});
  }
  return s;
}

Sheet errors_sheet(std::vector<ErrorSignal> const& signals) {
  Sheet s{"errors",
          signals.empty() ? "No read-out of power responds to a degree of freedom of the network."
                          : "Signals at the operating point. best_phase: of demodulation, with the slope there; "
                            "linear_range: span where the\n"
                            "slope is within 10 %; offset: way to the zero of the tangent; -: rounding.",
          {{"readout", ""},
           {"freedom", ""},
           {"value", "W"},
           {"slope", "W/m"},
           angle("best_phase"),
           {"best_slope", "W/m"},
           {"linear_range", "m"},
           {"offset", "m"}},
          {}};
  for (ErrorSignal const& e : signals)
    s.rows.push_back({e.readout, e.freedom, e.value, e.slope, e.best_phase, e.best_slope, e.linear_range, e.offset()});
  return s;
}

Sheet transfer_sheet(NetworkCause const& cause, std::string const& effect, std::string const& effect_unit,
                     std::vector<double> const& hz, std::vector<Phasor> const& response) {
  std::string const unit = fmt::format("{}/{}", effect_unit, cause.unit());
  Sheet s{"transfer",
          fmt::format("Response of '{}' to '{}', for exp(+2 pi i f t).", effect, cause.name),
          {{"frequency", "Hz"}, {"re", unit, 8}, {"im", unit, 8}, {"magnitude", unit, 8}, angle("phase")},
          {}};
  for (std::size_t i = 0; i < hz.size(); ++i)
    s.rows.push_back({hz[i], response[i].real(), response[i].imag(), std::abs(response[i]), std::arg(response[i])});
  return s;
}

Sheet sensing_sheet(SensingMatrix const& m) {
  std::string const name = fmt::format("sensing_{:g}Hz", m.hz);
  if (m.readouts.empty() || m.freedoms.empty())
    return {name, "The network has no read-outs or no degrees of freedom.", {}, {}};
  Sheet s{
      name,
      fmt::format("Responses at {:g} Hz in W/m (sqrt(W)/m of a homodyne detector), for exp(+2 pi i f t); -: rounding.\n"
                  "Condition number with rows of equal size: {:.4g}.",
                  m.hz, m.condition),
      {{"readout", ""}},
      {}};
  for (std::string const& f : m.freedoms) {
    s.columns.push_back({f, "", 6});
    s.columns.push_back({"arg_" + f, "rad", 4, per_degree, "deg"});
  }
  for (std::size_t i = 0; i < m.readouts.size(); ++i) {
    std::vector<Sheet::Cell> row{m.readouts[i]};
    for (std::size_t j = 0; j < m.freedoms.size(); ++j) {
      Phasor const z = m.response(Eigen::Index(i), Eigen::Index(j));
      row.emplace_back(std::abs(z));
      row.emplace_back(std::arg(z));
    }
    s.rows.push_back(std::move(row));
  }
  return s;
}

namespace {

// Phases for exp(+2 pi i f t).
void add_response(std::vector<Sheet::Cell>& row, Phasor response) {
  row.emplace_back(std::abs(response));
  row.emplace_back(-std::arg(response));
}

}  // namespace

Sheet stray_sheet(NetworkModel const& model, std::vector<StrayRow> const& rows) {
  bool const modes = model.network.modes().has_value();
  double const hz = rows.empty() ? not_a_number : rows.front().hz;
  Sheet s{fmt::format("stray_{:g}Hz", hz),
          fmt::format(
              "Responses at {:g} Hz to a stray field s relative to the light that is scattered: phase per Im s, "
              "amplitude\n"
              "per Re s, for exp(+2 pi i f t); h: strain; gain: for Gamma in eq. 9.2; -: rounding.{}",
              hz,
              modes ? "\nlight_beyond, weight_beyond: shares of the light that is scattered and of the weight of the "
                      "beam it joins that are\nnot in mode 00, which these responses leave out (eq. N.16)."
                    : ""),
          {{"entrance", ""},
           {"relative_to", ""},
           {"joins", ""},
           {"power", "W"},
           {"readout", ""},
           {"unit", ""},
           {"phase", ""},
           angle("arg_phase"),
           {"amplitude", ""},
           angle("arg_amplitude"),
           {"gain", "", 4}},
          {}};
  if (modes) s.columns.insert(s.columns.end(), {{"light_beyond", "", 3}, {"weight_beyond", "", 3}});
  for (StrayRow const& r : rows) {
    std::vector<Sheet::Cell> row{r.entrance, r.lit, r.fed, r.power, r.readout, r.unit};
    add_response(row, r.phase());
    add_response(row, r.amplitude());
    row.emplace_back(r.gain);
    if (modes) row.insert(row.end(), {r.beyond.light, r.beyond.weight});
    s.rows.push_back(std::move(row));
  }
  return s;
}

Sheet stray_curve(std::vector<StrayRow> const& rows, std::string const& readout) {
  Sheet s{"stray", "", {{"frequency", "Hz"}}, {}};
  for (StrayRow const& r : rows) {
    if (r.readout != readout) continue;
    if (s.rows.empty()) {
      s.heading =
          fmt::format("Response of '{}' to light of '{}' that joins '{}', per Im s and Re s, for exp(+2 pi i f t).",
                      readout, r.lit, r.fed);
      s.columns.insert(s.columns.end(),
                       {{"phase", r.unit}, angle("arg_phase"), {"amplitude", r.unit}, angle("arg_amplitude")});
    }
    std::vector<Sheet::Cell> row{r.hz};
    add_response(row, r.phase());
    add_response(row, r.amplitude());
    s.rows.push_back(std::move(row));
  }
  return s;
}

Sheet noise_sheet(NamedReadout const& readout, NamedFreedom const* referred, ReadoutNoise const& noise) {
  std::string const unit = fmt::format("{}/sqrt(Hz)", referred ? "m" : unit_of(readout.readout));
  Sheet s{"noise",
          fmt::format("Noise of '{}'{}, one-sided. vacuum: quantum noise; total: with all stated noises.", readout.name,
                      referred ? fmt::format(" as displacement of {}", referred->name) : ""),
          {{"frequency", "Hz"}},
          {}};
  for (std::string const& name : noise.names) s.columns.push_back({name, unit, 5});
  s.columns.push_back({"total", unit, 5});
  for (std::size_t i = 0; i < noise.hz.size(); ++i) {
    std::vector<Sheet::Cell> row{noise.hz[i]};
    for (auto const& part : noise.asd) row.emplace_back(part[i]);
    row.emplace_back(noise.total[i]);
    s.rows.push_back(std::move(row));
  }
  return s;
}

namespace {

Sheet loops_sheet(LoopTable const& t) {
  Sheet loops{
      fmt::format("loops_{:g}Hz", t.hz),
      fmt::format("Loops at {:g} Hz, for exp(+2 pi i f t). plant: sensor per m, without loops; gain: open loop G; "
                  "least: smallest |1 + G| of\nthe band, encircled: G goes around -1; noise_to_strain: strain "
                  "per unit of noise of the sensor.",
                  t.hz),
      {{"length", ""},
       {"sensor", ""},
       {"plant", "W/m"},
       {"gain", ""},
       angle("arg_gain"),
       {"suppression", ""},
       {"unity_gain", "Hz"},
       angle("phase_margin"),
       {"least", ""},
       {"least_at", "Hz"},
       {"encircled", ""},
       {"noise_to_strain", "1/W"}},
      {}};
  for (LoopRow const& r : t.loops) {
    LoopMargins const& m = r.margins;
    bool const closed = !std::isnan(std::abs(r.open_loop));
    loops.rows.push_back({r.length, r.sensor, std::abs(r.plant), std::abs(r.open_loop), std::arg(r.open_loop),
                          std::abs(r.suppressed), m.unity_gain, m.phase_margin, closed ? m.least : not_a_number,
                          m.least_at, std::string(m.encircles ? "yes" : ""), std::abs(r.noise_to_strain)});
  }
  return loops;
}

Sheet stray_by_loop_sheet(LoopTable const& t) {
  Sheet stray{fmt::format("stray_{:g}Hz", t.hz),
              "Strain per relative stray field (magnitudes): with all lengths held, by the motion of each length, and "
              "their complex sum.",
              {{"entrance", ""}, {"quadrature", ""}, {"held", ""}},
              {}};
  for (std::string const& length : t.lengths) stray.columns.push_back({"by_" + length, ""});
  stray.columns.push_back({"total", ""});
  for (StrayByLoop const& s : t.stray) {
    std::vector<Sheet::Cell> row{s.entrance, std::string(s.phase ? "phase" : "amplitude"), std::abs(s.held)};
    for (Phasor const z : s.by_length) row.emplace_back(std::abs(z));
    row.emplace_back(std::abs(s.total));
    stray.rows.push_back(std::move(row));
  }
  return stray;
}

Sheet noise_by_loop_sheet(LoopTable const& t) {
  Sheet s{
      fmt::format("noise_{:g}Hz", t.hz),
      "Noise of the strain, 1/sqrt(Hz): with all lengths held, by the motion of each length, and their sum, in which "
      "the\nways of one noise interfere. The vacuum enters at open ports and losses.",
      {{"noise", ""}, {"held", "1/sqrt(Hz)"}},
      {}};
  for (std::string const& length : t.lengths) s.columns.push_back({"by_" + length, "1/sqrt(Hz)"});
  s.columns.push_back({"total", "1/sqrt(Hz)"});
  for (NoiseByLoop const& n : t.noise) {
    std::vector<Sheet::Cell> row{n.noise, n.held};
    for (double const by : n.by_length) row.emplace_back(by);
    row.emplace_back(n.total);
    s.rows.push_back(std::move(row));
  }
  return s;
}

Sheet filters_sheet(LoopTable const& t) {
  Sheet s{fmt::format("filters_{:g}Hz", t.hz),
          "Channels that are added to the read-out of strain, through filters in its unit per unit of the channel, for "
          "exp(+2 pi i f t)\n(eq. N.33); best: of the least noise.",
          {{"channel", ""}, {"kind", ""}, {"filter", ""}, angle("arg_filter")},
          {}};
  for (SubtractedRow const& r : t.subtracted)
    s.rows.push_back({r.channel, std::string(r.best ? "best" : "stated"), std::abs(r.filter), std::arg(r.filter)});
  return s;
}

}  // namespace

std::vector<Sheet> loop_sheets(LoopTable const& t) {
  std::vector<Sheet> all;
  if (!t.loops.empty()) all.push_back(loops_sheet(t));
  if (!t.stray.empty()) all.push_back(stray_by_loop_sheet(t));
  all.push_back(noise_by_loop_sheet(t));
  if (!t.subtracted.empty()) all.push_back(filters_sheet(t));
  return all;
}

Sheet suppression_sheet(std::vector<double> const& hz, std::vector<LoopCurve> const& curves) {
  Sheet s{"suppression",
          "Suppression 1/(1 + G) of the loops, and their open-loop gains G, for exp(+2 pi i f t).",
          {{"frequency", "Hz"}},
          {}};
  for (LoopCurve const& c : curves) s.columns.push_back({c.length, "", 5});
  for (LoopCurve const& c : curves) {
    s.columns.push_back({"gain_" + c.length, "", 5});
    s.columns.push_back(angle("arg_gain_" + c.length));
  }
  for (std::size_t i = 0; i < hz.size(); ++i) {
    std::vector<Sheet::Cell> row{hz[i]};
    for (LoopCurve const& c : curves) row.emplace_back(std::abs(c.suppressed[i]));
    for (LoopCurve const& c : curves) {
      row.emplace_back(std::abs(c.open_loop[i]));
      row.emplace_back(std::arg(c.open_loop[i]));
    }
    s.rows.push_back(std::move(row));
  }
  return s;
}

namespace {

// What subtraction does where the channel also holds DARM.
std::string worse_text(StrainNoise const& noise) {
  std::size_t worse = 0;
  for (std::size_t i = 0; i < noise.as_read.size(); ++i)
    worse += noise.total[i] > (1 + 1e-9) * noise.as_read[i] ? 1 : 0;
  return worse == 0
             ? ""
             : fmt::format("\nSubtraction raises the noise of h at {} of {} frequencies: the channel also holds DARM.",
                           worse, noise.as_read.size());
}

}  // namespace

Sheet strain_noise_sheet(StrainNoise const& noise) {
  Sheet s{"strain_noise",
          "Noise of the strain with all loops acting, one-sided. vacuum: quantum noise; total: with all stated noises" +
              std::string(noise.as_read.empty() ? "." : "; as_read:\nthe total without subtracted channels.") +
              worse_text(noise),
          {{"frequency", "Hz"}},
          {}};
  for (std::string const& name : noise.names) s.columns.push_back({name, "1/sqrt(Hz)", 5});
  s.columns.push_back({"total", "1/sqrt(Hz)", 5});
  if (!noise.as_read.empty()) s.columns.push_back({"as_read", "1/sqrt(Hz)", 5});
  for (std::size_t i = 0; i < noise.hz.size(); ++i) {
    std::vector<Sheet::Cell> row{noise.hz[i]};
    for (auto const& part : noise.asd) row.emplace_back(part[i]);
    row.emplace_back(noise.total[i]);
    if (!noise.as_read.empty()) row.emplace_back(noise.as_read[i]);
    s.rows.push_back(std::move(row));
  }
  return s;
}

}  // namespace straytrace::cli
