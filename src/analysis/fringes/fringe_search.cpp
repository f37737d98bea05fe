// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/fringes/fringe_search.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <utility>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/linear_algebra.hpp"
#include "spectra/fourier.hpp"

namespace straytrace::analysis {
namespace {

std::vector<double> steps(SearchRange const& range, double step) {
  if (!range.free()) return {range.low};
  auto const n = std::max<std::size_t>(2, std::size_t(std::ceil((range.high - range.low) / step)));
  std::vector<double> values;
  for (std::size_t i = 0; i <= n; ++i) values.push_back(range.low + (range.high - range.low) * double(i) / double(n));
  return values;
}

Eigen::MatrixXd two_columns(FringeStretch const& stretch, std::vector<double> const& psd, FringeColumns const& c) {
  Eigen::VectorXd const first = stretch.whitened(c.cosine, psd);
  Eigen::MatrixXd out(first.size(), 2);
  out.col(0) = first;
  out.col(1) = stretch.whitened(c.sine, psd);
  return out;
}

// Orthonormal columns spanning the same, without the span of `others` (orthonormal).
Eigen::MatrixXd orthonormal(Eigen::MatrixXd columns, Eigen::MatrixXd const& others) {
  if (others.cols() > 0) columns -= others * (others.transpose() * columns);
  return orthonormal_columns(columns);
}

// Reduction of chi^2 by two columns for y, which is already orthogonal to the others; zero where the others nearly span
// them.
double gain_of(Eigen::MatrixXd const& columns, Eigen::MatrixXd const& others, Eigen::VectorXd const& y) {
  Eigen::Matrix2d gram = columns.transpose() * columns;
  double const whole = gram.trace();
  if (others.cols() > 0) {
    Eigen::MatrixXd const shared = others.transpose() * columns;
    gram -= shared.transpose() * shared;
  }
  if (!(gram.trace() > 0.05 * whole)) return 0;
  Eigen::Vector2d const b = columns.transpose() * y;
  return b.dot(solve_symmetric(gram, b));
}

// Of two orthonormal pairs a small step apart: the mean of their principal cosines is 1 - l^2/2.
double length_between(Eigen::MatrixXd const& a, Eigen::MatrixXd const& b) {
  Eigen::Matrix2d const m = a.transpose() * b;
  double const nuclear = std::sqrt(m.squaredNorm() + 2 * std::fabs(m.determinant()));
  return std::sqrt(std::max(0.0, 2 - nuclear));
}

// chi^2 that the columns of a path take from y at each delay, by one transform for each column: a delay turns both
// columns, which leaves their products with each other unchanged. For a single path.
class DelayScan {
 public:
  DelayScan(FringeStretch const& stretch, SearchRange const& range, double step) : n_(1) {
    std::vector<double> const& hz = stretch.hz();
    spacing_ = hz[1] - hz[0];
    first_ = hz[0];
    while (1 / (double(n_) * spacing_) > step || n_ < hz.size()) n_ *= 2;
    for (double i = std::ceil(range.low / delay(1)); i <= range.high / delay(1); ++i) places_.push_back(i);
  }

  // The best delay, and its gain.
  std::pair<double, double> best(Eigen::MatrixXd const& columns, Eigen::VectorXd const& y) {
    Eigen::Matrix2d const inverse = (columns.transpose() * columns).inverse();
    if (!inverse.allFinite()) return {0, 0};
    for (int c = 0; c < 2; ++c) {
      std::vector<std::complex<double>> lines(n_);
      for (Eigen::Index k = 0; 2 * k < y.size(); ++k)
        lines[std::size_t(k)] = std::complex<double>(columns(2 * k, c), -columns(2 * k + 1, c)) *
                                std::complex<double>(y[2 * k], y[2 * k + 1]);
      fourier_.inverse(lines, product_[c]);
    }
    std::pair<double, double> out{0, -1};
    for (double const i : places_) {
      std::complex<double> const turn = std::polar(double(n_), 2 * pi * first_ * delay(i));
      auto const at = std::size_t(i < 0 ? i + double(n_) : i);
      Eigen::Vector2d const b{(turn * product_[0][at]).real(), (turn * product_[1][at]).real()};
      if (double const gain = b.dot(inverse * b); gain > out.second) out = {delay(i), gain};
    }
    return out;
  }

 private:
  double delay(double place) const { return place / (double(n_) * spacing_); }

  std::size_t n_;
  double spacing_ = 0, first_ = 0;
  std::vector<double> places_;
  std::vector<std::complex<double>> product_[2];
  Fourier fourier_;
};

struct Hit {
  double gain;
  std::size_t multiplicity;  // step
  FringeShape shape;
  double ratio;
};

}  // namespace

double ln_chance_of(double gain, std::vector<double> const& lengths) {
  double ln = -gain / 2;
  for (double const l : lengths) ln += std::log1p(l * std::sqrt(gain / (2 * pi)));
  return ln > -1 ? std::log(-std::expm1(-std::exp(ln))) : ln;
}

Eigen::VectorXd FringeProblem::features(FringeLines const& lines) const {
  return settings.method == FitMethod::time ? stretch.whitened_samples(lines, psd) : stretch.whitened(lines, psd);
}

Eigen::MatrixXd FringeProblem::columns(FringePlace const& place) const {
  Eigen::MatrixXd out;
  for (std::size_t p = 0; p < place.shapes.size(); ++p) {
    FringeColumns const c = stretch.columns(responses[p], place.shapes[p], place.ratio);
    Eigen::VectorXd const first = features(c.cosine);
    if (p == 0) out.resize(first.size(), 2 * Eigen::Index(place.shapes.size()));
    out.col(2 * Eigen::Index(p)) = first;
    out.col(2 * Eigen::Index(p) + 1) = features(c.sine);
  }
  return out;
}

FringeLines FringeProblem::model(FringePlace const& place, Eigen::VectorXd const& linear) const {
  FringeLines sum = FringeLines::Zero(stretch.target().size());
  for (std::size_t p = 0; p < place.shapes.size(); ++p) {
    FringeColumns const c = stretch.columns(responses[p], place.shapes[p], place.ratio);
    sum += linear[2 * Eigen::Index(p)] * c.cosine + linear[2 * Eigen::Index(p) + 1] * c.sine;
  }
  return sum;
}

LinearFit linear_fit(Eigen::MatrixXd const& columns, Eigen::VectorXd const& target) {
  LinearFit out;
  out.linear = linear_least_squares(columns, target);
  out.chi2 = (target - columns * out.linear).squaredNorm();
  return out;
}

double SearchGrid::transforms() const {
  return double(multiplicity.size()) * double(drift.size()) * double(ratio.size());
}

SearchGrid search_grid(FringeStretch const& stretch, FringeFitSettings const& s, std::size_t path, double ratio) {
  FringePath const& p = s.paths[path];
  double const k2 = 4 * pi / s.wavelength, largest = std::max(std::fabs(p.multiplicity.low), p.multiplicity.high);
  SearchGrid grid;
  // The ratio is common to all paths: the first scan settles it, the refinement moves it afterwards.
  bool const ratios = path == 0 && s.ratio.free();
  double span = stretch.span(ratio);
  if (ratios) {
    double const second = (stretch.span(1) + stretch.span(0));  // at least the span of the second body
    grid.ratio = steps(s.ratio, 1 / (k2 * largest * second));
    span = std::max(stretch.span(s.ratio.low), stretch.span(s.ratio.high));
  } else {
    grid.ratio = {ratio};
  }
  grid.multiplicity = steps(p.multiplicity, 1 / (k2 * std::max(span, 1e-30)));
  grid.delay = steps(p.delay, 1 / (8 * s.high));
  grid.drift = steps(p.drift, 1.5 / stretch.duration());
  return grid;
}

std::vector<FringePlace> scan(FringeProblem const& problem, FringePlace const& others, std::size_t path,
                              std::size_t most) {
  FringeStretch const& stretch = problem.stretch;
  SearchGrid const grid = search_grid(stretch, problem.settings, path, others.ratio);
  Eigen::MatrixXd fixed;
  Eigen::VectorXd y = stretch.whitened(stretch.target(), problem.psd);
  if (!others.shapes.empty()) {
    Eigen::MatrixXd all(y.size(), 2 * Eigen::Index(others.shapes.size()));
    for (std::size_t p = 0; p < others.shapes.size(); ++p)
      all.middleCols(2 * Eigen::Index(p), 2) =
          two_columns(stretch, problem.psd, stretch.columns(problem.responses[p], others.shapes[p], others.ratio));
    fixed = orthonormal(all, Eigen::MatrixXd(y.size(), 0));
    y -= fixed * (fixed.transpose() * y);
  }
  std::optional<DelayScan> alone;
  if (fixed.cols() == 0 && grid.delay.size() > 1)
    alone.emplace(stretch, problem.settings.paths[path].delay, grid.delay[1] - grid.delay[0]);
  std::vector<Hit> best(grid.multiplicity.size(), Hit{-1, 0, {}, 0});  // of each multiplicity
  for (double const ratio : grid.ratio)
    for (double const drift : grid.drift)
      for (std::size_t w = 0; w < grid.multiplicity.size(); ++w) {
        FringeColumns const columns = stretch.columns(problem.responses[path], {grid.multiplicity[w], 0, drift}, ratio);
        if (alone) {
          auto const [delay, gain] = alone->best(two_columns(stretch, problem.psd, columns), y);
          if (gain > best[w].gain) best[w] = {gain, w, {grid.multiplicity[w], delay, drift}, ratio};
          continue;
        }
        for (double const delay : grid.delay) {
          double const gain = gain_of(
              two_columns(stretch, problem.psd, delay == 0 ? columns : stretch.delayed(columns, delay)), fixed, y);
          if (gain > best[w].gain) best[w] = {gain, w, {grid.multiplicity[w], delay, drift}, ratio};
        }
      }
  std::stable_sort(best.begin(), best.end(), [](Hit const& a, Hit const& b) { return a.gain > b.gain; });
  std::vector<FringePlace> places;
  std::vector<std::size_t> taken;
  for (Hit const& b : best) {
    bool const beside = std::any_of(taken.begin(), taken.end(), [&](std::size_t w) {
      return w > b.multiplicity ? w - b.multiplicity < 2 : b.multiplicity - w < 2;
    });
    if (beside) continue;
    taken.push_back(b.multiplicity);
    FringePlace place = others;
    place.shapes.push_back(b.shape);
    place.ratio = b.ratio;
    places.push_back(place);
    if (places.size() == most) break;
  }
  return places;
}

std::vector<double> range_lengths(FringeProblem const& problem, FringePlace const& place, std::size_t path) {
  FringeStretch const& stretch = problem.stretch;
  SearchGrid const grid = search_grid(stretch, problem.settings, path, place.ratio);
  auto const basis = [&](FringeShape const& shape, double ratio) {
    return orthonormal(two_columns(stretch, problem.psd, stretch.columns(problem.responses[path], shape, ratio)),
                       Eigen::MatrixXd(0, 0));
  };
  std::vector<double> lengths;
  // A quarter of a step at up to 8 places along each range.
  auto const along = [&](std::vector<double> const& values, auto const& at) {
    if (values.size() < 2) return;
    double const step = values[1] - values[0];
    std::size_t const places = std::min<std::size_t>(8, values.size() - 1);
    double sum = 0;
    for (std::size_t i = 0; i < places; ++i) {
      double const v = values[i * (values.size() - 1) / places];
      sum += length_between(at(v), at(v + step / 4)) / (step / 4);
    }
    lengths.push_back(sum / double(places) * (values.back() - values.front()));
  };
  FringeShape const& here = place.shapes[path];
  along(grid.multiplicity, [&](double v) { return basis({v, here.delay, here.drift}, place.ratio); });
  along(grid.delay, [&](double v) { return basis({here.multiplicity, v, here.drift}, place.ratio); });
  along(grid.drift, [&](double v) { return basis({here.multiplicity, here.delay, v}, place.ratio); });
  along(grid.ratio, [&](double v) { return basis(here, v); });
  return lengths;
}

namespace {

using Kind = FreeParameter::Kind;

constexpr std::size_t candidates = 3;  // of a scan, refined

// A step that turns the phase by about a milliradian somewhere.
double small_step(FringeProblem const& problem, FringePlace const& place, FreeParameter const& p) {
  double const k2 = 4 * pi / problem.settings.wavelength, turn = 1e-3;
  double const span = std::max(problem.stretch.span(place.ratio), 1e-30);
  switch (p.kind) {
    case Kind::multiplicity:
      return turn / (k2 * span);
    case Kind::delay:
      return turn / (2 * pi * problem.settings.high);
    case Kind::drift:
      return turn / problem.stretch.duration();
    case Kind::ratio:
      break;
  }
  double largest = 1e-3;
  for (FringeShape const& s : place.shapes) largest = std::max(largest, std::fabs(s.multiplicity));
  return turn / (k2 * largest * (problem.stretch.span(0) + problem.stretch.span(1)));
}

// Moves the free ones by `step`, inside their ranges.
FringePlace moved(FringeProblem const& problem, FringePlace place, std::vector<FreeParameter> const& free,
                  Eigen::VectorXd const& step) {
  for (std::size_t i = 0; i < free.size(); ++i) {
    SearchRange const& range = range_of(problem.settings, free[i]);
    double& v = value_of(place, free[i]);
    v = std::clamp(v + step[Eigen::Index(i)], range.low, range.high);
  }
  return place;
}

// Noise level from the residuals, which lack one degree of freedom for each parameter.
void learn_noise(FringeProblem& problem, RefinedFit const& fit) {
  problem.psd = problem.stretch.psd(problem.stretch.target() - problem.model(fit.place, fit.fit.linear));
  double const degrees = problem.stretch.degrees();
  for (double& s : problem.psd) s *= degrees / (degrees - double(fit.covariance.rows()));
}

bool at_end(SearchRange const& r, double value) {
  return r.free() && (value - r.low < 1e-6 * (r.high - r.low) || r.high - value < 1e-6 * (r.high - r.low));
}

}  // namespace

std::vector<FreeParameter> free_parameters(FringeFitSettings const& s, std::size_t paths) {
  std::vector<FreeParameter> free;
  for (std::size_t p = 0; p < paths; ++p) {
    if (s.paths[p].multiplicity.free()) free.push_back({Kind::multiplicity, p});
    if (s.paths[p].delay.free()) free.push_back({Kind::delay, p});
    if (s.paths[p].drift.free()) free.push_back({Kind::drift, p});
  }
  if (s.ratio.free()) free.push_back({Kind::ratio, 0});
  return free;
}

double& value_of(FringePlace& place, FreeParameter const& p) {
  if (p.kind == Kind::ratio) return place.ratio;
  FringeShape& shape = place.shapes[p.path];
  return p.kind == Kind::multiplicity ? shape.multiplicity : p.kind == Kind::delay ? shape.delay : shape.drift;
}

SearchRange const& range_of(FringeFitSettings const& s, FreeParameter const& p) {
  if (p.kind == Kind::ratio) return s.ratio;
  FringePath const& path = s.paths[p.path];
  return p.kind == Kind::multiplicity ? path.multiplicity : p.kind == Kind::delay ? path.delay : path.drift;
}

Eigen::MatrixXd jacobian(FringeProblem const& problem, FringePlace const& place, Eigen::VectorXd const& linear) {
  std::vector<FreeParameter> const free = free_parameters(problem.settings, place.shapes.size());
  Eigen::MatrixXd const columns = problem.columns(place);
  Eigen::MatrixXd out(columns.rows(), columns.cols() + Eigen::Index(free.size()));
  out.leftCols(columns.cols()) = columns;
  for (std::size_t i = 0; i < free.size(); ++i) {
    double const step = small_step(problem, place, free[i]);
    FringePlace up = place, down = place;
    value_of(up, free[i]) += step;
    value_of(down, free[i]) -= step;
    out.col(columns.cols() + Eigen::Index(i)) =
        (problem.features(problem.model(up, linear)) - problem.features(problem.model(down, linear))) / (2 * step);
  }
  return out;
}

namespace {

// Residual after the best linear parameters, as a function of the steps of the free ones. Derivatives after Kaufman
// (1975): those of the model at fixed linear parameters, less their projection on the columns.
LeastSquaresProblem shape_problem(FringeProblem const& problem, FringePlace const& from,
                                  std::vector<FreeParameter> const& free, Eigen::VectorXd const& target) {
  auto const count = Eigen::Index(free.size());
  auto const residuals = [&problem, &target](FringePlace const& place, Eigen::VectorXd& out) {
    Eigen::MatrixXd const columns = problem.columns(place);
    LinearFit const fit = linear_fit(columns, target);
    out = target - columns * fit.linear;
    return fit;
  };
  return {count, target.size(),
          [&, residuals](Eigen::VectorXd const& steps, Eigen::VectorXd& out) {
            residuals(moved(problem, from, free, steps), out);
          },
          [&, residuals, count](Eigen::VectorXd const& steps, Eigen::MatrixXd& out) {
            FringePlace place = moved(problem, from, free, steps);
            Eigen::VectorXd left;
            LinearFit const fit = residuals(place, left);
            Eigen::MatrixXd const slope = jacobian(problem, place, fit.linear);
            auto const columns = slope.leftCols(fit.linear.size());
            Eigen::MatrixXd const moves = slope.rightCols(count);
            out = columns * linear_least_squares(columns, moves) - moves;
            for (Eigen::Index i = 0; i < count; ++i) {  // no step out of a range
              FreeParameter const& p = free[std::size_t(i)];
              SearchRange const& range = range_of(problem.settings, p);
              double const value = value_of(place, p), downhill = -out.col(i).dot(left);
              if ((value >= range.high && downhill > 0) || (value <= range.low && downhill < 0)) out.col(i).setZero();
            }
          }};
}

}  // namespace

RefinedFit refine(FringeProblem const& problem, FringePlace const& from) {
  std::vector<FreeParameter> const free = free_parameters(problem.settings, from.shapes.size());
  Eigen::VectorXd const target = problem.features(problem.stretch.target());
  RefinedFit out{from, {}, {}};
  out.fit = linear_fit(problem.columns(from), target);
  if (!free.empty()) {
    out.place = moved(problem, from, free,
                      minimise(shape_problem(problem, from, free, target),
                               Eigen::VectorXd::Zero(Eigen::Index(free.size())), 200, 1e-10)
                          .at);
    out.fit = linear_fit(problem.columns(out.place), target);
  }
  Eigen::MatrixXd const slope = jacobian(problem, out.place, out.fit.linear);
  Eigen::MatrixXd const curvature = slope.transpose() * slope;
  // Scaled, so that parameters of very different size invert well.
  Eigen::VectorXd const scale = curvature.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  Eigen::MatrixXd const unit = scale.asDiagonal() * curvature * scale.asDiagonal();
  auto const inverted = inverse_regular(unit);
  if (!inverted || !unit.allFinite())
    throw NumericalError("the parameters of the fit are degenerate; fix some of them");
  out.covariance = scale.asDiagonal() * *inverted * scale.asDiagonal();
  return out;
}

RefinedFit fit_all(FringeProblem& problem) {
  RefinedFit best;
  FringePlace place{{}, problem.settings.ratio.low};
  for (std::size_t p = 0; p < problem.settings.paths.size(); ++p) {
    best.fit.chi2 = infinity;
    for (FringePlace const& from : scan(problem, place, p, candidates))
      if (RefinedFit const fit = refine(problem, from); fit.fit.chi2 < best.fit.chi2) best = fit;
    for (int i = 0; i < 2; ++i) {
      learn_noise(problem, best);
      best = refine(problem, best.place);
    }
    place = best.place;
  }
  return best;
}

// Amplitude and phase instead of cosine and sine; then the free ones.
void report_parameters(FringeFit& out, FringeProblem const& problem, RefinedFit const& fit) {
  auto const free = free_parameters(problem.settings, fit.place.shapes.size());
  std::size_t const paths = fit.place.shapes.size(), n = 2 * paths + free.size();
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(Eigen::Index(n), Eigen::Index(n));
  out.paths.resize(paths);
  for (std::size_t p = 0; p < paths; ++p) {
    auto const i = Eigen::Index(2 * p);
    double const a = fit.fit.linear[i], b = fit.fit.linear[i + 1], r = std::hypot(a, b);
    turn.block<2, 2>(i, i) << a / r, b / r, -b / (r * r), a / (r * r);
    FringeShape const& shape = fit.place.shapes[p];
    out.paths[p] = {problem.settings.paths[p].name,
                    {r},
                    {std::atan2(b, a)},
                    {shape.multiplicity},
                    {shape.delay},
                    {shape.drift},
                    0,
                    0};
    out.names.push_back(fmt::format("amplitude {}", p + 1));
    out.names.push_back(fmt::format("phase {}", p + 1));
  }
  out.ratio = {fit.place.ratio};
  Eigen::MatrixXd const covariance = turn * fit.covariance * turn.transpose();
  std::vector<Fitted*> all;
  for (FittedPath& p : out.paths) all.insert(all.end(), {&p.amplitude, &p.phase});
  for (FreeParameter const& f : free) {
    FittedPath& p = out.paths[f.path];
    bool const ratio = f.kind == FreeParameter::Kind::ratio;
    bool const w = f.kind == FreeParameter::Kind::multiplicity, d = f.kind == FreeParameter::Kind::delay;
    all.push_back(ratio ? &out.ratio : w ? &p.multiplicity : d ? &p.delay : &p.drift);
    all.back()->at_end = at_end(range_of(problem.settings, f), all.back()->value);
    std::string const name = w ? "multiplicity" : d ? "delay" : "drift";
    out.names.push_back(ratio ? "ratio" : fmt::format("{} {}", name, f.path + 1));
  }
  for (Eigen::Index i = 0; i < Eigen::Index(n); ++i) {
    all[std::size_t(i)]->sigma = std::sqrt(covariance(i, i));
    for (Eigen::Index j = 0; j < Eigen::Index(n); ++j)
      out.correlation.push_back(covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j)));
  }
}

}  // namespace straytrace::analysis
