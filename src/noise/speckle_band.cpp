// SPDX-License-Identifier: BSD-3-Clause
#include "noise/speckle_band.hpp"

#include <algorithm>
#include <cmath>

#include "noise/motion_directions.hpp"
#include "noise/percentiles.hpp"

namespace straytrace {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Complex = std::complex<double>;

constexpr std::size_t few = 8;  // paths of a computed route that are taken one by one

// One resolved route, seen as a complex amplitude per input of the motion.
struct Part {
  std::size_t route;
  MatrixXd directions;               // second moments of its gains, weighted by power
  std::vector<std::size_t> records;  // of a computed route: those that are phasors; empty: Gaussian
  double surviving, mean_square;
  bool family;  // coherent: one unknown phase for all of them
};

// Gains to inputs in the root of their power: by linear coupling that in the bin counts, where fringes wrap all of it.
struct Metrics {
  MatrixXcd in_bin, everywhere;
};

class SpeckleLaw {
 public:
  SpeckleLaw(NoiseBudget const& b, CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo)
      : b_(b), table_(table), ifo_(ifo), gains_(motion) {
    copies_ = infinity;
    for (std::size_t r = 0; r < b.routes.size(); ++r) {
      if (!b.routes[r].resolved || table.classes[r].records.empty()) continue;
      parts_.push_back(part(r));
      copies_ = std::min(copies_, ifo.copies(table.classes[r].port));
    }
  }

  std::array<double, 3> at(std::size_t bin) const {  // percentiles of the PSD
    MatrixXcd gamma = MatrixXcd::Zero(gains_.inputs(), gains_.inputs()), relation = gamma;
    RandomVector v;
    Metrics const metrics{gains_.to_inputs(b_.grid, bin, false), gains_.to_inputs(b_.grid, bin, true)};
    for (Part const& p : parts_) add(p, bin, metrics, gamma, relation, v);
    auto const copies = std::max(1, int(std::lround(copies_)));
    MatrixXd const covariance = real_covariance(gamma, relation) / copies;
    Eigen::SelfAdjointEigenSolver<MatrixXd> const modes(covariance);
    if (v.phasors.empty()) {
      std::vector<double> weights;
      for (double const w : modes.eigenvalues()) weights.push_back(std::max(0.0, w));
      return draws_.percentiles(weights, copies);
    }
    for (auto& [first, second] : v.phasors)
      for (auto* half : {&first, &second})
        for (double& x : *half) x /= std::sqrt(double(copies));
    for (Eigen::Index m = modes.eigenvalues().size(); m-- > 0;) {
      double const w = modes.eigenvalues()(m);
      if (!(w > 1e-6 * covariance.trace()) || !(w > 0)) break;
      Eigen::VectorXd const column = std::sqrt(w) * modes.eigenvectors().col(m);
      v.gaussian.emplace_back(column.begin(), column.end());
    }
    return draws_.percentiles(v, copies);
  }

 private:
  Part part(std::size_t r) const {
    CouplingClass const& c = table_.classes[r];
    Part p{
        r, MatrixXd::Zero(gains_.columns(), gains_.columns()), {}, 0, b_.routes[r].mean_square_phase, c.adds_fields()};
    double weight = 0;
    for (PathRecord const& record : c.records) {
      Eigen::VectorXd const g = gains_.of(record.levers);
      p.directions += record.weight * g * g.transpose();
      weight += record.weight;
    }
    double const tones = weight > 0 ? gains_.tone_power(p.directions) / weight : 0;
    p.surviving = surviving_phase(std::max(0.0, p.mean_square - tones), tones, gains_.drifts(p.directions));
    if (c.deterministic() && c.records.size() <= few && !p.family)
      for (std::size_t i = 0; i < c.records.size(); ++i) p.records.push_back(i);
    return p;
  }

  // Re and Im of a complex Gaussian vector with E H H^+ and E H H^T.
  static MatrixXd real_covariance(MatrixXcd const& gamma, MatrixXcd const& relation) {
    Eigen::Index const n = gamma.rows();
    MatrixXd out(2 * n, 2 * n);
    out.topLeftCorner(n, n) = 0.5 * (gamma + relation).real();
    out.bottomRightCorner(n, n) = 0.5 * (gamma - relation).real();
    out.topRightCorner(n, n) = 0.5 * (relation - gamma).imag();
    out.bottomLeftCorner(n, n) = out.topRightCorner(n, n).transpose();
    return out;
  }

  // Share of one static phase in the two quadratures: E H^2 / E |H|^2.
  Complex relation_of(Part const& p, std::size_t bin) const {
    PortId const port = table_.classes[p.route].port;
    Complex const phase = ifo_.strain_per_phase(port, b_.grid.centre(bin)),
                  amplitude = ifo_.strain_per_amplitude(port, b_.grid.centre(bin));
    double const both = std::norm(phase) + std::norm(amplitude);
    return both > 0 ? p.surviving * (phase * phase + amplitude * amplitude) / both : 0;
  }

  void add(Part const& p, std::size_t bin, Metrics const& metrics, MatrixXcd& gamma, MatrixXcd& relation,
           RandomVector& v) const {
    double const psd = std::pow(b_.routes[p.route].asd[bin], 2);
    if (!(psd > 0)) return;
    auto const moments = [&](MatrixXcd const& m) { return MatrixXcd(m * p.directions * m.adjoint()); };
    bool const elsewhere = p.mean_square > 1 || !(moments(metrics.in_bin).trace().real() > 0);
    MatrixXcd const& to_inputs = elsewhere ? metrics.everywhere : metrics.in_bin;
    MatrixXcd const all = moments(to_inputs);
    double const trace = all.trace().real();
    if (!(trace > 0)) return;
    Complex const share = relation_of(p, bin);
    if (p.family) return add_family(p, psd, share, to_inputs, gamma, relation, v);
    if (p.records.empty() || v.phasors.size() + p.records.size() > few) {
      gamma += psd / trace * all;
      relation += psd / trace * share * (to_inputs * p.directions * to_inputs.transpose());
      return;
    }
    for (std::size_t const i : p.records) {
      PathRecord const& record = table_.classes[p.route].records[i];
      VectorXcd const direction = std::sqrt(psd / trace * record.weight) * (to_inputs * gains_.of(record.levers));
      add_phasor(direction, share, v);
    }
  }

  // Transfer functions of the two quadratures, twice their mean square, with this share of one static phase in them.
  static std::array<Complex, 2> quadratures(Complex share) {
    double const mu = std::min(1.0, std::abs(share));
    Complex const turn = std::polar(1.0, std::arg(share) / 2);
    return {std::sqrt(1 + mu) * turn, std::sqrt(1 - mu) * turn * Complex(0, 1)};
  }

  // Fields with known relative phases: their sum is one phasor for each state of polarisation.
  void add_family(Part const& p, double psd, Complex share, MatrixXcd const& to_inputs, MatrixXcd& gamma,
                  MatrixXcd& relation, RandomVector& v) const {
    auto const [phase, amplitude] = quadratures(share);
    std::vector<std::pair<VectorXcd, VectorXcd>> states;
    double mean = 0;
    for (std::size_t const state : {0, 1}) {
      VectorXcd first = VectorXcd::Zero(gains_.inputs()), second = VectorXcd::Zero(gains_.inputs());
      for (PathRecord const& r : table_.classes[p.route].records) {
        VectorXcd const gain = to_inputs * gains_.of(r.levers);
        first += gain * (phase * r.field[state].real() - amplitude * r.field[state].imag());
        second += gain * (phase * r.field[state].imag() + amplitude * r.field[state].real());
      }
      mean += (first.squaredNorm() + second.squaredNorm()) / 2;
      if (first.squaredNorm() + second.squaredNorm() > 0) states.emplace_back(std::move(first), std::move(second));
    }
    for (auto& [first, second] : states) {
      first *= std::sqrt(psd / mean);
      second *= std::sqrt(psd / mean);
      if (v.phasors.size() < few) {
        v.phasors.emplace_back(reals(first), reals(second));
        continue;
      }
      gamma += (first * first.adjoint() + second * second.adjoint()) / 2;
      relation += (first * first.transpose() + second * second.transpose()) / 2;
    }
  }

  static std::vector<double> reals(VectorXcd const& x) {
    std::vector<double> out;
    for (Eigen::Index i = 0; i < x.size(); ++i) out.push_back(x(i).real());
    for (Eigen::Index i = 0; i < x.size(); ++i) out.push_back(x(i).imag());
    return out;
  }

  static void add_phasor(VectorXcd const& direction, Complex share, RandomVector& v) {
    auto const [phase, amplitude] = quadratures(share);
    v.phasors.emplace_back(reals(direction * phase), reals(direction * amplitude));
  }

  NoiseBudget const& b_;
  CouplingTable const& table_;
  Interferometer const& ifo_;
  MotionDirections gains_;
  Draws draws_;
  std::vector<Part> parts_;
  double copies_ = 1;
};

}  // namespace

double surviving_phase(double gaussian_mean_square, double tone_mean_square, bool drifts) {
  if (drifts) return 0;
  if (tone_mean_square > 0.1 * gaussian_mean_square) return 1;
  return std::exp(-2 * gaussian_mean_square);
}

void add_speckle_band(NoiseBudget& b, CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo) {
  SpeckleLaw const law(b, table, motion, ifo);
  NoiseBands& bands = b.bands;
  for (auto* curve : {&bands.speckle_05, &bands.speckle_50, &bands.speckle_95, &bands.coherent}) curve->clear();
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    double linear = 0;
    for (NoiseTrace const& t : b.routes)
      if (t.resolved) linear += t.asd[i];
    bool const known = !std::isnan(b.total.asd[i]);
    std::array<double, 3> percentiles{};
    if (known && linear > 0) percentiles = law.at(i);
    auto const root = [&](double psd) { return known ? std::sqrt(std::max(0.0, psd)) : not_a_number; };
    bands.speckle_05.push_back(root(percentiles[0]));
    bands.speckle_50.push_back(root(percentiles[1]));
    bands.speckle_95.push_back(root(percentiles[2]));
    bands.coherent.push_back(known ? linear : not_a_number);
  }
}

}  // namespace straytrace
