// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/speckle_band.hpp"

#include <boost/math/special_functions/erf.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/math/constants.hpp"
#include "noise/classes/motion_classes.hpp"

namespace straytrace::noise {
namespace {

// Root of x^(d+1) = x + 1: the steps 1/x, 1/x^2, ... of a set that fills the unit cube of d dimensions evenly.
double golden(int dimensions) {
  double x = 2;
  for (int i = 0; i < 60; ++i) x = std::pow(1 + x, 1.0 / (dimensions + 1));
  return x;
}

// Two dimensions first: a single speckle needs only them, and few dimensions are filled better.
double step(int dimension) {
  return dimension < 2 ? std::pow(golden(2), -(dimension + 1)) : std::pow(golden(Draws::most - 2), -(dimension - 1));
}

}  // namespace

Draws::Draws() {
  for (int d = 0; d < most; ++d) {
    normal_.emplace_back(count);
    squared_.emplace_back(count);
    turn_.emplace_back(count);
    double const by = step(d);
    for (int i = 0; i < count; ++i) {
      double const u = std::fmod(0.5 + (i + 1) * by, 1.0);
      turn_[d][i] = u;
      normal_[d][i] = std::sqrt(2.0) * boost::math::erf_inv(2 * std::clamp(u, 1e-9, 1 - 1e-9) - 1);
      squared_[d][i] = normal_[d][i] * normal_[d][i];
    }
  }
}

std::array<double, 3> Draws::read_off(std::vector<double>& values) const {
  std::array<double, 3> out{};
  constexpr double below[] = {0.05, 0.5, 0.95};
  auto from = values.begin();
  for (int k = 0; k < 3; ++k) {
    auto const at = values.begin() + std::ptrdiff_t(below[k] * count);
    std::nth_element(from, at, values.end());
    out[k] = *at;
    from = at;
  }
  return out;
}

std::array<double, 3> Draws::percentiles(std::vector<double> weights, int copies) const {
  std::ranges::sort(weights, std::greater<>());
  double constant = 0;
  std::vector<double> used;
  for (std::size_t m = 0; m < weights.size(); ++m) {
    bool const counts = weights[m] > 1e-4 * weights.front() && used.size() + copies <= std::size_t(most);
    if (!counts) constant += copies * weights[m];
    for (int c = 0; c < copies && counts; ++c) used.push_back(weights[m]);
  }
  std::vector<double> values(count, constant);
  for (std::size_t d = 0; d < used.size(); ++d)
    for (int i = 0; i < count; ++i) values[i] += used[d] * squared_[d][i];
  return read_off(values);
}

std::array<double, 3> Draws::percentiles(RandomVector const& v, int copies) const {
  std::size_t const size = !v.gaussian.empty() ? v.gaussian.front().size() : v.phasors.front().first.size();
  std::vector<double> values(count);
  int direction = 0;
  auto const next = [&] { return direction++ % most; };
  for (int c = 0; c < copies; ++c) {
    std::vector<std::vector<double>> sum(size, std::vector<double>(count));
    for (auto const& [first, second] : v.phasors) {
      int const d = next();
      for (int i = 0; i < count; ++i) {
        double const cosine = std::cos(2 * pi * turn_[d][i]), sine = std::sin(2 * pi * turn_[d][i]);
        for (std::size_t k = 0; k < size; ++k) sum[k][i] += first[k] * cosine + second[k] * sine;
      }
    }
    for (std::vector<double> const& column : v.gaussian) {
      int const d = next();
      for (std::size_t k = 0; k < size; ++k)
        for (int i = 0; i < count && column[k] != 0; ++i) sum[k][i] += column[k] * normal_[d][i];
    }
    for (std::vector<double> const& row : sum)
      for (int i = 0; i < count; ++i) values[i] += row[i] * row[i];
  }
  return read_off(values);
}

namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Complex = std::complex<double>;

constexpr std::size_t few = 8;  // paths of a computed route that are taken one by one

// One route as complex amplitudes per input of the motion, only of inputs that move it.
struct Part {
  std::size_t route;
  std::vector<std::size_t> columns, inputs;  // ascending
  std::size_t block = 0;                     // of inputs
  std::vector<Eigen::Index> rows;            // where its inputs are in the block
  MatrixXd directions;                       // second moments of its gains to columns, weighted by power
  std::vector<std::size_t> records;          // of a computed route: its phasors; empty: Gaussian
  double surviving, mean_square;
  bool family;  // coherent: one unknown phase for all of them
};

// Gains of columns to inputs in the root of their power: the power in the bin for linear coupling, all of it where
// fringes wrap.
struct Metrics {
  std::vector<Complex> in_bin, everywhere;
};

class SpeckleLaw {
 public:
  SpeckleLaw(NoiseBudget const& b, CouplingTable const& table, MotionSet const& motion, Interferometer const& ifo)
      : b_(b), table_(table), ifo_(ifo), gains_(motion) {
    copies_ = infinity;
    for (std::size_t r = 0; r < b.routes.size(); ++r) {
      if (table.classes[r].records.empty() || table.classes[r].kind == ClassKind::rim) continue;
      parts_.push_back(part(r));
      copies_ = std::min(copies_, ifo.copies(table.classes[r].port));
    }
    divide_inputs();
  }

  std::array<double, 3> at(std::size_t bin) const {  // percentiles of the PSD
    std::vector<SpeckleMoments> moments;
    for (auto const& block : blocks_) {
      MatrixXcd const none = MatrixXcd::Zero(Eigen::Index(block.size()), Eigen::Index(block.size()));
      moments.push_back({none, none});
    }
    RandomVector v;
    Metrics const metrics{gains_.to_inputs(b_.grid, bin, false), gains_.to_inputs(b_.grid, bin, true)};
    for (Part const& p : parts_)
      if (!p.inputs.empty()) add(p, bin, metrics, moments[p.block], v);
    auto const copies = std::max(1, int(std::lround(copies_)));
    std::vector<SpeckleMode> const modes = modes_of(moments, !v.phasors.empty());
    if (v.phasors.empty()) {
      std::vector<double> weights;
      for (SpeckleMode const& m : modes) weights.push_back(m.weight / copies);
      return draws_.percentiles(weights, copies);
    }
    for (auto& [first, second] : v.phasors)
      for (auto* half : {&first, &second})
        for (double& x : *half) x /= std::sqrt(double(copies));
    double total = 0;
    for (SpeckleMode const& m : modes) total += m.weight;
    for (SpeckleMode const& m : modes)
      if (m.weight > 1e-6 * total)
        v.gaussian.push_back(among_all(std::sqrt(m.weight / copies) * m.direction, blocks_[m.block]));
    return draws_.percentiles(v, copies);
  }

 private:
  Part part(std::size_t r) const {
    CouplingClass const& c = table_.classes[r];
    Part p{r, {}, {}, 0, {}, {}, {}, 0, b_.routes[r].mean_square_phase, c.adds_fields()};
    std::set<std::size_t> columns, inputs;
    for (PathRecord const& record : c.records)
      for (auto const& [column, gain] : gains_.of(record.phase_sensitivities)) columns.insert(column);
    for (std::size_t const column : columns) inputs.insert(gains_.input(column));
    p.columns.assign(columns.begin(), columns.end());
    p.inputs.assign(inputs.begin(), inputs.end());
    p.directions = MatrixXd::Zero(Eigen::Index(columns.size()), Eigen::Index(columns.size()));
    double weight = 0, tones = 0;
    for (PathRecord const& record : c.records) {
      Eigen::VectorXd const g = to_columns(p, record);
      p.directions += record.weight * g * g.transpose();
      weight += record.weight;
    }
    bool drifts = false;
    for (std::size_t k = 0; k < p.columns.size(); ++k) {
      double const square = p.directions(Eigen::Index(k), Eigen::Index(k));
      if (gains_.tone(p.columns[k])) tones += 0.5 * square;
      drifts |= gains_.drifts(p.columns[k]) && square > 0;
    }
    if (weight > 0) tones /= weight;
    p.surviving = surviving_phase(std::max(0.0, p.mean_square - tones), tones, drifts);
    if (c.deterministic() && c.records.size() <= few && !p.family)
      for (std::size_t i = 0; i < c.records.size(); ++i) p.records.push_back(i);
    return p;
  }

  Eigen::VectorXd to_columns(Part const& p, PathRecord const& record) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(Eigen::Index(p.columns.size()));
    for (auto const& [column, gain] : gains_.of(record.phase_sensitivities)) out[place(p.columns, column)] = gain;
    return out;
  }
  // Columns of a part to its inputs.
  MatrixXcd matrix(Part const& p, std::vector<Complex> const& factors) const {
    MatrixXcd out = MatrixXcd::Zero(Eigen::Index(p.inputs.size()), Eigen::Index(p.columns.size()));
    for (std::size_t k = 0; k < p.columns.size(); ++k)
      out(place(p.inputs, gains_.input(p.columns[k])), Eigen::Index(k)) = factors[p.columns[k]];
    return out;
  }
  static Eigen::Index place(std::vector<std::size_t> const& ascending, std::size_t value) {
    return std::ranges::lower_bound(ascending, value) - ascending.begin();
  }

  // Inputs that affect one route belong to one block.
  void divide_inputs() {
    std::vector<std::size_t> with(gains_.inputs());  // another input of the same block; the first of all: itself
    std::iota(with.begin(), with.end(), std::size_t{0});
    auto const first = [&](std::size_t i) {
      while (with[i] != i) i = with[i] = with[with[i]];
      return i;
    };
    for (Part const& p : parts_)
      for (std::size_t const i : p.inputs) {
        auto const [low, high] = std::minmax({first(i), first(p.inputs.front())});
        with[high] = low;
      }
    std::vector<std::size_t> number(with.size()), row(with.size());
    for (std::size_t i = 0; i < with.size(); ++i) {
      if (first(i) == i) {
        number[i] = blocks_.size();
        blocks_.emplace_back();
      }
      number[i] = number[first(i)];
      row[i] = blocks_[number[i]].size();
      blocks_[number[i]].push_back(i);
    }
    for (Part& p : parts_) {
      if (!p.inputs.empty()) p.block = number[p.inputs.front()];
      for (std::size_t const i : p.inputs) p.rows.push_back(Eigen::Index(row[i]));
    }
  }

  // Share of one static phase in the two quadratures: E H^2 / E |H|^2.
  Complex relation_of(Part const& p, std::size_t bin) const {
    PortId const port = table_.classes[p.route].port;
    Complex const phase = ifo_.strain_per_phase(port, b_.grid.centre(bin)),
                  amplitude = ifo_.strain_per_amplitude(port, b_.grid.centre(bin));
    double const both = std::norm(phase) + std::norm(amplitude);
    return both > 0 ? p.surviving * (phase * phase + amplitude * amplitude) / both : 0;
  }

  void add(Part const& p, std::size_t bin, Metrics const& metrics, SpeckleMoments& moments, RandomVector& v) const {
    double const psd = b_.routes[p.route].psd(bin);
    if (!(psd > 0)) return;
    auto const power = [&](MatrixXcd const& m) { return MatrixXcd(m * p.directions * m.adjoint()); };
    MatrixXcd to_inputs = matrix(p, metrics.in_bin);
    if (p.mean_square > 1 || !(power(to_inputs).trace().real() > 0)) to_inputs = matrix(p, metrics.everywhere);
    MatrixXcd const all = power(to_inputs);
    double const trace = all.trace().real();
    if (!(trace > 0)) return;
    Complex const share = relation_of(p, bin);
    if (p.family) return add_family(p, psd, share, to_inputs, moments, v);
    if (p.records.empty() || v.phasors.size() + p.records.size() > few) {
      moments.gamma(p.rows, p.rows) += psd / trace * all;
      moments.relation(p.rows, p.rows) += psd / trace * share * (to_inputs * p.directions * to_inputs.transpose());
      return;
    }
    auto const [phase, amplitude] = quadratures(share);
    for (std::size_t const i : p.records) {
      PathRecord const& record = table_.classes[p.route].records[i];
      VectorXcd const direction = std::sqrt(psd / trace * record.weight) * (to_inputs * to_columns(p, record));
      v.phasors.emplace_back(reals(direction * phase, p.inputs), reals(direction * amplitude, p.inputs));
    }
  }

  // Transfer functions of the two quadratures, twice their mean square, with this share of one static phase in them.
  static std::array<Complex, 2> quadratures(Complex share) {
    double const mu = std::min(1.0, std::abs(share));
    Complex const turn = std::polar(1.0, std::arg(share) / 2);
    return {std::sqrt(1 + mu) * turn, std::sqrt(1 - mu) * turn * Complex(0, 1)};
  }

  // Fields with known relative phases: their sum is one phasor for each state of polarisation.
  void add_family(Part const& p, double psd, Complex share, MatrixXcd const& to_inputs, SpeckleMoments& moments,
                  RandomVector& v) const {
    auto const [phase, amplitude] = quadratures(share);
    std::vector<std::pair<VectorXcd, VectorXcd>> states;
    double mean = 0;
    for (std::size_t const state : {0, 1}) {
      VectorXcd first = VectorXcd::Zero(to_inputs.rows()), second = first;
      for (PathRecord const& r : table_.classes[p.route].records) {
        VectorXcd const gain = to_inputs * to_columns(p, r);
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
        v.phasors.emplace_back(reals(first, p.inputs), reals(second, p.inputs));
        continue;
      }
      moments.gamma(p.rows, p.rows) += (first * first.adjoint() + second * second.adjoint()) / 2;
      moments.relation(p.rows, p.rows) += (first * first.transpose() + second * second.transpose()) / 2;
    }
  }

  // Among all inputs: real parts, then imaginary parts.
  std::vector<double> reals(VectorXcd const& x, std::vector<std::size_t> const& inputs) const {
    Eigen::VectorXd both(2 * x.size());
    both << x.real(), x.imag();
    return among_all(both, inputs);
  }
  std::vector<double> among_all(Eigen::VectorXd const& both, std::vector<std::size_t> const& inputs) const {
    std::vector<double> out(2 * gains_.inputs());
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      out[inputs[k]] = both(Eigen::Index(k));
      out[gains_.inputs() + inputs[k]] = both(Eigen::Index(inputs.size() + k));
    }
    return out;
  }

  NoiseBudget const& b_;
  CouplingTable const& table_;
  Interferometer const& ifo_;
  MotionDirections gains_;
  Draws draws_;
  std::vector<Part> parts_;
  std::vector<std::vector<std::size_t>> blocks_;  // inputs correlated by routes, ascending
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
    double linear = 0, of_rims = 0, others = 0;  // rims have no static phase
    for (std::size_t r = 0; r < b.routes.size(); ++r) {
      linear += b.routes[r].asd[i];
      (table.classes[r].kind == ClassKind::rim ? of_rims : others) += b.routes[r].psd(i);
    }
    bool const known = !std::isnan(b.total.asd[i]);
    std::array<double, 3> percentiles{};
    if (known && others > 0) percentiles = law.at(i);
    auto const root = [&](double psd) { return known ? std::sqrt(std::max(0.0, psd + of_rims)) : not_a_number; };
    bands.speckle_05.push_back(root(percentiles[0]));
    bands.speckle_50.push_back(root(percentiles[1]));
    bands.speckle_95.push_back(root(percentiles[2]));
    bands.coherent.push_back(known ? linear : not_a_number);
  }
}

namespace {

using Eigen::MatrixXd;

// Of Re and Im of the vector.
MatrixXd real_covariance(SpeckleMoments const& moments) {
  auto const& [gamma, relation] = moments;
  Eigen::Index const n = gamma.rows();
  MatrixXd out(2 * n, 2 * n);
  out.topLeftCorner(n, n) = 0.5 * (gamma + relation).real();
  out.bottomRightCorner(n, n) = 0.5 * (gamma - relation).real();
  out.topRightCorner(n, n) = 0.5 * (relation - gamma).imag();
  out.bottomLeftCorner(n, n) = out.topRightCorner(n, n).transpose();
  return out;
}

}  // namespace

std::vector<SpeckleMode> modes_of(std::vector<SpeckleMoments> const& blocks, bool directions) {
  std::vector<SpeckleMode> modes;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    Eigen::SelfAdjointEigenSolver<MatrixXd> const own(real_covariance(blocks[b]),
                                                      directions ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly);
    for (Eigen::Index m = own.eigenvalues().size(); m-- > 0;) {
      modes.push_back({std::max(0.0, own.eigenvalues()(m)), b, {}});
      if (directions) modes.back().direction = own.eigenvectors().col(m);
    }
  }
  std::ranges::stable_sort(modes, [](SpeckleMode const& a, SpeckleMode const& b) { return a.weight > b.weight; });
  return modes;
}

double speckle_percentile(double below) { return -std::log1p(-below); }

}  // namespace straytrace::noise
