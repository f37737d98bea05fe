// SPDX-License-Identifier: BSD-3-Clause
// The noise stage against brute force in the time domain, and its accuracy. One JSON line per comparison
// (bench/record.py).
#include "noise/noise.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <time.h>

#include "base/every_module.hpp"
#include "base/math/rng.hpp"
#include "noise/interpolate/spectrum_interpolator.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::bench {
namespace {

constexpr double wavelength = 1064e-9, two_k = 4 * pi / wavelength;
constexpr std::size_t samples = std::size_t{1} << 20;
constexpr double rate = 1024;  // Hz, of the time series

// Processor time of this thread, s.
double now() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double seconds_of(std::function<void()> const& f) {
  double const start = now();
  f();
  return now() - start;
}

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}
double spread(std::vector<double> const& x) {
  auto const [least, most] = std::minmax_element(x.begin(), x.end());
  return (*most - *least) / median(x);
}

// A line of /proc/self/status, bytes.
std::size_t status(std::string const& key) {
  std::ifstream file("/proc/self/status");
  std::string word;
  std::size_t kib = 0;
  while (file >> word)
    if (word == key + ":") file >> kib;
  return 1024 * kib;
}
// Peak memory of f in bytes, beyond the memory before it.
std::size_t memory_of(std::function<void()> const& f) {
  std::ofstream("/proc/self/clear_refs") << 5;  // the peak starts anew
  std::size_t const before = status("VmRSS");
  f();
  return status("VmHWM") - before;
}

void tell(nlohmann::ordered_json const& line) {
  std::puts(line.dump().c_str());
  std::fflush(stdout);
}

class Fringes final : public Interferometer {
 public:
  std::complex<double> strain_per_phase(PortId, double) const override { return 1; }
  std::complex<double> strain_per_amplitude(PortId, double) const override { return 0; }
  double copies(PortId) const override { return 1; }
  std::string description() const override { return "h = Im s"; }
};

double normal(Rng& rng) { return std::sqrt(-2 * std::log(rng.uniform())) * std::cos(2 * pi * rng.uniform()); }

// Ground motion of the Virgo arm along z; other shapes of the same strength along x and y.
MotionSet motion(int classes) {
  MotionSet set;
  set.bodies = {"tube"};
  Spectrum const microseism = gaussian_line(0.35, 0.08, 0.5e-6);
  for (int c = 0; c < classes; ++c) {
    Spectrum const s = power_law_asd(1e-6, 1, -2 - 0.2 * c, 0.7, 2000) + microseism.scaled(1 + c);
    set.inputs.push_back({"tube", s, 0, {{BodyId{0}, 2 - c, 1}}});
  }
  return set;
}

// One route of equal weights; phase sensitivities along the axes scatter by a factor e^0.3 about 2k times the sine or
// cosine of a small angle of scattering.
CouplingTable table(std::size_t count) {
  CouplingTable t;
  CouplingClass c;
  c.port = PortId{0};
  c.coupling.mean = 1;
  c.coupling.trusted = true;
  c.coupling.scored = 1;
  c.replica_sum.fill(4096);
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(1, i, 0, Stream::source);
    PathRecord r;
    r.history = i * 4096 / 64;
    r.weight = r.coupling = 1 / double(count);
    double const length = two_k * std::exp(0.3 * normal(rng)), angle = 0.1 * std::exp(0.3 * normal(rng));
    double const around = 2 * pi * rng.uniform();
    PhaseSensitivity l{BodyId{0}, {}};
    l.d[2] = length;
    l.d[1] = length * angle * std::cos(around);
    l.d[0] = length * angle * std::sin(around);
    r.phase_sensitivities = {l};
    c.records.push_back(std::move(r));
  }
  t.classes = {c};
  t.ports = {"port"};
  t.replica_histories.fill(4096);
  t.histories = 4096 * replica_count;
  t.wavelength = wavelength;
  return t;
}

NoiseSettings settings() {
  NoiseSettings s;
  s.grid = logarithmic_grid(3, 1000, 60);
  return s;
}

// Fields of paths as time series, one coordinate of motion each.
class TimeSeries {
 public:
  explicit TimeSeries(int coordinates) : x_(coordinates, std::vector<float>(samples)), re_(samples), im_(samples) {
    for (auto& one : x_)
      for (float& v : one) v = float(1e-6 * (rng_.uniform() - 0.5));
  }
  // s per path, measured on a few of them.
  double seconds_per_path() {
    constexpr int paths = 4;
    return seconds_of([&] {
             for (int p = 0; p < paths; ++p) add_path(2 * pi * rng_.uniform());
           }) /
           paths;
  }
  std::size_t bytes() const { return samples * (x_.size() * sizeof(float) + 2 * sizeof(double)); }
  double sum() const { return re_[0] + im_[0]; }

 private:
  void add_path(double phase) {
    for (std::size_t i = 0; i < samples; ++i) {
      double phi = phase;
      for (auto const& one : x_) phi += two_k * double(one[i]);
      re_[i] += std::cos(phi);
      im_[i] += std::sin(phi);
    }
  }
  Rng rng_{2, 0, 0, Stream::source};
  std::vector<std::vector<float>> x_;
  std::vector<double> re_, im_;
};

Strengths strengths_of(CouplingTable const& t, MotionSet const& m, PhaseSpectra const& spectra) {
  Strengths out{spectra.classes().size(), {}, {}};
  for (PathRecord const& r : t.classes[0].records)
    for (double k : kappa_of(m, spectra.classes(), r.phase_sensitivities)) out.kappa.push_back(k);
  return out;
}

// Largest relative error over the bins, against the separate spectrum of each record.
double error_of(int classes, std::size_t count) {
  CouplingTable const t = table(count);
  MotionSet const m = motion(classes);
  PhaseSpectra const spectra(group_by_shape(m), settings().grid);
  Strengths const strengths = strengths_of(t, m, spectra);
  SpectrumInterpolator const nodes(spectra, strengths);
  std::vector<double> direct(settings().grid.size()), shared(direct);
  std::vector<SpectrumInterpolator::Share> shares;
  for (std::size_t p = 0; p < count; ++p) {
    nodes.shares(p, shares);
    std::vector<double> const one = spectra(strengths.of(p)).psd;
    for (std::size_t i = 0; i < one.size(); ++i) {
      direct[i] += one[i];
      for (SpectrumInterpolator::Share const& s : shares) shared[i] += s.weight * nodes.basis()[s.basis].psd[i];
    }
  }
  double worst = 0;
  for (std::size_t i = 0; i < direct.size(); ++i) worst = std::max(worst, std::fabs(shared[i] / direct[i] - 1));
  return worst;
}

constexpr char const* rule =
    "one time series of 2^20 samples at 1024 Hz per path, measured on 4 paths and scaled to all; a bin of it scatters "
    "by "
    "theirs_error, so that equal errors take (theirs_error/error)^2 times as long";

void projection(int classes, double error, double goal_seconds, std::size_t count, int repeats) {
  std::string const name = std::to_string(count) + " records, motion of " + std::to_string(classes) + " shapes";
  MotionSet const m = motion(classes);
  CouplingTable const t = table(count);
  FrequencyGrid const grid = settings().grid;
  // A periodogram scatters by its mean: a bin of width w and a span T average w T of its lines.
  double const one_series = 1 / std::sqrt(grid.width(0) * double(samples) / rate);
  TimeSeries yardstick(classes);
  auto const project = [&] { project_noise(t, m, Fringes(), settings()); };
  std::size_t const bytes = memory_of(project);
  std::vector<double> ours, theirs, ratios;
  for (int k = 0; k < repeats; ++k) {
    theirs.push_back(yardstick.seconds_per_path() * double(count));
    ours.push_back(seconds_of(project));
    ratios.push_back(theirs.back() / ours.back());
  }
  PhaseSpectra const spectra(group_by_shape(m), grid);
  Strengths const strengths = strengths_of(t, m, spectra);
  nlohmann::ordered_json const line = {{"ours", median(ours)},
                                       {"theirs", median(theirs)},
                                       {"unit", "s"},
                                       {"ratio", median(ratios)},
                                       {"repeats", repeats},
                                       {"error", error},
                                       {"nodes", SpectrumInterpolator(spectra, strengths).nodes()},
                                       {"theirs_error", one_series},
                                       {"memory", bytes},
                                       {"theirs_memory", yardstick.bytes()},
                                       {"rule", rule}};
  nlohmann::ordered_json seconds = line, against = line;
  seconds.update({{"case", name}, {"spread", spread(ours)}, {"goal", {{"of", "ours"}, {"at_most", goal_seconds}}}});
  against.update({{"case", name + ", over one time series"},
                  {"spread", spread(ratios)},
                  {"goal", {{"of", "ratio"}, {"at_least", 1000}}}});
  tell(seconds);
  tell(against);
}

}  // namespace
}  // namespace straytrace::bench

// bench_noise SHAPES [RECORDS] [TURNS]
int main(int argc, char** argv) {
  using namespace straytrace::bench;
  int const classes = argc > 1 ? std::atoi(argv[1]) : 0;
  if (classes < 1 || classes > 3) {
    std::fputs("usage: bench_noise 1|2|3 [RECORDS] [TURNS]\n", stderr);
    return 2;
  }
  std::size_t const count = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1000000;
  std::size_t const compared = std::min<std::size_t>(count, classes == 1 ? 10000 : 1000);
  double const error = error_of(classes, compared);
  tell({{"case", "error of " + std::to_string(classes) + " shapes"},
        {"ours", error},
        {"records", compared},
        {"goal", {{"of", "ours"}, {"at_most", 1e-4}}}});
  projection(classes, error, classes == 1 ? 0.5 : 5, count, argc > 3 ? std::atoi(argv[3]) : 5);
}
