// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/layout/signals.hpp"

#include <Eigen/SVD>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/errors.hpp"
#include "ifo/control_loops.hpp"
#include "ifo/mode_bases.hpp"

namespace straytrace::ifo {
namespace {

using Component = Network::Component;

// A number of a component: where it is stated, and how the component is made again.
struct Member {
  std::string_view name;
  Dimension dimension;
  double low, high;
  double (*get)(Component const&, double wavelength);
  void (*set)(Component&, double, double wavelength);
};

// A number that is stated as a member of `Parameters`.
template <class Parameters, double Parameters::*member>
constexpr Member stated(std::string_view name, Dimension dimension, double low, double high) {
  return {name,
          dimension,
          low,
          high,
          [](Component const& c, double) { return std::get<Parameters>(c.stated).*member; },
          [](Component& c, double to, double) { std::get<Parameters>(c.stated).*member = to; }};
}

template <std::size_t axis>
Member tilt_about(std::string_view name) {
  return {name,
          dim::angle,
          -0.1,
          0.1,
          [](Component const& c, double) { return std::get<MirrorParameters>(c.stated).tilt[axis]; },
          [](Component& c, double to, double) { std::get<MirrorParameters>(c.stated).tilt[axis] = to; }};
}

std::vector<Member> members_of(Component const& c) {
  if (c.interface())
    return {stated<MirrorParameters, &MirrorParameters::transmission>("transmission", dim::plain, 0, 1),
            stated<MirrorParameters, &MirrorParameters::loss>("loss", dim::plain, 0, 1),
            stated<MirrorParameters, &MirrorParameters::displacement>("displacement", dim::length, -1e-3, 1e-3),
            stated<MirrorParameters, &MirrorParameters::curvature>("curvature", dim::per_metre, -1e3, 1e3),
            {"curvature_y", dim::per_metre, -1e3, 1e3,
             [](Component const& m, double) {
               auto const& p = std::get<MirrorParameters>(m.stated);
               return p.curvature_across.value_or(p.curvature);
             },
             [](Component& m, double to, double) { std::get<MirrorParameters>(m.stated).curvature_across = to; }},
            tilt_about<0>("tilt_x"),
            tilt_about<1>("tilt_y"),
            {"tuning", dim::angle, -1e6, 1e6,
             [](Component const& m, double wavelength) {
               return std::get<MirrorParameters>(m.stated).displacement * 2 * pi / wavelength;
             },
             [](Component& m, double to, double wavelength) {
               std::get<MirrorParameters>(m.stated).displacement = to * wavelength / (2 * pi);
             }}};
  if (c.kind == Component::Kind::modulator)
    return {stated<ModulatorParameters, &ModulatorParameters::index>("index", dim::plain, -10, 10),
            stated<ModulatorParameters, &ModulatorParameters::hz>("frequency", dim::frequency, 1, 1e12)};
  if (c.kind == Component::Kind::laser)
    return {stated<LaserParameters, &LaserParameters::power>("power", dim::power, 0, 1e30)};
  return {};
}

Component made_again(Component const& c) {
  using Kind = Component::Kind;
  if (c.kind == Kind::mirror) return Network::mirror(c.name, std::get<MirrorParameters>(c.stated));
  if (c.kind == Kind::splitter) return Network::splitter(c.name, std::get<MirrorParameters>(c.stated));
  if (c.kind == Kind::modulator) return Network::modulator(c.name, std::get<ModulatorParameters>(c.stated));
  return Network::laser(c.name, std::get<LaserParameters>(c.stated));
}

NetworkParameter of_component(Network const& n, ComponentId id, Member const& m) {
  Component const& c = n.at(id);
  double high = m.high;
  if (c.interface() && (m.name == "transmission" || m.name == "loss")) {
    auto const& p = std::get<MirrorParameters>(c.stated);
    high = 1 - (m.name == "loss" ? p.transmission : p.loss);
  }
  double const before = c.modulation;
  return {fmt::format("{}.{}", c.name, m.name),
          m.dimension,
          m.get(c, n.wavelength()),
          m.low,
          high,
          [id, m, before](NetworkModel& model, double to) {
            Component changed = model.network.at(id);
            m.set(changed, to, model.network.wavelength());
            model.network.replace(id, made_again(changed));
            if (m.name != "frequency") return;
            for (NamedReadout& r : model.readouts)  // demodulated at the frequency of the modulator
              if (r.is_demodulated() && std::fabs(r.readout.hz - before) < 1e-3) r.readout.hz = to;
          }};
}

std::optional<NetworkParameter> of_space(Network const& n, std::string const& name) {
  for (std::size_t i = 0; i < n.spaces().size(); ++i)
    for (std::uint32_t const port : {n.spaces()[i].from, n.spaces()[i].to})
      for (bool const length : {true, false}) {
        if (n.port_name(port) + (length ? ".length" : ".phase") != name) continue;
        Network::Space const s = n.spaces()[i];
        return NetworkParameter{name,
                                length ? dim::length : dim::angle,
                                length ? s.length : s.phase,
                                length ? 0.0 : -1e6,
                                length ? 1e12 : 1e6,
                                [i, length](NetworkModel& m, double to) {
                                  Network::Space const old = m.network.spaces()[i];
                                  m.network.change(i, length ? to : old.length, length ? old.phase : to);
                                }};
      }
  return {};
}

}  // namespace

std::vector<std::string> parameter_names(NetworkModel const& model) {
  Network const& n = model.network;
  std::vector<std::string> names;
  for (Component const& c : n.components())
    for (Member const& m : members_of(c)) names.push_back(fmt::format("{}.{}", c.name, m.name));
  for (Network::Space const& s : n.spaces())
    for (std::uint32_t const port : {s.from, s.to})
      for (char const* what : {".length", ".phase"}) names.push_back(n.port_name(port) + what);
  for (NamedFreedom const& f : model.freedoms) names.push_back(f.name);
  return names;
}

std::optional<NetworkParameter> find_parameter(NetworkModel const& model, std::string const& name) {
  Network const& n = model.network;
  if (NamedFreedom const* f = model.freedom(name)) {
    std::vector<double> rest;
    for (auto const& [id, factor] : f->moves) rest.push_back(n.at(id).displacement);
    return NetworkParameter{name, dim::length, 0, -1e-3, 1e-3, [moves = f->moves, rest](NetworkModel& m, double to) {
                              for (std::size_t i = 0; i < moves.size(); ++i)
                                m.network.move(moves[i].first, rest[i] + moves[i].second * to);
                            }};
  }
  std::size_t const dot = name.rfind('.');
  if (dot == name.npos) return {};
  if (auto const id = n.search(name.substr(0, dot)))
    for (Member const& m : members_of(n.at(*id)))
      if (m.name == std::string_view(name).substr(dot + 1)) return of_component(n, *id, m);
  return of_space(n, name);
}

namespace {

// Value of the parameter nearest to `without` that still has modes, between there and where the network stands.
double last_with_modes(NetworkModel const& model, NetworkParameter const& p, double without) {
  double with = p.value;
  NetworkModel moved = model;
  for (int i = 0; i < 60; ++i) {
    double const middle = (with + without) / 2;
    p.set(moved, middle);
    try {
      ModeBases const bases(moved.network);
      with = middle;
    } catch (ModeError const&) {
      without = middle;
    }
  }
  return with;
}

std::string value_text(NetworkParameter const& p, double value) {
  if (p.dimension == dim::plain) return fmt::format("{:.6g}", value);
  if (p.dimension == dim::angle) return fmt::format("{:.6g} rad", value);
  return with_unit(fmt::format("{:.6g}", value), p.dimension);
}

InputError without_modes(NetworkModel const& model, std::vector<ScanAxis> const& axes,
                         std::vector<double> const& values, ModeError const& e) {
  std::string at;
  for (std::size_t i = 0; i < axes.size(); ++i)
    at += fmt::format("{}'{}' = {}", i == 0 ? "" : " and ", axes[i].parameter.name,
                      value_text(axes[i].parameter, values[i]));
  NetworkParameter const& p = axes.front().parameter;
  return InputError(
      fmt::format("the scan has no modes at {}: {}", at, e.reason),
      axes.size() > 1 ? "scan a smaller range"
                      : fmt::format("end the scan on this side at {}: from {}, where the network stands, to there it "
                                    "has modes",
                                    value_text(p, last_with_modes(model, p, values.front())), value_text(p, p.value)));
}

}  // namespace

NetworkScan scan_network(NetworkModel const& model, std::vector<ScanAxis> axes) {
  NetworkScan scan{std::move(axes), std::vector<std::vector<double>>(model.readouts.size())};
  std::size_t places = 1;
  for (ScanAxis const& axis : scan.axes) places *= axis.points;
  NetworkModel moved = model;
  for (std::size_t place = 0; place < places; ++place) {
    std::size_t rest = place;
    std::vector<double> at;
    for (ScanAxis const& axis : scan.axes) {
      at.push_back(axis.at(rest % axis.points));
      axis.parameter.set(moved, at.back());
      rest /= axis.points;
    }
    try {
      SteadyField const field(moved.network);
      for (std::size_t r = 0; r < moved.readouts.size(); ++r)
        scan.values[r].push_back(resolved_value(moved.readouts[r].readout, field));
    } catch (ModeError const& e) {
      throw without_modes(model, scan.axes, at, e);
    }
  }
  return scan;
}

namespace {

// Below this a slope is rounding: of the largest slope of a read-out, or of its power times the wave number and the
// largest gain of power in the network.
constexpr double blind = 1e-8;
constexpr double linear = 0.1;  // change of the slope at the ends of the linear range

// Slope of a read-out along a degree of freedom, W/m, in a network with its light.
double slope_along(AdjointSlope const& slope, NamedFreedom const& freedom) {
  double sum = 0;
  for (auto const& [id, factor] : freedom.moves) sum += factor * slope.to_displacement(id);
  return sum;
}
double slope_along(Network const& n, SteadyField const& f, Readout const& r, NamedFreedom const& freedom) {
  return slope_along(AdjointSlope(n, f, r), freedom);
}

// Distance, m, in direction `sign` to where the slope has changed by 10 %; not a number within half a wavelength.
double linear_reach(NetworkModel const& model, Readout const& r, NamedFreedom const& freedom, double slope, int sign) {
  auto const changed = [&](double x) {
    Network n = model.network;
    for (auto const& [id, factor] : freedom.moves) n.move(id, n.at(id).displacement + sign * factor * x);
    return std::fabs(slope_along(n, SteadyField(n), r, freedom) / slope - 1) > linear;
  };
  double inside = 0, outside = 1e-15;
  while (!changed(outside)) {
    inside = outside;
    outside *= 3;
    if (outside > model.network.wavelength() / 2) return not_a_number;
  }
  for (int i = 0; i < 12; ++i) {
    double const middle = (inside + outside) / 2;
    (changed(middle) ? outside : inside) = middle;
  }
  return (inside + outside) / 2;
}

ErrorSignal signal_of(NetworkModel const& model, SteadyField const& f, NamedReadout const& r,
                      NamedFreedom const& freedom) {
  ErrorSignal s{.readout = r.name, .freedom = freedom.name, .value = resolved_value(r.readout, f)};
  s.slope = slope_along(model.network, f, r.readout, freedom);
  if (!r.is_demodulated()) return s;
  double slopes[2];
  for (int q : {0, 1}) {
    Readout turned = r.readout;
    turned.angle = q * pi / 2;
    slopes[q] = slope_along(model.network, f, turned, freedom);
  }
  s.best_phase = std::atan2(slopes[1], slopes[0]);
  s.best_slope = std::hypot(slopes[0], slopes[1]);
  return s;
}

// Largest power at a port over that of the lasers, at least 1.
double largest_gain(Network const& n, SteadyField const& f) {
  double emitted = 0, most = 0;
  for (Network::Component const& c : n.components()) emitted += std::norm(c.emits);
  for (std::uint32_t p = 0; p < n.ports(); ++p) most = std::fmax(most, f.power_out(p));
  return std::fmax(1, most / emitted);
}

}  // namespace

std::vector<ErrorSignal> error_signals(NetworkModel const& model) {
  SteadyField const f(model.network);
  double const gain = largest_gain(model.network, f);
  std::vector<ErrorSignal> all;
  for (NamedReadout const& r : model.readouts) {
    if (!r.is_power() && !r.is_demodulated()) continue;
    std::vector<ErrorSignal> of_readout;
    double least = blind * power_of_beam(r.readout, f) * model.network.wavenumber() * gain;
    for (NamedFreedom const& freedom : model.freedoms) {
      of_readout.push_back(signal_of(model, f, r, freedom));
      least = std::fmax(least, blind * std::fabs(of_readout.back().slope));
    }
    for (std::size_t i = 0; i < of_readout.size(); ++i) {
      ErrorSignal& s = of_readout[i];
      NamedFreedom const& freedom = model.freedoms[i];
      if (!(std::fabs(s.slope) > least)) continue;
      s.linear_range =
          linear_reach(model, r.readout, freedom, s.slope, 1) + linear_reach(model, r.readout, freedom, s.slope, -1);
      all.push_back(std::move(s));
    }
  }
  return all;
}

namespace {

// The number of a space that a parameter is, by the name of the port it leaves; spaces.size(): none.
std::size_t space_of(Network const& n, std::string const& port) {
  std::size_t i = 0;
  while (i < n.spaces().size() && n.port_name(n.spaces()[i].from) != port) ++i;
  return i;
}

std::optional<double> adjoint_slope(NetworkModel const& model, AdjointSlope const& slope, std::string const& name) {
  Network const& n = model.network;
  if (NamedFreedom const* freedom = model.freedom(name)) return slope_along(slope, *freedom);
  std::size_t const dot = name.rfind('.');
  std::string const owner = name.substr(0, dot), what = name.substr(dot + 1);
  if (auto const id = n.search(owner)) {
    if (what == "transmission") return slope.to_transmission(*id);
    if (what == "loss") return slope.to_loss(*id);
    if (what == "displacement") return slope.to_displacement(*id);
    if (what == "tuning") return slope.to_displacement(*id) / n.wavenumber();
    if (what == "power") return slope.to_power(*id);
  }
  std::size_t const space = space_of(n, owner);
  if (space == n.spaces().size()) return {};
  if (what == "length") return slope.to_length(space);
  return what == "phase" ? std::optional(slope.to_phase(space)) : std::nullopt;
}

// Steps of central differences, far below what changes the light and far above its rounding. Zero: no such number.
double step_of(NetworkModel const& model, std::string const& name) {
  if (name.ends_with(".index")) return 1e-5;
  if (!model.network.modes()) return 0;
  if (name.ends_with(".curvature") || name.ends_with(".curvature_y")) return 1e-8;  // 1/m
  return name.ends_with(".tilt_x") || name.ends_with(".tilt_y") ? 1e-10 : 0;        // rad
}

double central_difference(NetworkModel const& model, Readout const& r, NetworkParameter const& p, double step) {
  double value[2];
  for (int side : {0, 1}) {
    NetworkModel moved = model;
    p.set(moved, p.value + (side == 0 ? -step : step));
    value[side] = value_of(r, SteadyField(moved.network));
  }
  return (value[1] - value[0]) / (2 * step);
}

// Below this a slope is rounding; `power`: at the read-out, times the largest gain of power in the network.
double least_slope(NetworkModel const& model, NetworkParameter const& p, double step, double power) {
  constexpr double rounding = 1e-12;  // of a solution
  if (step > 0) return rounding * power / step;
  if (p.dimension == dim::length) return blind * power * model.network.wavenumber();
  if (p.dimension == dim::power) return p.value > 0 ? blind * power / p.value : 0;
  return blind * power;
}

}  // namespace

std::vector<ParameterSlope> parameter_slopes(NetworkModel const& model, Readout const& r) {
  SteadyField const f(model.network);
  AdjointSlope const slope(model.network, f, r);
  double const power = power_of_beam(r, f) * largest_gain(model.network, f);
  std::vector<ParameterSlope> all;
  for (std::string const& name : parameter_names(model)) {
    NetworkParameter const p = *find_parameter(model, name);
    double const step = step_of(model, name);
    std::optional<double> const found =
        step > 0 ? central_difference(model, r, p, step) : adjoint_slope(model, slope, name);
    if (!found) continue;
    all.push_back({p, std::fabs(*found) > least_slope(model, p, step, power) ? *found : not_a_number});
  }
  return all;
}

char const* NetworkCause::unit() const {
  constexpr char const* units[] = {"m", "N", "1", "rad", "Hz"};
  return units[std::size_t(kind)];
}

Dimension NetworkCause::density() const {
  constexpr Dimension all[] = {dim::displacement_asd, {2, 2, -3}, {.second = 1}, dim::angle_asd, {.second = -1}};
  return all[std::size_t(kind)];
}

std::string NetworkCause::density_unit() const {
  return kind == Kind::amplitude ? "1/sqrt(Hz)" : fmt::format("{}/sqrt(Hz)", unit());
}

std::vector<std::string> cause_names(NetworkModel const& model) {
  std::vector<std::string> names;
  for (NamedFreedom const& f : model.freedoms) names.push_back(f.name);
  for (Network::Component const& c : model.network.components()) {
    if (c.interface()) names.insert(names.end(), {c.name, c.name + ".force"});
    if (c.kind == Network::Component::Kind::laser)
      names.insert(names.end(), {c.name + ".amplitude", c.name + ".phase", c.name + ".frequency"});
  }
  return names;
}

std::optional<NetworkCause> find_cause(NetworkModel const& model, std::string const& name) {
  using Kind = NetworkCause::Kind;
  if (NamedFreedom const* f = model.freedom(name)) return NetworkCause{name, Kind::displacement, f->moves};
  std::vector<std::string> const all = cause_names(model);
  if (std::ranges::find(all, name) == all.end()) return {};
  std::size_t const dot = std::min(name.find('.'), name.size());
  std::string const what = name.substr(dot);
  Kind const kind = what.empty()           ? Kind::displacement
                    : what == ".force"     ? Kind::force
                    : what == ".amplitude" ? Kind::amplitude
                    : what == ".phase"     ? Kind::phase
                                           : Kind::frequency;
  return NetworkCause{name, kind, {{model.network.find(name.substr(0, dot)), 1.0}}};
}

std::vector<std::string> effect_names(NetworkModel const& model) {
  std::vector<std::string> names;
  for (NamedReadout const& r : model.readouts) names.push_back(r.name);
  for (Network::Component const& c : model.network.components())
    if (c.interface()) names.push_back(c.name);
  if (model.strain) names.emplace_back("h");
  return names;
}

std::optional<NamedReadout> find_effect(NetworkModel const& model, std::string const& name) {
  if (NamedReadout const* r = model.readout(name)) return *r;
  auto const id = model.network.search(name);
  if (!id || !model.network.at(*id).interface()) return {};
  return NamedReadout{name, Readout::motion({{*id, 1.0}})};
}

char const* unit_of(Readout const& r) {
  return r.kind == Readout::Kind::motion ? "m" : r.kind == Readout::Kind::homodyne ? "sqrt(W)" : "W";
}

Phasor response_to(LinearResponse const& r, Network const& n, NetworkCause const& cause, double hz) {
  using Kind = NetworkCause::Kind;
  Phasor sum = 0;
  for (auto const& [id, factor] : cause.moves) {
    Injection const of_laser{n.at(id).first_port, true, true, 0};
    switch (cause.kind) {
      case Kind::displacement:
        sum += factor * r.to_displacement(id);
        break;
      case Kind::force:
        sum += factor * r.to_displacement(id) * n.at(id).suspension.compliance(hz);
        break;
      case Kind::amplitude:
        sum += r.to_amplitude(of_laser);
        break;
      // Light exp(-i(wt + phi)), with phi = 2 pi times the integral of the frequency: s = -i phi.
      case Kind::phase:
        sum -= r.to_phase(of_laser);
        break;
      case Kind::frequency:
        sum += r.to_phase(of_laser) / Phasor(0, hz);
        break;
    }
  }
  return sum;
}

std::vector<Phasor> transfer_function(NetworkModel const& model, NetworkCause const& cause,
                                      std::optional<NamedReadout> const& effect, std::vector<double> const& hz) {
  SteadyField const field(model.network);
  std::vector<Phasor> all;
  for (double const f : hz) {
    auto const to = [&](LinearResponse const& r) { return response_to(r, model.network, cause, f); };
    if (effect) {
      all.push_back(std::conj(to(LinearResponse(model.network, field, effect->readout, f))));
    } else {
      CalibratedStrain const strain(model, field, f);
      all.push_back(std::conj(strain.to(to) / strain.calibration()));
    }
  }
  return all;
}

std::vector<StrayRow> stray_transfer(NetworkModel const& model, NamedWay const& w,
                                     std::optional<NamedReadout> const& effect, std::vector<double> const& hz) {
  SteadyField const field(model.network);
  double most = 0;
  for (std::uint32_t p = 0; p < model.network.ports(); ++p) most = std::fmax(most, field.power_out(p));
  StrayRow row{.entrance = w.name,
               .lit = beam_name(model.network, w.way.lit.beam),
               .fed = beam_name(model.network, w.way.fed.beam),
               .readout = effect ? effect->name : "h",
               .unit = effect ? unit_of(effect->readout) : ""};
  row.power = lighting_power(w.way, field);
  double const lit = row.power > 1e-24 * most ? w.share : not_a_number;
  std::vector<StrayRow> rows;
  for (double const f : hz) {
    row.hz = f;
    if (effect) {
      LinearResponse const r(model.network, field, effect->readout, f);
      row.response = stray_response(r, model.network, field, w.way, f) * lit;
    } else {
      CalibratedStrain const strain(model, field, f);
      row.response = strain.to_stray(w.way) * (lit / strain.calibration());
    }
    rows.push_back(row);
  }
  return rows;
}

namespace {

// Without the elements that are rounding.
void resolve(SensingMatrix& m, NetworkModel const& model, SteadyField const& f) {
  if (m.response.size() == 0) return;
  double const gain = largest_gain(model.network, f);
  for (Eigen::Index i = 0; i < m.response.rows(); ++i) {
    NamedReadout const& r = model.readouts[std::size_t(i)];
    bool const power = r.is_power() || r.is_demodulated();
    double const scale = power ? power_of_beam(r.readout, f) * model.network.wavenumber() * gain : 0,
                 least = blind * std::fmax(scale, m.response.row(i).cwiseAbs().maxCoeff());
    for (Eigen::Index j = 0; j < m.response.cols(); ++j)
      if (!(std::abs(m.response(i, j)) > least)) m.response(i, j) = not_a_number;
  }
}

// Of the rows that have elements above rounding.
double condition_of(Eigen::MatrixXcd const& response) {
  Eigen::MatrixXcd scaled(response.rows(), response.cols());
  Eigen::Index rows = 0;
  for (Eigen::Index i = 0; i < response.rows(); ++i) {
    Eigen::RowVectorXcd const row =
        response.row(i).unaryExpr([](Phasor z) { return std::isnan(std::abs(z)) ? Phasor(0) : z; });
    double const most = row.size() > 0 ? row.cwiseAbs().maxCoeff() : 0;
    if (most > 0) scaled.row(rows++) = row / most;
  }
  if (rows == 0) return infinity;
  Eigen::VectorXd const s = Eigen::JacobiSVD<Eigen::MatrixXcd>(scaled.topRows(rows)).singularValues();
  return s.minCoeff() > 0 ? s.maxCoeff() / s.minCoeff() : infinity;
}

}  // namespace

SensingMatrix sensing_matrix(NetworkModel const& model, double hz) {
  SteadyField const field(model.network);
  SensingMatrix m{.hz = hz};
  m.response.resize(Eigen::Index(model.readouts.size()), Eigen::Index(model.freedoms.size()));
  for (NamedFreedom const& f : model.freedoms) m.freedoms.push_back(f.name);
  SmallSignals const signals(model.network, field, hz);
  for (std::size_t i = 0; i < model.readouts.size(); ++i) {
    m.readouts.push_back(model.readouts[i].name);
    LinearResponse const r(signals, model.readouts[i].readout);
    for (std::size_t j = 0; j < model.freedoms.size(); ++j)
      m.response(Eigen::Index(i), Eigen::Index(j)) =
          std::conj(response_to(r, model.network, {"", NetworkCause::Kind::displacement, model.freedoms[j].moves}, hz));
  }
  resolve(m, model, field);
  m.condition = condition_of(m.response);
  return m;
}

}  // namespace straytrace::ifo
