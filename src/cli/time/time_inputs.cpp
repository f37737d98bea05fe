// SPDX-License-Identifier: BSD-3-Clause
#include "cli/time/time_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text/words.hpp"
#include "cli/data_options.hpp"
#include "cli/options.hpp"
#include "motion/axis_motion.hpp"
#include "session/session.hpp"
#include "spectra/integration.hpp"

namespace straytrace::cli {
namespace {

constexpr double usual_duration = 64;  // s, of drawn motion

std::string comma_list(std::vector<std::string> const& words) { return fmt::format("{}", fmt::join(words, ", ")); }

// Position of a word in a list; the error names the option and a similar word.
template <class Words>
std::size_t place_of(std::string const& word, Words const& words, std::string const& option, std::string const& what) {
  auto const found = std::find(std::begin(words), std::end(words), word);
  if (found != std::end(words)) return std::size_t(found - std::begin(words));
  std::vector<std::string> const known(std::begin(words), std::end(words));
  std::string const near = nearest_word(word, known);
  throw InputError(fmt::format("{}: '{}' is not {}", option, word, what),
                   near.empty() ? "choose one of: " + comma_list(known) : "did you mean '" + near + "'?");
}

MotionFile file_of(MotionInput const& input, bool rotation) {
  Spectrum const& s = input.spectrum;
  Band const known{s.lowest(), s.highest()};
  return {"", input.name, known, known, rotation ? 0 : std::sqrt(s.at(known.low))};
}

// One entry for each channel.
void replace_motions(TimeOptions const& o, TimeInputs& in) {
  if (o.body.size() != o.channel.size() || (o.axis.size() != o.channel.size() && o.axis.size() != 1 && !o.body.empty()))
    throw InputError(
        fmt::format("{} times --channel, {} times --body, {} times --axis", o.channel.size(), o.body.size(),
                    o.axis.size()),
        "write --body BODY --axis z --channel FILE::CHANNEL for each coordinate; a single --axis applies to all");
  for (std::size_t i = 0; i < o.channel.size(); ++i) {
    auto const body = place_of(o.body[i], in.model.motion.bodies, "--body", "a body of this run");
    auto const axis = int(place_of(o.axis.size() == 1 ? o.axis[0] : o.axis[i], axis_names, "--axis", "a coordinate"));
    GpsSpan const span = o.gps.empty() ? GpsSpan{} : parse_gps(o.gps);
    double const corner = o.corner.empty() ? 0 : option_quantity(o.corner, dim::frequency, "--corner", "0.05 Hz");
    replace_coordinate(in.model.motion, BodyId{std::uint32_t(body)}, axis,
                       as_motion(series_argument(o.channel[i], o.unit, span), is_rotation(axis), corner));
    MotionFile& file = in.model.motion.files.emplace_back(file_of(in.model.motion.inputs.back(), is_rotation(axis)));
    file.name = o.channel[i];
  }
}

std::string warnings_of_channels(TimeOptions const& o, TimeInputs const& in) {
  auto const& all = in.model.motion.files;
  Band const band{in.model.noise.grid.edges.front(), in.model.noise.grid.edges.back()};
  std::string text;
  for (Problem const& p : warnings_of_gaps(std::span(all).last(o.channel.size()), band, in.model.traced.wavelength))
    text += fmt::format(
        "warning: {}\n  give a channel that covers it: a higher rate, a longer stretch or a lower --corner\n", p.what);
  return text;
}

// The stretch that all recordings cover, or the requested one.
void choose_times(TimeOptions const& o, TimeInputs& in) {
  double from = -infinity, to = infinity;
  for (MotionInput const& input : in.model.motion.inputs)
    if (input.recorded && !input.gains.empty()) {
      from = std::max(from, input.recorded->start);
      to = std::min(to, input.recorded->end());
    }
  if (from >= to) throw InputError("the recordings have no time in common", "choose channels of the same stretch");
  bool const recorded = std::isfinite(from);
  double const all = recorded ? to - from : usual_duration;
  GpsSpan const span = o.gps.empty() ? GpsSpan{} : parse_gps(o.gps);
  in.start = std::max(span.from > -1e299 ? span.from : recorded ? from : 0, from);
  double const end = o.corner.empty() ? span.to : std::min(span.to, to);  // integration removes the ends
  double const asked = end < 1e299 ? end - in.start : recorded ? to - in.start : all;
  in.duration = o.duration.empty() ? asked : option_quantity(o.duration, dim::time, "--duration", "64 s");
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
void check_names(TimeOptions const& o, TimeInputs const& in) {
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
  RouteChoice(TimeOptions const& o, TimeInputs const& in) : asked_(o.routes) {
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

void choose_routes(TimeOptions const& o, TimeInputs& in) {
  CouplingTable const& table = in.coupling();
  std::vector<std::size_t> ports, bodies;
  for (std::string const& p : o.ports) ports.push_back(place_of(p, table.ports, "--port", "a port of this run"));
  for (std::string const& b : o.moved_by)
    bodies.push_back(place_of(b, table.bodies, "--moved-by", "a body of this run"));
  RouteChoice const asked(o, in);
  for (std::uint32_t r = 0; r < table.classes.size(); ++r) {
    CouplingClass const& c = table.classes[r];
    bool const at_port = ports.empty() || std::count(ports.begin(), ports.end(), c.port.value) > 0;
    bool const moved = bodies.empty() || std::any_of(bodies.begin(), bodies.end(), [&](std::size_t b) {
                         return touches(c, BodyId{std::uint32_t(b)});
                       });
    bool const usable = in.exact.routes[r].resolved || !asked.empty();
    if (at_port && moved && usable && asked(table, c) && !c.records.empty()) in.routes.push_back(r);
  }
  if (in.routes.empty())
    throw InputError("none of the selected routes has stored paths", "see straytrace paths RUN for ranks and names");
}

}  // namespace

void add_motion_options(CLI::App& command, TimeOptions& o) {
  command.add_option("--motion", o.motion, "YAML file with 'straytrace: 1' and 'bodies' to use instead of the run's");
  command.add_option("--body", o.body, "body whose motion the next --channel replaces; may be repeated")
      ->allow_extra_args(false);
  command.add_option("--axis", o.axis, "coordinate of that body: x, y, z, rx, ry or rz; may be repeated")
      ->allow_extra_args(false);
  command
      .add_option("--channel", o.channel, "FILE or FILE::CHANNEL with the motion of that coordinate; may be repeated")
      ->allow_extra_args(false);
  command.add_option("--unit", o.unit, "unit of the channels, where the files have none: um, m/s^2");
  command.add_option("--corner", o.corner, "high pass of integrated velocities and accelerations, for example 0.05Hz");
  command.add_option("--seed", o.seed, "seed of drawn motion and of static phases")->check(whole_between(0, 9e15, "7"));
}

void add_stretch_options(CLI::App& command, TimeOptions& o) {
  command.add_option("--gps", o.gps, "stretch A..B in GPS seconds or UTC; default: all recorded data");
  command.add_option("--duration", o.duration, "duration of the record; default: all recorded data, or 64 s");
  command.add_option("--rate", o.rate, "samples per second; default: chosen from the largest fringe frequency")
      ->check(CLI::Range(1.0, 1048576.0));
}

void add_route_options(CLI::App& command, TimeOptions& o) {
  command
      .add_option("--route", o.routes,
                  "only this route: rank in the path table or part of the name ('tube.S'); may be repeated")
      ->allow_extra_args(false);
  command.add_option("--port", o.ports, "only routes of this port; may be repeated")->allow_extra_args(false);
  command.add_option("--moved-by", o.moved_by, "only routes moved by this body; may be repeated")
      ->allow_extra_args(false);
}

RecordedMotion as_motion(TimeSeries const& series, bool rotation, double corner) {
  std::optional<Quantity> const unit = parse_unit(series.unit);
  Calibration c;
  Dimension d = unit ? unit->dimension : dim::plain;
  for (c.derivatives = 0; c.derivatives < 2 && d != (rotation ? dim::angle : dim::length); ++c.derivatives)
    d.second = std::int8_t(d.second + 2);
  if (!unit || d != (rotation ? dim::angle : dim::length))
    throw InputError(fmt::format("--channel: '{}' is in '{}', which is not a unit of {}", series.name, series.unit,
                                 rotation ? "angle" : "displacement, velocity or acceleration"),
                     fmt::format("write its unit: --unit {}", rotation ? "urad" : "um/s^2"));
  if (c.derivatives > 0 && corner <= 0)
    throw InputError(fmt::format("--channel: '{}' is in {} and must be integrated, which amplifies slow errors",
                                 series.name, series.unit),
                     "write --corner 0.05Hz; slower motion is removed");
  if (series.samples.size() < 32)
    throw InputError(fmt::format("--channel: '{}' has fewer than 32 samples", series.name), "choose a longer stretch");
  c.factor = unit->si;
  TimeSeries displacement = as_displacement(series, c, corner);
  if (c.derivatives > 0) displacement = settled(displacement, corner);
  displacement.unit = rotation ? "rad" : "m";
  double const segment =
      std::max(std::min(series.duration() / 8, 128.0), std::min(series.duration(), 8 / std::max(corner, 1e-9)));
  return {std::make_shared<TimeSeries const>(std::move(displacement)),
          displacement_spectrum(series, c, corner, corner > 0 ? segment : std::min(series.duration() / 8, 128.0))};
}

void replace_coordinate(MotionSet& motion, BodyId body, int axis, RecordedMotion const& record) {
  for (MotionInput& input : motion.inputs)
    std::erase_if(input.gains, [&](Gain const& g) { return g.body == body && g.axis == axis; });
  MotionInput input;
  input.name = fmt::format("{} {}", motion.bodies[body.value], axis_names[axis]);
  input.recorded = record.displacement;
  input.spectrum = record.spectrum;
  input.gains = {{body, axis, 1, {}}};
  motion.inputs.push_back(std::move(input));
}

TimeInputs::TimeInputs(TimeOptions const& o) : OpenRun(o.run, o.motion) {
  if (!model.detector)
    throw InputError("this run has no interferometer, so there is no strain", "add 'ports' to the scene");
  check_names(o, *this);
  replace_motions(o, *this);
  model.warnings += warnings_of_channels(o, *this);
  choose_times(o, *this);
  exact = model.project(coupling());
  choose_routes(o, *this);
}

}  // namespace straytrace::cli
