// SPDX-License-Identifier: BSD-3-Clause
// straytrace fringes: fringe frequencies of moving surfaces over time.
#include <fmt/format.h>

#include <algorithm>

#include "base/text/words.hpp"
#include "cli/commands.hpp"
#include "cli/data_options.hpp"
#include "cli/options.hpp"
#include "cli/time/time_options.hpp"
#include "motion/series_motion.hpp"
#include "noise/classes/delayed_paths.hpp"
#include "noise/time_domain/time_domain.hpp"
#include "results/text/columns.hpp"
#include "spectra/files/gps.hpp"

namespace straytrace::cli {
namespace {

struct FringesOptions {
  TimeOptions time;
  DataOptions data;
  std::string wavelength, stride, above, overlay;
  double bounces = 1;
  std::size_t show = 6;
};

// One curve of fringe frequency, and its name.
struct Line {
  std::string name, bodies;
  std::vector<double> hz;
};

struct FringePrediction {
  SampleTimes times;
  double wavelength = 0;
  std::vector<Line> lines;      // largest first
  std::vector<double> largest;  // of all lines, sample by sample
  std::size_t not_shown = 0;    // routes of lower coupling beyond --show
};

FringePrediction from_run(FringesOptions const& o) {
  TimeInputs in(request_of(o.time));
  MotionSeries const motion = fringe_motion(in, !o.time.channel.empty(), o.time.rate, o.time.seed);
  FringeCurves found = fringe_curves(in.coupling(), in.routes, motion, o.show);
  if (found.curves.empty())
    throw InputError("no body of these routes moves", "give --motion, or --body, --axis and --channel");
  if (in.model.noise.delay) {
    DelayedPaths const late = with_delays(in.coupling(), in.model.motion, in.model.noise.grid.edges.back());
    take_frequencies(found, late.table, draw_motion(late.motion, motion.times, o.time.seed));
  }
  FringePrediction p{motion.times, in.coupling().wavelength, {}, std::move(found.largest), found.left_out};
  for (FringeCurve& curve : found.curves) {
    std::vector<std::string> seen;
    for (Multiplicity const& m : curve.bodies)
      seen.push_back(m.bounces > 0 ? fmt::format("{} {}", in.model.motion.bodies[m.body.value],
                                                 m.spread > 5e-4 * m.bounces ? with_brackets(m.bounces, m.spread)
                                                                             : fmt::format("{:.3f}", m.bounces))
                                   : in.model.motion.bodies[m.body.value]);
    p.lines.push_back({curve.name, fmt::format("{}", fmt::join(seen, ", ")), std::move(curve.hz)});
  }
  return p;
}

// Without a run: a velocity along the beam, the wavelength and the number of bounces.
FringePrediction from_channel(FringesOptions const& o) {
  if (o.wavelength.empty() || o.time.channel.size() != 1)
    throw InputError("without a run, --wavelength and one --channel are needed",
                     "write --wavelength 1064nm --channel FILE::CHANNEL, and --bounces N");
  TimeRequest const r = request_of(o.time);
  RecordedMotion const x = channel_motion(series_argument(r.channel[0], r.unit, r.span), false, r.corner.value_or(0));
  MotionSet set;
  set.bodies = {"surface"};
  replace_coordinate(set, BodyId{0}, 2, x);
  TimeSeries const& s = *x.displacement;
  MotionSeries const motion = draw_motion(set, {s.start, s.rate, s.samples.size()}, 1);
  double const wavelength = positive_quantity(o.wavelength, dim::length, "--wavelength", "1064 nm");
  std::vector<double> hz = fringe_frequency(motion.coordinates[0].velocity, wavelength, o.bounces);
  return {motion.times, wavelength, {{s.name, fmt::format("{:g} bounces", o.bounces), hz}}, hz, 0};
}

std::string lines_text(FringePrediction const& p) {
  Columns columns{{"median/Hz", "95 %/Hz", "largest/Hz", "at GPS", "sees, in bounces of 2k", "route"},
                  {false, false, false, false, true, true},
                  {}};
  for (Line const& line : p.lines) {
    auto const top = std::max_element(line.hz.begin(), line.hz.end());
    double const when = p.times.start + double(top - line.hz.begin()) / p.times.rate;
    FringeStride const all = by_stride(line.hz, p.times, p.times.duration(), 0).front();
    columns.rows.push_back({fmt::format("{:.4g}", all.median), fmt::format("{:.4g}", all.p95),
                            fmt::format("{:.4g}", all.largest), fmt::format("{:.2f}", when), line.bodies, line.name});
  }
  std::string const text = aligned(columns);
  if (p.not_shown == 0) return text;
  return text + fmt::format("{} of lower coupling may be faster and are not shown; --show lists more\n",
                            counted(p.not_shown, "route"));
}

std::string strides_text(std::vector<FringeStride> const& strides, double above) {
  Columns columns{{"from GPS", "median/Hz", "95 %/Hz", "largest/Hz"}, {}, {}};
  if (above > 0) columns.titles.push_back(fmt::format("above {:g} Hz/%", above));
  for (FringeStride const& s : strides) {
    std::vector<std::string> row = {gps_text(s.from), fmt::format("{:.4g}", s.median), fmt::format("{:.4g}", s.p95),
                                    fmt::format("{:.4g}", s.largest)};
    if (above > 0) row.push_back(fmt::format("{:.3g}", 100 * s.share_above));
    columns.rows.push_back(row);
  }
  return aligned(columns);
}

CurveSheet sheet_of(FringePrediction const& p) {
  CurveSheet sheet;
  sheet.title = "predicted fringe frequency";
  sheet.notes = {fmt::format("|dphi/dt|/2pi (eq. 7.1), wavelength {:g} nm", p.wavelength * 1e9)};
  sheet.x = {"gps", "s", {}};
  sheet.log_x = sheet.log_y = false;
  for (std::size_t i = 0; i < p.times.samples; ++i) sheet.x.values.push_back(p.times.start + double(i) / p.times.rate);
  for (Line const& line : p.lines) sheet.y.push_back({line.name, "Hz", line.hz});
  return sheet;
}

// The spectrogram of a channel, up to twice the largest prediction, with the curves over it.
MapSheet overlay_of(FringesOptions const& o, FringePrediction const& p) {
  TimeSeries const all = series_argument(o.overlay, "", {});
  double const from = std::max(all.start, p.times.start), to = std::min(all.end(), p.times.start + p.times.duration());
  if (!(from < to))
    throw InputError(fmt::format("--overlay: '{}' has no time in common with the prediction", all.name),
                     fmt::format("it covers GPS {} to {}", gps_text(all.start), gps_text(all.end())));
  double const top = *std::max_element(p.largest.begin(), p.largest.end());
  MapSheet map = spectrogram_of(cut(all, {from, to}), std::min(0.5, (to - from) / 8), 0, std::max(2 * top, 20.0));
  auto const step = std::max<std::size_t>(1, p.times.samples / 4000);
  for (std::size_t i = 0; i < p.times.samples; i += step)
    map.line_time.push_back(p.times.start + double(i) / p.times.rate);
  for (Line const& line : p.lines) {
    map.lines.push_back({line.name, "Hz", {}});
    for (std::size_t i = 0; i < line.hz.size(); i += step) map.lines.back().values.push_back(line.hz[i]);
  }
  return map;
}

int fringes(FringesOptions const& o) {
  check_outputs(o.data);
  double const above = o.above.empty() ? 0 : option_quantity(o.above, dim::frequency, "--above", "10 Hz");
  double stride = o.stride.empty() ? 0 : positive_quantity(o.stride, dim::time, "--stride", "60 s");
  FringePrediction const p = o.time.run.empty() ? from_channel(o) : from_run(o);
  std::string text = fmt::format("{:g} s from GPS {}, wavelength {:g} nm: fringe frequency |dphi/dt|/2pi (eq. 7.1)\n{}",
                                 p.times.duration(), gps_text(p.times.start), p.wavelength * 1e9, lines_text(p));
  if (!o.stride.empty() || above > 0) {
    if (o.stride.empty()) stride = p.times.duration() / 10;
    std::vector<FringeStride> const strides = by_stride(p.largest, p.times, stride, above);
    text += "\nlargest of these routes, by stride\n" + strides_text(strides, above);
    if (above > 0) {
      std::vector<StretchAbove> const stretches = stretches_above(strides, above);
      for (StretchAbove const& s : stretches)
        text += fmt::format("above {:g} Hz from GPS {} to {}, at most {:.4g} Hz\n", above, gps_text(s.from),
                            gps_text(s.to), s.largest);
      if (stretches.empty()) text += fmt::format("never above {:g} Hz in these routes\n", above);
    }
  }
  if (o.overlay.empty())
    answer(o.data, sheet_of(p), text);
  else
    answer(o.data, overlay_of(o, p), text);
  return done;
}

}  // namespace

void add_fringes(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<FringesOptions>();
  FringesOptions& o = *options;
  auto* const command =
      app.add_subcommand("fringes", "Predict the fringe frequency over time, of a run or of one moving surface.");
  command->add_option("run", o.time.run, "run file (HDF5); without it, --wavelength and --channel are needed");
  command->add_option("--wavelength", o.wavelength, "wavelength of the light, without a run: 1064nm");
  command->add_option("--bounces", o.bounces, "number of bounces on the surface at normal incidence, without a run")
      ->check(number_between(1e-3, 1e4, "2"));
  add_motion_options(*command, o.time);
  add_stretch_options(*command, o.time);
  add_route_options(*command, o.time);
  command->add_option("--stride", o.stride, "interval of the table of percentiles: 60s")
      ->check(is_quantity(dim::time, "--stride", "60 s"));
  command->add_option("--above", o.above, "list times when the fringe frequency exceeds this: 10Hz");
  command->add_option("--overlay", o.overlay, "FILE::CHANNEL whose spectrogram is drawn behind the curves");
  command->add_option("--show", o.show, "number of routes, by coupling")->check(whole_between(1, 1000, "6"));
  add_output_options(*command, o.data);
  command->footer(
      "Examples:\n"
      "  straytrace fringes demo/run.h5 --motion examples/storm.yaml --stride 8s --above 10Hz\n"
      "  straytrace fringes --wavelength 1064nm --bounces 2 --channel 'storm.hdf5::tube z' -o fringes.png");
  command->callback([options, &exit_code] { exit_code = fringes(*options); });
}

}  // namespace straytrace::cli
