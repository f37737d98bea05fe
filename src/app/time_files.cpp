// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/data_options.hpp"
#include "app/time_results.hpp"
#include "base/counted.hpp"
#include "motion/axis_motion.hpp"
#include "signal/gps.hpp"
#include "signal/series_file.hpp"
#include "signal/unit_text.hpp"

namespace straytrace {
namespace {

bool is_hdf5(std::string const& file) { return file.ends_with(".hdf5") || file.ends_with(".h5"); }

// Records of one clock: HDF5 with all, other formats as columns.
void write_series(std::string const& file, std::vector<TimeSeries> const& series, std::string const& title) {
  if (is_hdf5(file)) {
    write_file(file, series_hdf5(series));
    return;
  }
  CurveSheet sheet;
  sheet.title = title;
  sheet.x = {"gps", "s", {}};
  sheet.log_x = sheet.log_y = false;
  for (std::size_t i = 0; i < series.front().samples.size(); ++i) sheet.x.values.push_back(series.front().time(i));
  for (TimeSeries const& s : series) sheet.y.push_back({s.name, s.unit, s.samples});
  write_curves({file}, sheet);
}

// h, and the stray field at each port.
std::vector<TimeSeries> strain_channels(TimeInputs const& in, StrayLight const& light) {
  std::vector<TimeSeries> all = {strain_series(light)};
  for (PortField const& f : light.fields)
    for (bool const phase : {true, false}) {
      TimeSeries s{fmt::format("{} {}", in.coupling().ports[f.port.value], phase ? "Im s" : "Re s"),
                   "1",
                   light.times.start,
                   light.times.rate,
                   {}};
      for (std::complex<double> const x : f.field) s.samples.push_back(phase ? x.imag() : x.real());
      all.push_back(std::move(s));
    }
  return all;
}

std::vector<std::string> notes_of(ProjectResult const& r) {
  return {fmt::format("{:g} s at {:g} Hz from GPS {}, seed {}, {}, {}, {}", r.times.duration(), r.times.rate,
                      gps_text(r.times.start), r.seed, counted(r.realisations, "realisation"),
                      counted(r.routes, "route"), counted(r.paths, "field")),
          r.welch};
}

void write_spectrum(std::string const& file, ProjectResult const& r) {
  CurveSheet sheet;
  sheet.title = "strain of stray light from its time series";
  sheet.notes = notes_of(r);
  std::string const unit = "1/sqrt(Hz)";
  sheet.x = {"frequency", "Hz", {}};
  sheet.y = {{"h_mean", unit, {}}, {"sigma", unit, {}, "hidden"}, {"mean_by_spectra", unit, {}}};
  if (r.realisations >= 5)
    for (char const* name : {"percentile_5", "percentile_50", "percentile_95"})
      sheet.y.push_back({name, unit, {}, name[11] == '0' ? "line" : name[11] == '9' ? "band-high" : "band-low"});
  for (BandLevel const& b : r.spectrum) {
    sheet.x.values.push_back(b.hz);
    double const values[] = {b.asd, b.sigma, b.exact, b.below, b.median, b.above};
    for (std::size_t i = 0; i < sheet.y.size(); ++i) sheet.y[i].values.push_back(values[i]);
  }
  write_curves({file}, sheet);
}

}  // namespace

TimeSeries strain_series(StrayLight const& light) { return {"h", "1", light.times.start, light.times.rate, light.h}; }

std::vector<TimeSeries> motion_channels(MotionSeries const& motion, MotionSet const& set) {
  std::vector<TimeSeries> all;
  for (MovingCoordinate const& c : motion.coordinates)
    all.push_back({fmt::format("{} {}", set.bodies[c.body.value], axis_names[c.axis]),
                   is_rotation(c.axis) ? "rad" : "m", motion.times.start, motion.times.rate, c.position});
  return all;
}

MapSheet spectrogram_of(TimeSeries const& series, double stride, double low, double high) {
  auto const n = std::size_t(std::lround(stride * series.rate)), step = std::max<std::size_t>(1, n / 2);
  if (n < 8 || n > series.samples.size())
    throw InputError(fmt::format("error: --stride: {:g} s hold {} samples of {}\n  choose between {:.3g} s and {:g} s",
                                 stride, n, series.samples.size(), 8 / series.rate, series.duration()));
  MapSheet map;
  map.title = fmt::format("spectrogram of {}", series.name);
  map.unit = asd_unit(series.unit);
  map.notes = {fmt::format("Hann segments of {:g} s, half overlapping; ASD, one-sided", stride)};
  WelchSettings settings;
  settings.segment = n;
  for (std::size_t from = 0; from + n <= series.samples.size(); from += step) {
    WelchSpectrum const w = welch(std::span(series.samples).subspan(from, n), series.rate, settings);
    map.time.push_back(series.time(from) + stride / 2);
    for (std::size_t k = 1; k < w.psd.size(); ++k) {
      if (w.hz[k] < low || w.hz[k] > high) continue;
      if (from == 0) map.frequency.push_back(w.hz[k]);
      map.value.push_back(std::sqrt(w.psd[k]));
    }
  }
  return map;
}

void check_time_files(TimeFiles const& f) {
  for (auto const& [option, file] :
       {std::pair{"-o", f.strain}, {"--asd", f.asd}, {"--spectrogram", f.spectrogram}, {"--save-motion", f.motion}})
    if (std::string const why = file.empty() ? "" : curve_ending_error(file); !why.empty())
      throw InputError(fmt::format("error: {}: {}", option, why.substr(why.find(' ') + 1)));
}

std::vector<std::string> write_time_files(TimeFiles const& f, TimeInputs const& in, StrayLight const& light,
                                          ProjectResult const& r) {
  std::vector<std::string> written;
  auto const wanted = [&](std::string const& file) {
    if (!file.empty()) written.push_back(file);
    return !file.empty();
  };
  if (wanted(f.strain))
    write_series(f.strain, is_hdf5(f.strain) ? strain_channels(in, light) : std::vector{strain_series(light)},
                 "strain of stray light");
  if (wanted(f.motion)) write_series(f.motion, motion_channels(light.motion, in.model.motion), "motion of the bodies");
  if (wanted(f.asd)) write_spectrum(f.asd, r);
  if (wanted(f.spectrogram)) {
    double const stride = f.stride.empty() ? std::min(0.5, r.times.duration() / 4)
                                           : option_quantity(f.stride, dim::time, "--stride", "0.5 s");
    write_map({f.spectrogram}, spectrogram_of(strain_series(light), stride, r.band_low, r.band_high));
  }
  return written;
}

}  // namespace straytrace
