// SPDX-License-Identifier: BSD-3-Clause
// The noise stage against brute force in the time domain, and its accuracy. One JSON line per comparison.
#include "noise/noise.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <time.h>

#include "base/rng.hpp"
#include "noise/strength_nodes.hpp"
#include "signal/shapes.hpp"

namespace straytrace::bench {
namespace {

constexpr double wavelength = 1064e-9, two_k = 4 * pi / wavelength;
constexpr std::size_t samples = std::size_t{1} << 20;
constexpr double rate = 1024;  // Hz, of the time series
constexpr std::size_t records = 1000000;

// Processor time of this thread, s.
double now() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double seconds_of(std::function<void()> const& f) {
  double best = infinity;
  for (int i = 0; i < 3; ++i) {
    double const start = now();
    f();
    best = std::min(best, now() - start);
  }
  return best;
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

// One route of equal weights; levers along the axes scatter by a factor e^0.3 about 2k times the sine or cosine of a
// small angle of scattering.
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
    Lever l{BodyId{0}, {}};
    l.d[2] = length;
    l.d[1] = length * angle * std::cos(around);
    l.d[0] = length * angle * std::sin(around);
    r.levers = {l};
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

// Fields of paths as time series, s per path: one coordinate each, measured on a few of them.
double series_seconds_per_path(int coordinates) {
  std::vector<std::vector<float>> x(coordinates, std::vector<float>(samples));
  Rng rng(2, 0, 0, Stream::source);
  for (auto& one : x)
    for (float& v : one) v = float(1e-6 * (rng.uniform() - 0.5));
  std::vector<double> re(samples), im(samples);
  constexpr int paths = 8;
  double const seconds = seconds_of([&] {
    for (int p = 0; p < paths; ++p) {
      double const phase = 2 * pi * rng.uniform();
      for (std::size_t i = 0; i < samples; ++i) {
        double phi = phase;
        for (auto const& one : x) phi += two_k * double(one[i]);
        re[i] += std::cos(phi);
        im[i] += std::sin(phi);
      }
    }
  });
  return seconds / paths + 0 * (re[0] + im[0]);
}

Strengths strengths_of(CouplingTable const& t, MotionSet const& m, PhaseSpectra const& spectra) {
  Strengths out{spectra.classes().size(), {}, {}};
  for (PathRecord const& r : t.classes[0].records)
    for (double k : kappa_of(m, spectra.classes(), r.levers)) out.kappa.push_back(k);
  return out;
}

// Largest relative error over the bins, against the spectrum of each record by itself.
double error_of(int classes, std::size_t count) {
  CouplingTable const t = table(count);
  MotionSet const m = motion(classes);
  PhaseSpectra const spectra(group_by_shape(m), settings().grid);
  Strengths const strengths = strengths_of(t, m, spectra);
  StrengthNodes const nodes(spectra, strengths);
  std::vector<double> direct(settings().grid.size()), shared(direct);
  std::vector<StrengthNodes::Share> shares;
  for (std::size_t p = 0; p < count; ++p) {
    nodes.shares(p, shares);
    std::vector<double> const one = spectra(strengths.of(p)).psd;
    for (std::size_t i = 0; i < one.size(); ++i) {
      direct[i] += one[i];
      for (StrengthNodes::Share const& s : shares) shared[i] += s.weight * nodes.basis()[s.basis].psd[i];
    }
  }
  double worst = 0;
  for (std::size_t i = 0; i < direct.size(); ++i) worst = std::max(worst, std::fabs(shared[i] / direct[i] - 1));
  return worst;
}

void projection(std::string const& name, int classes, double error, double goal_seconds) {
  CouplingTable const t = table(records);
  MotionSet const m = motion(classes);
  double const ours = seconds_of([&] { project_noise(t, m, Fringes(), settings()); });
  FrequencyGrid const grid = settings().grid;
  // A periodogram scatters by its mean: a bin of width w and a span T average w T of its lines.
  double const one_series = 1 / std::sqrt(grid.width(0) * double(samples) / rate);
  double const repeats = std::max(1.0, std::pow(one_series / error, 2));
  double const theirs = series_seconds_per_path(classes) * double(records) * repeats;
  PhaseSpectra const spectra(group_by_shape(m), grid);
  Strengths const strengths = strengths_of(t, m, spectra);
  StrengthNodes const nodes(spectra, strengths);
  nlohmann::ordered_json line = {
      {"name", name},
      {"ours", ours},
      {"theirs", theirs},
      {"ratio", theirs / ours},
      {"error", error},
      {"unit", "s of one core"},
      {"goal_seconds", goal_seconds},
      {"nodes", nodes.nodes()},
      {"theirs_one_series", theirs / repeats},
      {"rule",
       "time series of 2^20 samples at 1024 Hz, measured on 8 paths and scaled to 1e6; repeated until the scatter "
       "1/sqrt(bin width x span x repeats) of the narrowest bin is our error"}};
  std::printf("%s\n", line.dump().c_str());
  std::fflush(stdout);
}

}  // namespace
}  // namespace straytrace::bench

int main() {
  using namespace straytrace::bench;
  double const one = error_of(1, 10000), two = error_of(2, 1000), three = error_of(3, 1000);
  for (auto const& [name, error, count] : {std::tuple{"histogram of 1 class against the sum over records", one, 10000},
                                           std::tuple{"nodes of 2 classes against the sum over records", two, 1000},
                                           std::tuple{"nodes of 3 classes against the sum over records", three, 1000}})
    std::printf(
        "%s\n",
        nlohmann::ordered_json{{"name", name}, {"records", count}, {"error", error}, {"goal", 1e-4}}.dump().c_str());
  projection("1e6 records, 1 class", 1, one, 0.5);
  projection("1e6 records, 2 classes", 2, two, 5);
  projection("1e6 records, 3 classes", 3, three, 5);
}
