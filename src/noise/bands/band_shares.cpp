// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>
#include <boost/random/sobol.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/math/constants.hpp"
#include "base/math/distributions.hpp"
#include "noise/bands/input_band.hpp"

namespace straytrace::noise {
namespace {

using Matrix = Eigen::MatrixXd;
using Spectra = UncertainPsd::Spectra;

constexpr double faintest = 1e-30, quadratic = 1e-3;  // of a PSD: its largest value; its own
constexpr int draws = 1 << 13, draws_at_once = 256;
constexpr double together = 0.05;                    // of the root of squares: below it motions add
constexpr double farthest = 4, widest = 0.35;        // nodes of a motion: standard deviations; step of t
constexpr double bent = 0.2, bent_by_motion = 0.02;  // of the band: second order beyond which first order fails

// Parts of the routes with the same scatters on all materials.
class Terms {
 public:
  Terms(Composition const& parts, std::size_t routes) {
    std::map<std::vector<int>, std::size_t> found;
    for (std::size_t r = 0; r < routes; ++r) {
      std::vector<RowPart> const& of_route = parts.parts(r);
      parts_.push_back(&of_route);
      of_part_.emplace_back();
      for (RowPart const& part : of_route) {
        auto const [at, added] = found.emplace(part.scatters, exponents_.size());
        if (added) exponents_.push_back(part.scatters);
        of_part_.back().push_back(at->second);
      }
    }
  }
  std::vector<std::vector<int>> const& exponents() const { return exponents_; }
  Spectra of(NoiseBudget const& b) const {
    Spectra out(exponents_.size(), std::vector<double>(b.grid.size(), 0));
    for (std::size_t r = 0; r < parts_.size(); ++r)
      for (std::size_t k = 0; k < parts_[r]->size(); ++k)
        for (std::size_t i = 0; i < b.grid.size(); ++i)
          if (double const psd = b.routes[r].psd(i); psd > 0) out[of_part_[r][k]][i] += (*parts_[r])[k].at(i) * psd;
    return out;
  }

 private:
  std::vector<std::vector<RowPart> const*> parts_;  // by route
  std::vector<std::vector<std::size_t>> of_part_;   // term, by route and part
  std::vector<std::vector<int>> exponents_;
};

// Values at evenly spaced nodes, at t: four weights of a cubic polynomial, from `first` on.
struct CubicWeights {
  std::size_t first = 0;
  double weight[4]{};

  CubicWeights(std::vector<double> const& nodes, double t) {
    double const step = nodes[1] - nodes[0], last = double(nodes.size()) - 1;
    double const place = std::clamp((t - nodes.front()) / step, 0.0, last);
    first = std::size_t(std::clamp(std::floor(place) - 1, 0.0, last - 3));
    double const x = place - double(first);
    for (int j = 0; j < 4; ++j) {
      weight[j] = 1;
      for (int k = 0; k < 4; ++k)
        if (k != j) weight[j] *= (x - k) / (j - k);
    }
  }
};

// ln h - ln h(0) at many points at once.
class LogNoise {
 public:
  LogNoise(UncertainPsd const& psd, std::vector<std::size_t> const& bins)
      : psd_(psd), bins_(bins), now_(in_bins(psd.psd)), total_(now_.colwise().sum()) {
    for (auto const& m : psd.motions) {
      moved_.emplace_back();
      for (Spectra const& all : m.ln_psd) moved_.back().push_back(in_bins(all));
    }
  }
  // [point][bin] of t, [point][input]. NaN where motions that are not independent leave no power.
  Matrix at(Matrix const& t) const {
    Eigen::Index const materials = t.cols() - Eigen::Index(moved_.size());
    Matrix out(t.rows(), now_.cols());
    for (Eigen::Index p = 0; p < t.rows(); ++p) {
      Eigen::RowVectorXd weight(now_.rows());
      for (Eigen::Index v = 0; v < now_.rows(); ++v) {
        double exponent = 0;
        for (Eigen::Index k = 0; k < materials; ++k)
          exponent += psd_.exponents[std::size_t(v)][std::size_t(k)] * t(p, k);
        weight[v] = std::exp(exponent);
      }
      Matrix terms = (1 - double(moved_.size())) * now_;
      for (std::size_t m = 0; m < moved_.size(); ++m)
        terms.array() += ln_moved(m, t(p, materials + Eigen::Index(m))).exp();
      out.row(p) = 0.5 * ((weight * terms).array() / total_.array()).log().matrix();
    }
    return out;
  }
  // [term][bin], of the PSD with one motion scaled.
  Eigen::ArrayXXd ln_moved(std::size_t motion, double t) const {
    CubicWeights const at(psd_.motions[motion].nodes, t);
    std::vector<Matrix> const& nodes = moved_[motion];
    Eigen::ArrayXXd sum = Eigen::ArrayXXd::Zero(now_.rows(), now_.cols()), most = nodes[at.first].array();
    for (std::size_t j = 0; j < 4; ++j) {
      sum += at.weight[j] * nodes[at.first + j].array();
      most = most.max(nodes[at.first + j].array());
    }
    return sum.min(most + 0.1);  // no overshoot next to bins without power
  }

 private:
  Matrix in_bins(Spectra const& all) const {
    Matrix out(Eigen::Index(all.size()), Eigen::Index(bins_.size()));
    for (std::size_t v = 0; v < all.size(); ++v)
      for (std::size_t i = 0; i < bins_.size(); ++i) out(Eigen::Index(v), Eigen::Index(i)) = all[v][bins_[i]];
    return out;
  }
  UncertainPsd const& psd_;
  std::vector<std::size_t> bins_;
  Matrix now_;  // [term][bin]
  Eigen::RowVectorXd total_;
  std::vector<std::vector<Matrix>> moved_;  // [motion][node]
};

// Standard normal numbers, [point][dimension], of a fixed set: each dimension has one point in each of equal shares.
Matrix normal_points(std::size_t dimensions) {
  boost::random::sobol sequence(dimensions);
  Matrix out(draws, Eigen::Index(dimensions));
  for (Eigen::Index p = 0; p < out.rows(); ++p)
    for (Eigen::Index d = 0; d < out.cols(); ++d) {
      double const u = double(sequence() >> 11) * 0x1p-53 + 0.5 / draws;
      out(p, d) = normal_quantile(std::min(u, 1 - 0.5 / draws));
    }
  return out;
}

Matrix along(std::vector<double> const& sigma, std::size_t input, double by) {
  Matrix t = Matrix::Zero(1, Eigen::Index(sigma.size()));
  t(0, Eigen::Index(input)) = by * sigma[input];
  return t;
}

// Eq. D.13: of all inputs together, and of each motion.
std::vector<bool> bent_bins(UncertainPsd const& psd, LogNoise const& ln_h, std::vector<double> const& linear) {
  std::vector<bool> out(linear.size(), false);
  auto const mark = [&](Matrix const& t, double allowed) {
    Matrix const second = 0.5 * (ln_h.at(t) + ln_h.at(-t));
    for (std::size_t i = 0; i < out.size(); ++i)
      if (!(std::fabs(second(0, Eigen::Index(i))) <= allowed * linear[i]) && linear[i] > 0) out[i] = true;
  };
  mark(Eigen::Map<Eigen::RowVectorXd const>(psd.sigma.data(), Eigen::Index(psd.sigma.size())), bent);
  for (std::size_t m = 0; m < psd.motions.size(); ++m)
    mark(along(psd.sigma, psd.sigma.size() - psd.motions.size() + m, 1), bent_by_motion);
  return out;
}

// Sums over draws of Saltelli's estimator (eq. D.14).
class Sums {
 public:
  Sums(LogNoise const& ln_h, std::size_t inputs, std::size_t bins)
      : ln_h_(ln_h),
        mean_(Row::Zero(Eigen::Index(bins))),
        square_(mean_),
        parts_(inputs, mean_),
        halved_mean_(inputs, mean_),
        halved_square_(inputs, mean_) {}

  void add(Matrix const& a, Matrix const& b) {
    Matrix const at_a = ln_h_.at(a), at_b = ln_h_.at(b);
    add_moments(at_a, mean_, square_);
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      Eigen::Index const column = Eigen::Index(k);
      Matrix changed = a;
      changed.col(column) = b.col(column);
      parts_[k] += at_b.cwiseProduct(ln_h_.at(changed) - at_a).colwise().sum() / draws;
      changed.col(column) = 0.5 * a.col(column);
      add_moments(ln_h_.at(changed), halved_mean_[k], halved_square_[k]);
    }
  }
  double band(std::size_t bin) const { return deviation(mean_, square_, bin); }
  double share(std::size_t input, std::size_t bin) const {
    return parts_[input][Eigen::Index(bin)] / std::pow(band(bin), 2);
  }
  double halving(std::size_t input, std::size_t bin) const {
    return 1 - deviation(halved_mean_[input], halved_square_[input], bin) / band(bin);
  }

 private:
  using Row = Eigen::RowVectorXd;
  static void add_moments(Matrix const& values, Row& mean, Row& square) {
    mean += values.colwise().sum() / draws;
    square += values.array().square().matrix().colwise().sum() / draws;
  }
  static double deviation(Row const& mean, Row const& square, std::size_t bin) {
    Eigen::Index const i = Eigen::Index(bin);
    return std::sqrt(square[i] - mean[i] * mean[i]);
  }
  LogNoise const& ln_h_;
  Row mean_, square_;
  std::vector<Row> parts_, halved_mean_, halved_square_;
};

// Whether the PSD follows the square of the motion: no fringes wrap.
bool follows_square(Spectra const& still, Spectra const& now, Spectra const& found, double factor) {
  for (std::size_t i = 0; !now.empty() && i < now.front().size(); ++i) {
    double made = 0, sum = 0;
    for (std::size_t v = 0; v < now.size(); ++v) {
      made += still[v][i] + factor * factor * (now[v][i] - still[v][i]);
      sum += found[v][i];
    }
    if (!(std::fabs(made - sum) <= quadratic * sum)) return false;
  }
  return true;
}

Spectra logarithms(Spectra all, Spectra const& now) {
  for (std::size_t v = 0; v < all.size(); ++v)
    for (std::size_t i = 0; i < all[v].size(); ++i)
      all[v][i] = std::log(std::max({all[v][i], faintest * now[v][i], 1e-300}));
  return all;
}

// Spectra of the terms with the motion of a cause at nodes of the logarithm of its factor.
template <class Project>
UncertainPsd::Motion moved(MotionSet const& motion, MotionCause const& cause, Spectra const& now,
                           Project const& project) {
  double const sigma = std::log(cause.uncertainty);
  int const half = std::max(int(farthest), int(std::ceil(farthest * sigma / widest)));
  auto const at = [&](double sigmas) {
    return project(with_scaled_inputs(motion, cause, [&](double u) { return std::pow(u, sigmas); }));
  };
  Spectra const still = project(with_scaled_inputs(motion, cause, [](double) { return 0; })), low = at(-farthest),
                high = at(farthest);
  double const end = std::exp(farthest * sigma);
  bool const square = follows_square(still, now, low, 1 / end) && follows_square(still, now, high, end);
  UncertainPsd::Motion out;
  for (int n = -half; n <= half; ++n) {
    double const sigmas = farthest * n / half, power = std::exp(2 * sigmas * sigma);
    out.nodes.push_back(sigmas * sigma);
    Spectra psd = n == -half ? low : n == half ? high : n == 0 || square ? now : at(sigmas);
    if (square)
      for (std::size_t v = 0; v < psd.size(); ++v)
        for (std::size_t i = 0; i < psd[v].size(); ++i) psd[v][i] = still[v][i] + power * (now[v][i] - still[v][i]);
    out.ln_psd.push_back(logarithms(std::move(psd), now));
  }
  return out;
}

// All causes at one standard deviation either way, against the sum of their changes.
template <class Project>
std::vector<bool> not_additive(UncertainPsd const& psd, MotionSet const& motion, std::vector<MotionCause> const& causes,
                               Project const& project) {
  std::vector<std::size_t> bins(psd.bins());
  std::iota(bins.begin(), bins.end(), 0);
  LogNoise const one_by_one(psd, bins);
  std::vector<bool> out(psd.bins(), false);
  double square = 0;
  for (MotionCause const& cause : causes) square += std::pow(std::log(cause.uncertainty), 2);
  for (int const towards : {-1, 1}) {
    MotionSet all = motion;
    Matrix t = Matrix::Zero(1, Eigen::Index(psd.sigma.size()));
    for (std::size_t m = 0; m < causes.size(); ++m) {
      all = with_scaled_inputs(all, causes[m], [&](double u) { return std::pow(u, towards); });
      t(0, t.cols() - Eigen::Index(causes.size() - m)) = towards * std::log(causes[m].uncertainty);
    }
    Matrix const sum = one_by_one.at(t);
    Spectra const direct = project(all);
    for (std::size_t i = 0; i < out.size(); ++i) {
      double found = 0, now = 0;
      for (std::size_t v = 0; v < direct.size(); ++v) {
        found += direct[v][i];
        now += psd.psd[v][i];
      }
      double const off = sum(0, Eigen::Index(i)) - 0.5 * std::log(found / now);
      if (found > 0 && now > 0 && !(std::fabs(off) <= together * std::sqrt(square))) out[i] = true;
    }
  }
  return out;
}

}  // namespace

UncertainPsd uncertain_psd(CouplingTable const& table, std::vector<MaterialSpread> const& materials,
                           MotionSet const& motion, std::vector<MotionCause> const& causes, Interferometer const& ifo,
                           NoiseSettings const& settings) {
  Composition const parts(table, materials, motion, ifo, settings);
  Terms const terms(parts, table.classes.size());
  auto const project = [&](MotionSet const& m) { return terms.of(project_noise(table, m, ifo, settings)); };
  UncertainPsd out;
  out.exponents = terms.exponents();
  out.psd = project(motion);
  for (MaterialSpread const& m : materials) out.sigma.push_back(std::log(m.factor));
  for (MotionCause const& cause : causes) {
    out.sigma.push_back(std::log(cause.uncertainty));
    out.motions.push_back(moved(motion, cause, out.psd, project));
  }
  out.not_additive.assign(out.bins(), false);
  if (causes.size() > 1) out.not_additive = not_additive(out, motion, causes, project);
  return out;
}

BandShares sampled_shares(UncertainPsd const& psd, std::vector<double> const& linear) {
  std::size_t const inputs = psd.sigma.size();
  BandShares out;
  out.band.assign(linear.size(), not_a_number);
  out.share.assign(inputs, out.band);
  out.halving = out.share;
  std::vector<std::size_t> bins(linear.size());
  std::iota(bins.begin(), bins.end(), 0);
  out.sampled = bent_bins(psd, LogNoise(psd, bins), linear);
  std::erase_if(bins, [&](std::size_t i) { return !out.sampled[i] || psd.not_additive[i]; });
  if (bins.empty()) return out;
  LogNoise const ln_h(psd, bins);
  Sums sums(ln_h, inputs, bins.size());
  Eigen::Index const n = Eigen::Index(inputs);
  Matrix t = normal_points(2 * inputs);
  for (Eigen::Index k = 0; k < t.cols(); ++k) t.col(k) *= psd.sigma[std::size_t(k % n)];
  for (int p = 0; p < draws; p += draws_at_once)
    sums.add(t.block(p, 0, draws_at_once, n), t.block(p, n, draws_at_once, n));
  for (std::size_t j = 0; j < bins.size(); ++j) {
    out.band[bins[j]] = sums.band(j);
    for (std::size_t k = 0; k < inputs; ++k) {
      out.share[k][bins[j]] = sums.share(k, j);
      out.halving[k][bins[j]] = sums.halving(k, j);
    }
  }
  return out;
}

}  // namespace straytrace::noise
