// SPDX-License-Identifier: BSD-3-Clause
#include "session/records/time_inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "beams/overlap.hpp"
#include "motion/axis_motion.hpp"
#include "motion/series_motion.hpp"
#include "noise/classes/delayed_paths.hpp"
#include "noise/time_domain/time_domain.hpp"
#include "session/session.hpp"
#include "spectra/files/series_file.hpp"

namespace straytrace::session {
namespace {

constexpr double usual_duration = 64;  // s, of drawn motion

std::string comma_list(std::vector<std::string> const& words) { return fmt::format("{}", fmt::join(words, ", ")); }

// Position of a word in a list; the error names the option and a similar word.
template <class Words>
std::size_t place_of(std::string const& word, Words const& words, std::string const& option, std::string const& what) {
  auto const found = std::find(std::begin(words), std::end(words), word);
  if (found != std::end(words)) return std::size_t(found - std::begin(words));
  std::vector<std::string> const known(std::begin(words), std::end(words));
  throw InputError(fmt::format("{}: '{}' is not {}", option, word, what),
                   did_you_mean(word, known, "choose one of: " + comma_list(known)));
}

MotionFile file_of(MotionInput const& input, bool rotation) {
  Spectrum const& s = input.spectrum;
  Band const known{s.lowest(), s.highest()};
  return {"", input.name, known, known, rotation ? 0 : std::sqrt(s.at(known.low))};
}

// One entry for each channel.
void replace_motions(TimeRequest const& o, TimeInputs& in) {
  if (o.body.size() != o.channel.size() || (o.axis.size() != o.channel.size() && o.axis.size() != 1 && !o.body.empty()))
    throw InputError(
        fmt::format("{} times --channel, {} times --body, {} times --axis", o.channel.size(), o.body.size(),
                    o.axis.size()),
        "write --body BODY --axis z --channel FILE::CHANNEL for each coordinate; a single --axis applies to all");
  for (std::size_t i = 0; i < o.channel.size(); ++i) {
    auto const body = place_of(o.body[i], in.model.motion.bodies, "--body", "a body of this run");
    auto const axis = int(place_of(o.axis.size() == 1 ? o.axis[0] : o.axis[i], axis_names, "--axis", "a coordinate"));
    replace_coordinate(
        in.model.motion, BodyId{std::uint32_t(body)}, axis,
        channel_motion(series_argument(o.channel[i], o.unit, o.span), is_rotation(axis), o.corner.value_or(0)));
    MotionFile& file = in.model.motion.files.emplace_back(file_of(in.model.motion.inputs.back(), is_rotation(axis)));
    file.name = o.channel[i];
  }
}

std::string warnings_of_channels(TimeRequest const& o, TimeInputs const& in) {
  auto const& all = in.model.motion.files;
  Band const band{in.model.noise.grid.edges.front(), in.model.noise.grid.edges.back()};
  std::string text;
  for (Problem const& p : warnings_of_gaps(std::span(all).last(o.channel.size()), band, in.model.traced.wavelength))
    text += fmt::format(
        "warning: {}\n  give a channel that covers it: a higher rate, a longer stretch or a lower --corner\n", p.what);
  return text;
}

// The stretch that all recordings cover, or the requested one.
void choose_times(TimeRequest const& o, TimeInputs& in) {
  double from = -infinity, to = infinity;
  for (MotionInput const& input : in.model.motion.inputs)
    if (input.recorded && !input.gains.empty()) {
      from = std::max(from, input.recorded->start);
      to = std::min(to, input.recorded->end());
    }
  if (from >= to) throw InputError("the recordings have no time in common", "choose channels of the same stretch");
  bool const recorded = std::isfinite(from);
  double const all = recorded ? to - from : usual_duration;
  in.start = std::max(o.span.from > -1e299 ? o.span.from : recorded ? from : 0, from);
  double const end = !o.corner ? o.span.to : std::min(o.span.to, to);  // integration removes the ends
  double const asked = end < 1e299 ? end - in.start : recorded ? to - in.start : all;
  in.duration = o.duration.value_or(asked);
  if (!(in.duration > 0 && in.duration <= 1e6))
    throw InputError(fmt::format("a duration of {:g} s", in.duration), "choose a positive value up to 1e6 s");
}

// Names for matching: ASCII, without spaces.
std::string plain(std::string text) {
  for (std::size_t at; (at = text.find("·")) != text.npos;) text.replace(at, std::string("·").size(), ".");
  std::erase(text, ' ');
  return text;
}

bool is_rank(std::string const& word) { return word.find_first_not_of("0123456789") == word.npos; }

bool is_part_of(std::string const& word, std::string const& route) {
  return plain(route).find(plain(word)) != std::string::npos;
}

void check_route(std::string const& word, CouplingTable const& table) {
  auto const& all = table.classes;
  std::uint64_t const rank = is_rank(word) ? std::strtoull(word.c_str(), nullptr, 10) : 0;
  bool const found = is_rank(word) ? rank >= 1 && rank <= all.size()
                                   : std::any_of(all.begin(), all.end(), [&](CouplingClass const& c) {
                                       return is_part_of(word, route_name(table, c));
                                     });
  if (!found)
    throw InputError(fmt::format("--route: '{}' is {}", word,
                                 is_rank(word) ? fmt::format("no rank; this run has {}", counted(all.size(), "route"))
                                               : "part of no route name"),
                     "see straytrace paths RUN for ranks and names");
}

// Refuses all wrong names at once, before anything is computed.
void check_names(TimeRequest const& o, TimeInputs const& in) {
  std::vector<InputError> errors;
  auto const each = [&](std::vector<std::string> const& words, auto const& check) {
    for (std::string const& word : words) try {
        check(word);
      } catch (InputError const& e) {
        errors.push_back(e);
      }
  };
  CouplingTable const& table = in.coupling();
  each(o.body, [&](auto const& body) { place_of(body, in.model.motion.bodies, "--body", "a body of this run"); });
  each(o.axis, [](auto const& axis) { place_of(axis, axis_names, "--axis", "a coordinate"); });
  each(o.routes, [&](auto const& route) { check_route(route, table); });
  each(o.ports, [&](auto const& port) { place_of(port, table.ports, "--port", "a port of this run"); });
  each(o.moved_by, [&](auto const& body) { place_of(body, table.bodies, "--moved-by", "a body of this run"); });
  throw_all(errors);
}

bool touches(CouplingClass const& c, BodyId body) {
  return std::any_of(c.records.begin(), c.records.end(), [&](PathRecord const& r) {
    return std::any_of(r.phase_sensitivities.begin(), r.phase_sensitivities.end(),
                       [&](PhaseSensitivity const& l) { return l.body == body; });
  });
}

// Whether a route is selected, by rank in the path table or by part of its name.
class RouteChoice {
 public:
  RouteChoice(TimeRequest const& o, TimeInputs const& in) : asked_(o.routes) {
    if (asked_.empty()) return;
    for (PathRow const& row : table_for(in.coupling(), &in.exact, in.model).rows)
      ranks_.emplace_back(row.rank, row.hash);
  }
  bool operator()(CouplingTable const& table, CouplingClass const& c) const {
    return asked_.empty() || std::any_of(asked_.begin(), asked_.end(), [&](std::string const& word) {
             return is_rank(word) ? std::any_of(ranks_.begin(), ranks_.end(),
                                                [&](auto const& r) {
                                                  return fmt::format("{}", r.first) == word && r.second == c.hash;
                                                })
                                  : is_part_of(word, route_name(table, c));
           });
  }
  bool empty() const { return asked_.empty(); }

 private:
  std::vector<std::string> asked_;
  std::vector<std::pair<std::size_t, std::uint64_t>> ranks_;
};

// h(t) of resolved routes is a lower bound where others have light.
void warn_of_unresolved(std::size_t routes, TimeInputs& in) {
  if (routes == 0) return;
  std::string const what = fmt::format("{} {} unresolved and left out of h(t), so its level is a lower bound",
                                       counted(routes, "route"), routes == 1 ? "is" : "are");
  std::string const remedy = "trace more histories, or name the routes with --route";
  in.model.warnings += fmt::format("warning: {}\n  {}\n", what, remedy);
  in.model.warnings_json += problems_as_json(InputError({{{}, what, remedy, Severity::warning}}, ""));
}

void choose_routes(TimeRequest const& o, TimeInputs& in) {
  CouplingTable const& table = in.coupling();
  std::vector<std::size_t> ports, bodies;
  for (std::string const& p : o.ports) ports.push_back(place_of(p, table.ports, "--port", "a port of this run"));
  for (std::string const& b : o.moved_by)
    bodies.push_back(place_of(b, table.bodies, "--moved-by", "a body of this run"));
  RouteChoice const asked(o, in);
  std::size_t unresolved = 0;
  for (std::uint32_t r = 0; r < table.classes.size(); ++r) {
    CouplingClass const& c = table.classes[r];
    bool const at_port = ports.empty() || std::count(ports.begin(), ports.end(), c.port.value) > 0;
    bool const moved = bodies.empty() || std::any_of(bodies.begin(), bodies.end(), [&](std::size_t b) {
                         return touches(c, BodyId{std::uint32_t(b)});
                       });
    bool const usable = in.exact.routes[r].resolved || !asked.empty();
    if (!at_port || !moved || !asked(table, c) || c.records.empty()) continue;
    if (usable)
      in.routes.push_back(r);
    else if (!in.exact.routes[r].faint)  // faint: they cannot move the total
      ++unresolved;
  }
  warn_of_unresolved(unresolved, in);
  if (in.routes.empty())
    throw InputError("none of the selected routes has stored paths", "see straytrace paths RUN for ranks and names");
}

}  // namespace

TimeInputs::TimeInputs(TimeRequest const& o) : OpenRun(o.run, o.motion) {
  if (!model.detector)
    throw InputError("this run has no interferometer, so there is no strain", "add 'ports' to the scene");
  check_names(o, *this);
  replace_motions(o, *this);
  model.warnings += warnings_of_channels(o, *this);
  choose_times(o, *this);
  add_phase_modulation(file.trace.coupling, model.motion);
  exact = model.project(coupling());
  choose_routes(o, *this);
}

MotionSeries fringe_motion(TimeInputs& in, bool channels, double rate, std::uint64_t seed) {
  MotionSet& motion = in.model.motion;
  if (channels) std::erase_if(motion.inputs, [](MotionInput const& i) { return !i.recorded; });
  double const least = highest_motion(motion);
  if (rate == 0 && least > 0) rate = SamplingRule{0, least}.automatic();
  if (rate == 0)
    for (MotionInput const& i : motion.inputs)
      if (i.recorded) rate = std::max(rate, i.recorded->rate);
  double const samples = std::round(in.duration * rate);
  if (samples > 1 << 28)
    throw InputError("more than 2^28 samples", "choose a shorter --duration or, with --channel, a lower --rate");
  return draw_motion(motion, {in.start, rate, std::size_t(samples)}, seed);
}

namespace {

constexpr double least_share = 1e-3;  // of the main light on the sensor

// Position of the name that a key gives.
std::optional<std::uint32_t> place_of(Node const& sensor, char const* key, std::vector<std::string> const& names) {
  std::string const name = sensor.word(key);
  if (name.empty()) return {};
  auto const at = std::ranges::find(names, name);
  if (at != names.end()) return std::uint32_t(at - names.begin());
  sensor[key].problem(fmt::format("there is no {} '{}'", key, name),
                      names.empty()
                          ? fmt::format("the scene has no {}s", key)
                          : did_you_mean(name, names, fmt::format("it is one of: {}", fmt::join(names, ", "))));
  return {};
}

// eta of eq. N.22 for a round sensor: 1 - exp(-2 a^2/w^2) at the middle of the beam.
double read_caught(Node const& sensor) {
  if (!sensor.has("radius") && !sensor.has("spot") && !sensor.has("offset")) return 1;
  double const radius = sensor.number("radius", dim::length, required, 1e-6, 1e3),
               spot = sensor.number("spot", dim::length, required, 1e-7, 1e3),
               offset = sensor.number("offset", dim::length, 0, 0, 1e3);
  if (!std::isfinite(radius + spot + offset)) return 1;
  double const caught = 1 - clipped_share(radius, spot, offset);
  if (!(caught >= least_share)) {
    sensor.problem(fmt::format("{:.2g} of the main light falls on this sensor", caught),
                   "move it into the beam, or make it larger");
    return 1;
  }
  return caught;
}

}  // namespace

std::vector<Sensor> read_sensors(Scene const& scene, std::vector<std::string> const& ports,
                                 std::vector<std::string> const& receivers) {
  std::vector<Sensor> all;
  for (auto const& [name, node] : scene.table("sensors").items()) {
    if (!node) continue;  // reported
    if (name.empty()) {
      node.problem("a sensor has no name", "write a name before its table");
      continue;
    }
    if (node.kind() != Node::Kind::table) {
      node.problem(fmt::format("sensor '{}' is a table", name), "write {port: PORT, radius: 5 mm, spot: 1 mm}");
      continue;
    }
    std::optional<std::uint32_t> const port = place_of(node, "port", ports);
    Sensor sensor{name, PortId{port.value_or(0)}, read_caught(node), {}};
    if (node.has("receiver")) sensor.receiver = place_of(node, "receiver", receivers);
    node.refuse_unknown(fmt::format("sensor '{}'", name));
    if (bool const other = port && ports[*port] != name; other && std::ranges::find(ports, name) != ports.end())
      node.problem(fmt::format("'{}' is the sensor of the port of this name", name), "choose another name");
    auto const taken = std::ranges::find_if(all, [&](Sensor const& s) { return port && s.port.value == *port; });
    if (taken != all.end())
      node["port"].problem(fmt::format("'{}' is already the sensor of port '{}'", taken->name, ports[*port]),
                           "give each sensor a port of its own");
    else if (port)
      all.push_back(std::move(sensor));
  }
  return all;
}

std::vector<Sensor> sensors_of_ports(Scene const& scene, CouplingTable const& table, std::vector<double> const& power,
                                     double main_power) {
  std::vector<Sensor> const stated = read_sensors(scene, table.ports, table.receivers);
  scene.throw_if_problems();
  std::vector<Sensor> all;
  for (std::uint32_t p = 0; p < table.ports.size(); ++p) {
    auto const own = std::ranges::find_if(stated, [&](Sensor const& s) { return s.port.value == p; });
    all.push_back(own != stated.end() ? *own : Sensor{table.ports[p], PortId{p}});
    if (power.at(p) > 0 && main_power > 0) all.back().share = power[p] / main_power;
  }
  return all;
}

}  // namespace straytrace::session
