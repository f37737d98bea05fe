// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/fringes/shelf_shape.hpp"

#include <Eigen/Dense>
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "base/math/constants.hpp"
#include "base/math/functions.hpp"
#include "base/math/rng.hpp"
#include "spectra/welch.hpp"

namespace straytrace {
namespace {

constexpr double blur = 0.01;            // of the factor, to either side
constexpr double turn_of_a_step = 1;     // rad, of the largest phase between two shapes that are averaged
constexpr double settled_change = 3e-3;  // of 2 ln L
constexpr std::array floor_powers{0, -2, -4};
constexpr std::array<double, 5> choose{1, 4, 6, 4, 1};  // Bernstein polynomials of ln(f) across the band

Eigen::VectorXd one_shape(ShelfStride const& d, std::vector<double> const& u, double factor, double wavelength) {
  thread_local Eigen::FFT<double> fft;
  std::size_t const n = d.segment;
  std::vector<std::complex<double>> field(u.size()), part(n), lines;
  for (std::size_t i = 0; i < u.size(); ++i) {
    SinCos const turn = sincos_turn(2 * factor * u[i] / wavelength);
    field[i] = {turn.cos, turn.sin};
  }
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(Eigen::Index(d.hz.size()));
  double segments = 0;
  for (std::size_t begin = 0; begin + n <= u.size(); begin += n / 2, ++segments) {
    for (std::size_t i = 0; i < n; ++i)
      part[i] = field[begin + i] * (0.5 - 0.5 * std::cos(2 * pi * double(i) / double(n)));
    fft.fwd(lines, part);
    for (Eigen::Index k = 0; k < sum.size(); ++k)
      sum[k] += std::norm(lines[d.first + std::size_t(k)]) + std::norm(lines[n - d.first - std::size_t(k)]);
  }
  return sum / (2 * d.rate * 0.375 * double(n) * segments);
}

// x >= 0 of least x'Ax/2 - b'x (Lawson and Hanson 1974); A has a unit diagonal.
Eigen::VectorXd least_squares_not_negative(Eigen::MatrixXd const& a, Eigen::VectorXd const& b) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  std::vector<Eigen::Index> in;
  for (Eigen::Index round = 0; round < 3 * b.size(); ++round) {
    Eigen::VectorXd slope = b - a * x;
    for (Eigen::Index const i : in) slope[i] = 0;
    Eigen::Index steepest = 0;
    if (!(slope.maxCoeff(&steepest) > 1e-9 * b.maxCoeff())) break;
    in.push_back(steepest);
    for (;;) {
      Eigen::VectorXd const some = a(in, in).ldlt().solve(Eigen::VectorXd(b(in)));
      if (some.minCoeff() > 0) {
        x.setZero();
        x(in) = some;
        break;
      }
      double share = 1;
      for (std::size_t i = 0; i < in.size(); ++i)
        if (double const s = some[Eigen::Index(i)]; s <= 0) share = std::min(share, x[in[i]] / (x[in[i]] - s));
      std::vector<Eigen::Index> left;
      for (std::size_t i = 0; i < in.size(); ++i) {
        double& v = x[in[i]];
        v += share * (some[Eigen::Index(i)] - v);
        if (v > 1e-12)
          left.push_back(in[i]);
        else
          v = 0;
      }
      if (left.empty()) return x;
      in = left;
    }
  }
  return x;
}

}  // namespace

std::vector<double> motion_of(ShelfStride const& d, double ratio) {
  std::vector<double> u = d.x;
  for (std::size_t i = 0; i < d.y.size(); ++i) u[i] -= ratio * d.y[i];
  return u;
}

double fastest(std::vector<double> const& u, double rate) {
  double v = 0;
  for (std::size_t i = 1; i < u.size(); ++i) v = std::max(v, std::fabs(u[i] - u[i - 1]) * rate);
  return v;
}

Eigen::MatrixXd shelf_shapes(ShelfStride const& d, std::vector<double> const& u, FactorGrid const& grid,
                             double wavelength) {
  auto const [low, high] = std::minmax_element(u.begin(), u.end());
  double const swing = 4 * pi / wavelength * (*high - *low) * std::exp(grid.at(grid.count - 1));
  int const parts = std::max(2, int(std::ceil(grid.step * swing / turn_of_a_step)));
  int const reach = std::max(1, int(std::lround(blur / grid.step * parts)));
  std::vector<Eigen::VectorXd> fine;
  for (int i = -reach; i <= (grid.count - 1) * parts + reach; ++i)
    fine.push_back(one_shape(d, u, std::exp(grid.at(double(i) / parts)), wavelength));
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(Eigen::Index(d.hz.size()), grid.count);
  for (int i = 0; i < grid.count; ++i)
    for (int j = -reach; j <= reach; ++j) out.col(i) += fine[std::size_t(i * parts + j + reach)] / (2 * reach + 1);
  return out;
}

ShelfSpectrum::ShelfSpectrum(ShelfStride const& d)
    : hz_(Eigen::Map<Eigen::VectorXd const>(d.hz.data(), Eigen::Index(d.hz.size()))),
      middle_(std::sqrt(d.hz.front() * d.hz.back())),
      weight_(d.weight),
      floors_(hz_.size(), Eigen::Index(floor_powers.size())),
      responses_(hz_.size(), Eigen::Index(choose.size())) {
  for (Eigen::Index k = 0; k < hz_.size(); ++k) {
    floors_.row(k) = floor_terms(hz_[k]);
    responses_.row(k) = response_terms(hz_[k]);
  }
}

Eigen::RowVectorXd ShelfSpectrum::floor_terms(double hz) const {
  Eigen::RowVectorXd out(floor_powers.size());
  for (std::size_t i = 0; i < floor_powers.size(); ++i)
    out[Eigen::Index(i)] = std::pow(std::max(hz, hz_[0]) / middle_, floor_powers[i]);
  return out;
}

Eigen::RowVectorXd ShelfSpectrum::response_terms(double hz) const {
  double const last = hz_[hz_.size() - 1],
               x = std::log(std::clamp(hz, hz_[0], last) / hz_[0]) / std::log(last / hz_[0]);
  auto const degree = int(choose.size()) - 1;
  Eigen::RowVectorXd out(choose.size());
  for (int i = 0; i <= degree; ++i) out[i] = choose[std::size_t(i)] * std::pow(x, i) * std::pow(1 - x, degree - i);
  return out;
}

ShelfSpectrum::Best ShelfSpectrum::best(Eigen::Ref<Eigen::VectorXd const> const& psd, Eigen::VectorXd const& shape,
                                        Eigen::VectorXd model) const {
  Eigen::MatrixXd columns(psd.size(), floors_.cols() + (shape.size() > 0 ? responses_.cols() : 0));
  columns.leftCols(floors_.cols()) = floors_;
  if (shape.size() > 0) columns.rightCols(responses_.cols()) = shape.asDiagonal() * responses_;
  Best out{-infinity, {}, {}};
  if (model.size() == 0) model = Eigen::VectorXd::Constant(psd.size(), psd.mean());
  for (int round = 0; round < 30; ++round) {
    Eigen::MatrixXd const weighted = model.cwiseInverse().asDiagonal() * columns;
    Eigen::VectorXd const scale = weighted.colwise().norm().cwiseInverse();
    Eigen::MatrixXd const unit = weighted * scale.asDiagonal();
    Eigen::VectorXd const share = scale.cwiseProduct(
        least_squares_not_negative(unit.transpose() * unit, unit.transpose() * psd.cwiseQuotient(model)));
    model = (columns * share).cwiseMax(1e-9 * psd.mean());
    double const twice_log = -2 * weight_ * (model.array().log() + psd.array() / model.array()).sum();
    bool const settled = std::fabs(twice_log - out.twice_log) < settled_change;
    if (round == 0 || twice_log > out.twice_log) out = {twice_log, share, model};
    if (settled) break;
  }
  return out;
}

double ShelfSpectrum::floor(Best const& b, double hz) const {
  return floor_terms(hz).dot(b.share.head(floors_.cols()));
}

double ShelfSpectrum::response(Best const& b, double hz) const {
  return response_terms(hz).dot(b.share.tail(responses_.cols()));
}

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
