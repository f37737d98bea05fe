// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/speckle_band.hpp"

#include <Eigen/Sparse>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/math/constants.hpp"
#include "base/math/distributions.hpp"
#include "base/math/linear_algebra.hpp"
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
      normal_[d][i] = std::sqrt(2.0) * inverse_erf(2 * std::clamp(u, 1e-9, 1 - 1e-9) - 1);
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

std::array<double, 3> Draws::percentiles(std::vector<double> weights, int copies, double rest) const {
  std::ranges::sort(weights, std::greater<>());
  double constant = copies * rest;
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
  std::vector<double> values(count, copies * v.rest);
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

using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Complex = std::complex<double>;

// Gaussian amplitudes of many inputs, decomposed into independent parts (docs/theory/spectra.md).

// Second moments of the complex amplitudes of the inputs of one block: E H H^+ and E H H^T, as sums of their elements.
// Routes correlate inputs; inputs of different blocks are uncorrelated.
struct Moments {
  std::vector<Eigen::Triplet<Complex>> gamma, relation;
  void add(Eigen::Index row, Eigen::Index column, Complex of_gamma, Complex of_relation) {
    gamma.emplace_back(int(row), int(column), of_gamma);
    relation.emplace_back(int(row), int(column), of_relation);
  }
};

using Sparse = Eigen::SparseMatrix<double>;

// Of real and imaginary parts of the amplitudes of n inputs.
Sparse real_covariance(Moments const& moments, Eigen::Index n) {
  std::vector<Eigen::Triplet<double>> elements;
  int const shift = int(n);
  for (auto const& t : moments.gamma) {
    elements.emplace_back(t.row(), t.col(), 0.5 * t.value().real());
    elements.emplace_back(t.row() + shift, t.col() + shift, 0.5 * t.value().real());
    elements.emplace_back(t.row(), t.col() + shift, -0.5 * t.value().imag());
    elements.emplace_back(t.col() + shift, t.row(), -0.5 * t.value().imag());
  }
  for (auto const& t : moments.relation) {
    elements.emplace_back(t.row(), t.col(), 0.5 * t.value().real());
    elements.emplace_back(t.row() + shift, t.col() + shift, -0.5 * t.value().real());
    elements.emplace_back(t.row(), t.col() + shift, 0.5 * t.value().imag());
    elements.emplace_back(t.col() + shift, t.row(), 0.5 * t.value().imag());
  }
  Sparse covariance(2 * n, 2 * n);
  covariance.setFromTriplets(elements.begin(), elements.end());
  return covariance;
}

// An independent part of the vector of one block: its variance, and its unit direction, real parts before imaginary
// parts.
struct SpeckleMode {
  double weight;
  std::size_t block;
  Eigen::VectorXd direction;
};
// The largest first. Without directions, which take most of the time, those of the modes are empty.
struct SpeckleModes {
  std::vector<SpeckleMode> modes;
  double rest = 0;  // variance of all other parts together
};

// Orthonormal columns that hold the directions of the largest variances: a block Krylov space. It costs as much as the
// matrix has elements, where a decomposition of all costs the cube of its rows.
MatrixXd leading_space(Sparse const& covariance) {
  constexpr Eigen::Index width = 8, depth = 12;
  MatrixXd basis(covariance.rows(), width * depth), block(covariance.rows(), width);
  for (Eigen::Index d = 0; d < width; ++d)
    for (Eigen::Index i = 0; i < block.rows(); ++i)
      block(i, d) = std::fmod(0.5 + double(i + 1) * step(int(d)), 1.0) - 0.5;
  for (Eigen::Index k = 0; k < depth; ++k) {
    auto const before = basis.leftCols(k * width);
    for (int pass = 0; pass < 2; ++pass) {  // the second for blocks that lie in `before`, which leave rounding only
      block -= before * (before.transpose() * block);
      block = orthonormal_columns(block);
    }
    basis.middleCols(k * width, width) = block;
    block = covariance * block;
  }
  return basis;
}

// Percentiles need the largest 24 variances (Draws::most) and the sum of the others.
SpeckleModes modes_of(std::vector<Moments> const& blocks, std::vector<Eigen::Index> const& inputs, bool directions) {
  constexpr Eigen::Index most_rows = 256;  // of matrices that are decomposed completely
  SpeckleModes all;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    Sparse const covariance = real_covariance(blocks[b], inputs[b]);
    bool const small = covariance.rows() <= most_rows;
    MatrixXd const space = small ? MatrixXd() : leading_space(covariance);
    MatrixXd const matrix = small ? MatrixXd(covariance) : MatrixXd(space.transpose() * (covariance * space));
    SymmetricModes own;
    if (directions)
      own = symmetric_modes(matrix);
    else
      own.values = symmetric_eigenvalues(matrix);
    double const total = covariance.diagonal().sum();
    for (Eigen::Index m = own.values.size(); m-- > 0;) {
      all.modes.push_back({std::max(0.0, own.values(m)), b, {}});
      if (!directions) continue;
      all.modes.back().direction = own.vectors.col(m);
      if (!small) all.modes.back().direction = space * all.modes.back().direction;
    }
    if (!small) all.rest += std::max(0.0, total - own.values.sum());
  }
  std::ranges::stable_sort(all.modes, [](SpeckleMode const& a, SpeckleMode const& b) { return a.weight > b.weight; });
  return all;
}

constexpr std::size_t few = 8;  // paths of a computed route that are taken one by one

// One route as complex amplitudes per input of the motion, only of inputs that move it.
struct Part {
  std::size_t route;
  std::vector<std::size_t> columns, inputs;  // ascending
  std::size_t block = 0;                     // of inputs
  std::vector<Eigen::Index> rows;            // where its inputs are in the block
  std::vector<Eigen::Index> input_of;        // column: place of its input
  Sparse directions;                         // second moments of its gains to columns, weighted by power
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
    std::vector<Moments> moments(blocks_.size());
    std::vector<Eigen::Index> sizes;
    for (auto const& block : blocks_) sizes.push_back(Eigen::Index(block.size()));
    RandomVector v;
    Metrics const metrics{gains_.to_inputs(b_.grid, bin, false), gains_.to_inputs(b_.grid, bin, true)};
    for (Part const& p : parts_)
      if (!p.inputs.empty()) add(p, bin, metrics, moments[p.block], v);
    auto const copies = std::max(1, int(std::lround(copies_)));
    auto const [modes, rest] = modes_of(moments, sizes, !v.phasors.empty());
    if (v.phasors.empty()) {
      std::vector<double> weights;
      for (SpeckleMode const& m : modes) weights.push_back(m.weight / copies);
      return draws_.percentiles(weights, copies, rest / copies);
    }
    v.rest = rest / copies;
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
    Part p{r, {}, {}, 0, {}, {}, {}, {}, 0, b_.routes[r].mean_square_phase, c.adds_fields()};
    std::set<std::size_t> columns, inputs;
    for (PathRecord const& record : c.records)
      for (auto const& [column, gain] : gains_.of(record.phase_sensitivities)) columns.insert(column);
    for (std::size_t const column : columns) inputs.insert(gains_.input(column));
    p.columns.assign(columns.begin(), columns.end());
    p.inputs.assign(inputs.begin(), inputs.end());
    for (std::size_t const column : p.columns) p.input_of.push_back(place(p.inputs, gains_.input(column)));
    double weight = 0, tones = 0;
    std::vector<Eigen::Triplet<double>> elements;
    for (PathRecord const& record : c.records) {
      auto const gains = gains_.of(record.phase_sensitivities);
      for (auto const& [one, g] : gains)
        for (auto const& [other, h] : gains)
          elements.emplace_back(int(place(p.columns, one)), int(place(p.columns, other)), record.weight * g * h);
      weight += record.weight;
    }
    p.directions.resize(Eigen::Index(columns.size()), Eigen::Index(columns.size()));
    p.directions.setFromTriplets(elements.begin(), elements.end());
    bool drifts = false;
    for (std::size_t k = 0; k < p.columns.size(); ++k) {
      double const square = p.directions.coeff(Eigen::Index(k), Eigen::Index(k));
      if (gains_.tone(p.columns[k])) tones += 0.5 * square;
      drifts |= gains_.drifts(p.columns[k]) && square > 0;
    }
    if (weight > 0) tones /= weight;
    p.surviving = surviving_phase(std::max(0.0, p.mean_square - tones), tones, drifts);
    if (c.deterministic() && c.records.size() <= few && !p.family)
      for (std::size_t i = 0; i < c.records.size(); ++i) p.records.push_back(i);
    return p;
  }

  // The gains of a path to the inputs of its part.
  VectorXcd to_inputs(Part const& p, std::vector<Complex> const& factors, PathRecord const& record) const {
    VectorXcd out = VectorXcd::Zero(Eigen::Index(p.inputs.size()));
    for (auto const& [column, gain] : gains_.of(record.phase_sensitivities))
      out[place(p.inputs, gains_.input(column))] += factors[column] * gain;
    return out;
  }
  // Calls see(i, k, both, product) for pairs of inputs, whose second moments are the sums of g_i g_k^* and of g_i g_k.
  template <class See>
  static void each_moment(Part const& p, std::vector<Complex> const& factors, See const& see) {
    for (Eigen::Index k = 0; k < p.directions.outerSize(); ++k)
      for (Sparse::InnerIterator at(p.directions, k); at; ++at) {
        Complex const one = factors[p.columns[std::size_t(at.row())]], other = factors[p.columns[std::size_t(k)]];
        see(p.input_of[std::size_t(at.row())], p.input_of[std::size_t(k)], one * std::conj(other) * at.value(),
            one * other * at.value());
      }
  }
  static double power(Part const& p, std::vector<Complex> const& factors) {
    double trace = 0;
    each_moment(p, factors, [&](Eigen::Index i, Eigen::Index k, Complex both, Complex) {
      if (i == k) trace += both.real();
    });
    return trace;
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

  void add(Part const& p, std::size_t bin, Metrics const& metrics, Moments& moments, RandomVector& v) const {
    double const psd = b_.routes[p.route].psd(bin);
    if (!(psd > 0)) return;
    bool const wraps = p.mean_square > 1 || !(power(p, metrics.in_bin) > 0);
    std::vector<Complex> const& factors = wraps ? metrics.everywhere : metrics.in_bin;
    double const trace = power(p, factors);
    if (!(trace > 0)) return;
    Complex const share = relation_of(p, bin);
    if (p.family) return add_family(p, psd, share, factors, moments, v);
    if (p.records.empty() || v.phasors.size() + p.records.size() > few) {
      each_moment(p, factors, [&](Eigen::Index i, Eigen::Index k, Complex both, Complex product) {
        moments.add(p.rows[std::size_t(i)], p.rows[std::size_t(k)], psd / trace * both, psd / trace * share * product);
      });
      return;
    }
    auto const [phase, amplitude] = quadratures(share);
    for (std::size_t const i : p.records) {
      PathRecord const& record = table_.classes[p.route].records[i];
      VectorXcd const direction = std::sqrt(psd / trace * record.weight) * to_inputs(p, factors, record);
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
  void add_family(Part const& p, double psd, Complex share, std::vector<Complex> const& factors, Moments& moments,
                  RandomVector& v) const {
    auto const [phase, amplitude] = quadratures(share);
    std::vector<std::pair<VectorXcd, VectorXcd>> states;
    double mean = 0;
    for (std::size_t const state : {0, 1}) {
      VectorXcd first = VectorXcd::Zero(Eigen::Index(p.inputs.size())), second = first;
      for (PathRecord const& r : table_.classes[p.route].records) {
        VectorXcd const gain = to_inputs(p, factors, r);
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
      for (std::size_t i = 0; i < p.rows.size(); ++i)
        for (std::size_t k = 0; k < p.rows.size(); ++k) {
          auto const at = [](VectorXcd const& x, std::size_t j) { return x(Eigen::Index(j)); };
          moments.add(p.rows[i], p.rows[k],
                      (at(first, i) * std::conj(at(first, k)) + at(second, i) * std::conj(at(second, k))) / 2.0,
                      (at(first, i) * at(first, k) + at(second, i) * at(second, k)) / 2.0);
        }
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

double speckle_percentile(double below) { return -std::log1p(-below); }

}  // namespace straytrace::noise
