// SPDX-License-Identifier: BSD-3-Clause
#include "commission/shelf_repeat.hpp"

#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.hpp"
#include "base/functions.hpp"
#include "base/rng.hpp"
#include "signal/welch.hpp"

namespace straytrace {
namespace {

constexpr int repetitions = 64;
constexpr double spread = 0.01;  // of the true factor, to either side

// A complex number of unit mean square.
std::complex<double> normal_line(Rng& rng) {
  SinCos const turn = sincos_turn(rng.uniform());
  return std::sqrt(-std::log(rng.uniform())) * std::complex<double>(turn.cos, turn.sin);
}

// PSD of one stride made of the fitted floor and shelf, at another factor and static phase.
Eigen::VectorXd made_again(FoundEdge const& e, std::vector<double> const& u, double factor, double phase, Rng noise,
                           double wavelength) {
  ShelfStride const& d = *e.stride;
  ShelfSpectrum const spectrum(d);
  thread_local Eigen::FFT<double> fft;
  std::size_t const n = u.size();
  std::vector<std::complex<double>> lines, series(n);
  for (std::size_t i = 0; i < n; ++i) series[i] = sincos_turn(phase + 2 * factor * u[i] / wavelength).sin;
  fft.fwd(lines, series);
  lines[0] = 0;
  for (std::size_t k = 1; 2 * k <= n; ++k) {
    double const hz = double(k) * d.rate / double(n);
    lines[k] = std::sqrt(spectrum.response(e.best, hz)) * lines[k] +
               std::sqrt(spectrum.floor(e.best, hz) * d.rate * double(n) / 2) * normal_line(noise);
    lines[n - k] = std::conj(lines[k]);
  }
  fft.inv(series, lines);
  std::vector<double> real(n);
  for (std::size_t i = 0; i < n; ++i) real[i] = series[i].real();
  WelchSpectrum const w = welch(real, d.rate, {d.segment});
  return Eigen::Map<Eigen::VectorXd const>(w.psd.data() + d.first, Eigen::Index(d.hz.size()));
}

struct Local {
  std::vector<double> motion;
  FactorGrid grid;
  Eigen::MatrixXd shapes;
};

Local local_of(FoundEdge const& e, double ratio, double wavelength) {
  double const reach = spread + std::max(0.03, 8 * e.top.sigma);
  int const half = int(std::ceil(reach / factor_step));
  Local out{motion_of(*e.stride, ratio), {e.top.log_factor - half * factor_step, factor_step, 2 * half + 1}, {}};
  out.shapes = shelf_shapes(*e.stride, out.motion, out.grid, wavelength);
  return out;
}

double mean_of(Eigen::ArrayXd const& v) { return v.mean(); }
double deviation_of(Eigen::ArrayXd const& v) {
  return std::sqrt((v - v.mean()).square().sum() / double(v.size() - 1) * (1 + 1 / double(v.size())));
}

}  // namespace

std::size_t ShelfProfile::top() const {
  return std::size_t(std::max_element(twice_log.begin(), twice_log.end()) - twice_log.begin());
}

ProfileTop top_of(ShelfProfile const& p) {
  ProfileTop out;
  std::size_t const at = p.top(), last = p.twice_log.size() - 1;
  std::size_t low = at, high = at;
  while (low > 0 && p.twice_log[at] - p.twice_log[low] < 2) --low;
  while (high < last && p.twice_log[at] - p.twice_log[high] < 2) ++high;
  out.at_end = low == 0 || high == last;
  out.log_factor = p.grid.at(double(at));
  double const a = p.grid.step * (double(low) - double(at)), b = p.grid.step * (double(high) - double(at));
  double const fall_a = p.twice_log[at] - p.twice_log[low], fall_b = p.twice_log[at] - p.twice_log[high];
  if (!(fall_a > 0 && fall_b > 0)) return out;
  // fall = c (x - top)^2 - c top^2
  double const curvature = (fall_a / a - fall_b / b) / (a - b), top = (curvature * b - fall_b / b) / (2 * curvature);
  out.log_factor += std::clamp(top, a, b);
  out.sigma = 1 / std::sqrt(curvature);
  return out;
}

ShelfProfile profile_on(ShelfStride const& d, Eigen::Ref<Eigen::VectorXd const> const& psd,
                        Eigen::MatrixXd const& shapes, FactorGrid const& grid) {
  ShelfSpectrum const spectrum(d);
  ShelfProfile out{grid, {}, spectrum.best(psd, {}).twice_log, {-infinity, {}, {}}};
  ShelfSpectrum::Best best;
  for (int i = 0; i < grid.count; ++i) {
    best = spectrum.best(psd, shapes.col(i), best.model);
    out.twice_log.push_back(best.twice_log);
    if (best.twice_log > out.best.twice_log) out.best = best;
  }
  return out;
}

RepeatedEdges repeated(std::vector<FoundEdge> const& edges, double ratio, double wavelength) {
  Eigen::ArrayXXd off(repetitions, Eigen::Index(edges.size()));
  for (std::size_t i = 0; i < edges.size(); ++i) {
    Local const local = local_of(edges[i], ratio, wavelength);
    for (int r = 0; r < repetitions; ++r) {
      // Truth and static phase are those of the whole record; the noise is the stride's own.
      Rng common(1, std::uint64_t(r), 0, Stream::static_phase);
      double const truth = spread * (2 * common.uniform() - 1), phase = common.uniform();
      Eigen::VectorXd const psd =
          made_again(edges[i], local.motion, std::exp(edges[i].top.log_factor + truth), phase,
                     Rng(1, std::uint64_t(r), std::uint32_t(i + 1), Stream::source), wavelength);
      ProfileTop const found = top_of(profile_on(*edges[i].stride, psd, local.shapes, local.grid));
      off(r, Eigen::Index(i)) = found.log_factor - edges[i].top.log_factor - truth;
    }
  }
  RepeatedEdges out;
  Eigen::VectorXd weight(off.cols());
  for (Eigen::Index i = 0; i < off.cols(); ++i) {
    out.offset.push_back(mean_of(off.col(i)));
    out.sigma.push_back(deviation_of(off.col(i)));
    weight[i] = 1 / (out.sigma.back() * out.sigma.back());
  }
  weight /= weight.sum();
  Eigen::ArrayXd const mean = (off.matrix() * weight).array();
  out.mean_offset = mean_of(mean);
  out.mean_sigma = deviation_of(mean);
  for (std::size_t i = 0; i < edges.size(); ++i) out.mean += weight[Eigen::Index(i)] * edges[i].top.log_factor;
  return out;
}

}  // namespace straytrace
