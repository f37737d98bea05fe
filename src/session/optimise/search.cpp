// SPDX-License-Identifier: BSD-3-Clause
#include "session/optimise/search.hpp"

#include <algorithm>
#include <cmath>

namespace straytrace::session {

double Candidate::worst() const {
  double largest = -infinity;
  for (double const e : excess) largest = std::isnan(e) ? infinity : std::max(largest, e);
  return std::isnan(objective) ? infinity : largest;
}

bool better(Candidate const& a, Candidate const& b) {
  if (a.met() != b.met()) return a.met();
  if (!a.met()) return a.worst() < b.worst();
  return a.objective != b.objective ? a.objective < b.objective : a.worst() < b.worst();
}

Candidate const* SearchResult::closest() const {
  Candidate const* found = nullptr;  // of the most accurate ones
  for (Candidate const& c : all)
    if (!found || c.level > found->level || (c.level == found->level && better(c, *found))) found = &c;
  return found;
}

Candidate const* SearchResult::best() const {
  Candidate const* const found = closest();
  return found && found->met() ? found : nullptr;
}

namespace {

using Vector = Eigen::VectorXd;

constexpr double first_radius = 0.25, largest_radius = 0.5;
constexpr double first_penalty = 10, largest_penalty = 1e6;
constexpr double hidden = 0.25;                       // of the predicted gain: largest error of a difference (eq. O.10)
constexpr double accepted = 0.1, trusted = 0.75;      // of the predicted gain (eq. O.6)
constexpr double margin = 1e-6;                       // below a limit that is aimed at
constexpr double finest = 1e-5;                       // of a range: accuracy of the edges of the steps of a price
constexpr double unmeasured = 1e2;                    // excess above that of what is measured
constexpr double near_limit = 0.1, near_best = 0.05;  // of an excess; of the ranges: where multipliers are fitted
constexpr double stationary = 0.2;                    // of the slope of the objective that limits leave at an optimum
constexpr int most_steps = 40;                        // of the price that are walked along an axis

// Coordinates in which ranges are 0 to 1: logarithms where a range is above zero.
class Coordinates {
 public:
  explicit Coordinates(std::vector<SearchRange> const& ranges) : ranges_(ranges) {}
  Eigen::Index size() const { return Eigen::Index(ranges_.size()); }
  bool whole(Eigen::Index i) const { return ranges_[std::size_t(i)].whole; }

  Vector of(std::vector<double> const& x) const {
    Vector u(size());
    for (Eigen::Index i = 0; i < size(); ++i) {
      SearchRange const& r = ranges_[std::size_t(i)];
      double const v = x[std::size_t(i)];
      u[i] = logarithmic(r) ? std::log(v / r.low) / std::log(r.high / r.low) : (v - r.low) / (r.high - r.low);
    }
    return u;
  }
  double value(Vector const& u, Eigen::Index i) const {  // before whole numbers are rounded
    SearchRange const& r = ranges_[std::size_t(i)];
    double const v = logarithmic(r) ? r.low * std::pow(r.high / r.low, u[i]) : r.low + u[i] * (r.high - r.low);
    return std::clamp(v, r.low, r.high);
  }
  std::vector<double> at(Vector const& u) const {
    std::vector<double> x;
    for (Eigen::Index i = 0; i < size(); ++i) x.push_back(whole(i) ? std::round(value(u, i)) : value(u, i));
    return x;
  }
  // The nearest point beyond `from` along an axis whose values differ, at least this far; `from` at the end of a range.
  std::vector<double> beside(std::vector<double> const& from, Eigen::Index axis, double by) const {
    Vector u = of(from);
    u[axis] = std::clamp(u[axis] + by, 0.0, 1.0);
    std::vector<double> x = at(u);
    SearchRange const& r = ranges_[std::size_t(axis)];
    if (r.whole && x[std::size_t(axis)] == from[std::size_t(axis)])
      x[std::size_t(axis)] = std::clamp(from[std::size_t(axis)] + (by > 0 ? 1 : -1), r.low, r.high);
    return x;
  }

 private:
  static bool logarithmic(SearchRange const& r) { return r.low > 0; }
  std::vector<SearchRange> const& ranges_;
};

class RegionSearch {
 public:
  explicit RegionSearch(SearchProblem const& problem) : problem_(problem), coordinates_(problem.ranges) {}

  SearchResult run() {
    result_.ended = "every choice was evaluated";
    if (evaluate(problem_.start) && coordinates_.size() > 0) {
      result_.ended = approach();
      if (problem_.price)
        for (Eigen::Index i = 0; i < coordinates_.size(); ++i) coordinates_.whole(i) ? walk_whole(i) : walk_steps(i);
    }
    if (result_.stopped) result_.ended = "stopped";
    if (exhausted_) result_.ended = "no more candidates are allowed";
    if (result_.best()) result_.multipliers = multipliers(*result_.best());
    return std::move(result_);
  }

 private:
  // Its number; none when stopped or when no more evaluations are allowed.
  std::optional<std::size_t> evaluate(std::vector<double> const& x) {
    for (std::size_t i = 0; i < result_.all.size(); ++i)
      if (result_.all[i].at == x && result_.all[i].level == level_) return i;
    if (result_.stopped) return {};
    exhausted_ = result_.all.size() >= problem_.most;
    if (exhausted_) return {};
    std::optional<Candidate> found = problem_.evaluate(x, level_);
    result_.stopped = !found;
    if (!found) return {};
    found->level = level_;
    result_.all.push_back(std::move(*found));
    return result_.all.size() - 1;
  }

  bool logarithmic() const { return problem_.price && result_.all.front().objective > 0; }
  // Relative or logarithmic, so that the penalty has a meaning (eq. O.3).
  double scaled(double objective) const {
    double const first = result_.all.front().objective;
    if (!problem_.price) return objective;  // a logarithm itself
    return logarithmic() ? std::log(objective) : objective / std::max(std::fabs(first), 1e-300);
  }
  // A candidate that breaks a relation is not measured: it ranks behind all others, by what is known of it.
  double merit(Candidate const& c) const {
    if (std::isfinite(c.worst()) || c.excess.empty()) return scaled(c.objective) + penalty_ * std::max(0.0, c.worst());
    double known = 0;
    for (double const e : c.excess) known = std::isnan(e) ? known : std::max(known, e);
    return known > 0 ? penalty_ * (unmeasured + known) : infinity;
  }
  bool in_slice(Candidate const& c) const {
    return c.level == level_ && (!fixed_ || c.at[std::size_t(fixed_->axis)] == fixed_->value);
  }
  bool is_fixed(Eigen::Index axis) const { return fixed_ && fixed_->axis == axis; }
  std::size_t centre() const {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < result_.all.size(); ++i)
      if (in_slice(result_.all[i]) && (!best || merit(result_.all[i]) < merit(result_.all[*best]))) best = i;
    return best.value();
  }

  static bool others_near(Vector s, Eigen::Index axis, double radius) {
    s[axis] = 0;
    return s.lpNorm<Eigen::Infinity>() <= 2.01 * radius;
  }
  // At least one point on either side of the centre along each axis, within twice the radius.
  bool surround(double radius) {
    for (Eigen::Index axis = 0; axis < coordinates_.size(); ++axis)
      for (double const side : {-1.0, 1.0}) {
        Candidate const& middle = result_.all[centre()];
        Vector const u = coordinates_.of(middle.at);
        auto const there = [&](Candidate const& c) {
          if (c.level != level_) return false;
          Vector const s = coordinates_.of(c.at) - u;
          bool const next =
              coordinates_.whole(axis) && std::fabs(c.at[std::size_t(axis)] - middle.at[std::size_t(axis)]) == 1;
          return (next || std::fabs(s[axis]) <= 2.01 * radius) && others_near(s, axis, radius) &&
                 side * s[axis] > 0.25 * radius;
        };
        bool const at_end = side < 0 ? u[axis] <= 0 : u[axis] >= 1;
        if (at_end || is_fixed(axis) || std::any_of(result_.all.begin(), result_.all.end(), there)) continue;
        if (!evaluate(coordinates_.beside(middle.at, axis, side * radius))) return false;
      }
    return true;
  }

  // About the best point; along axes of whole numbers at least as far as their neighbours.
  Subproblem models(double radius) const {
    std::vector<double> const& middle = result_.all[centre()].at;
    Vector const u = coordinates_.of(middle);
    Vector reach = Vector::Constant(u.size(), radius);
    for (Eigen::Index i = 0; i < u.size(); ++i)
      for (double const side : {-1e-9, 1e-9})
        if (coordinates_.whole(i))
          reach[i] = std::max(reach[i], std::fabs(coordinates_.of(coordinates_.beside(middle, i, side))[i] - u[i]));
    std::vector<Vector> steps;
    std::vector<double> objective;
    std::vector<std::vector<double>> excess(result_.all.front().excess.size());
    for (Candidate const& c : result_.all) {
      Vector const s = coordinates_.of(c.at) - u;
      if (c.level != level_ || ((s.cwiseAbs() - 2.01 * reach).array() > 0).any()) continue;
      steps.push_back(s);
      objective.push_back(scaled(c.objective));
      for (std::size_t k = 0; k < excess.size(); ++k) excess[k].push_back(c.excess[k]);
    }
    Subproblem out{fitted(steps, objective, radius), {}, {}, {}, penalty_};
    for (auto const& values : excess) {
      out.limits.push_back(fitted(steps, values, radius));
      out.limits.back().value += margin + 0.1 * result_.all[centre()].sigma;
    }
    out.low = (-u).cwiseMax(-reach);
    out.high = (Vector::Ones(u.size()) - u).cwiseMin(reach);
    if (fixed_) out.low[fixed_->axis] = out.high[fixed_->axis] = 0;
    return out;
  }

  // Doubles the penalty while the step of the models breaks limits for the sake of the objective: it must take away at
  // least half of what any step in the region could (eq. O.3).
  bool raised_penalty(Subproblem model) {
    double const before = penalty_, here = model.slack(Vector::Zero(model.low.size()));
    Subproblem feasible = model;
    feasible.objective = {0, Vector::Zero(model.low.size()), 0 * model.objective.curvature};
    double const wanted = 0.5 * (here + std::min(here, feasible.slack(feasible.least()))) + 10 * margin;
    while (penalty_ < largest_penalty && model.slack(model.least()) > wanted) model.penalty = penalty_ *= 2;
    return penalty_ > before;
  }

  // The least of the models; whole numbers are rounded either way, one after the other, and the rest solved again.
  Vector step_of(Subproblem model, std::vector<double> const& middle) const {
    Vector const u = coordinates_.of(middle);
    Vector best = model.least();
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      if (!coordinates_.whole(i)) continue;
      double const relaxed = coordinates_.value(u + best, i);
      Subproblem chosen = model;
      double least = infinity;
      for (double const whole : {std::floor(relaxed), std::ceil(relaxed)}) {
        std::vector<double> x = middle;
        x[std::size_t(i)] = whole;
        Subproblem fixed = model;
        fixed.low[i] = fixed.high[i] = coordinates_.of(x)[i] - u[i];
        Vector const step = fixed.least();
        if (fixed.merit(step) >= least) continue;
        least = fixed.merit(step);
        best = step;
        chosen = fixed;
      }
      model = chosen;
    }
    return best;
  }

  // One standard error of the difference between a candidate and the one nearest to a point, by common replicas.
  double error_near(Candidate const& middle, Vector const& at) const {
    Candidate const* nearest = nullptr;
    auto const distance = [&](Candidate const& c) { return (coordinates_.of(c.at) - at).lpNorm<Eigen::Infinity>(); };
    for (Candidate const& c : result_.all)
      if (c.level == level_ && c.at != middle.at && c.deviations.size() == middle.deviations.size() &&
          (!nearest || distance(c) < distance(*nearest)))
        nearest = &c;
    double square = 0;
    for (std::size_t r = 0; nearest && r < middle.deviations.size(); ++r)
      square += std::pow(nearest->deviations[r] - middle.deviations[r], 2);
    return std::sqrt(square);
  }
  // The best candidate anew where its error hides the predicted gain; the region about it follows.
  bool refined(Candidate const& middle, Vector const& at, double predicted) {
    if (level_ + 1 >= problem_.levels || !(error_near(middle, at) > hidden * predicted)) return false;
    ++level_;
    return evaluate(middle.at).has_value();
  }

  // The trust region; why it ended.
  std::string approach() {
    int below_error = 0;
    for (double radius = first_radius; !exhausted_ && !result_.stopped;) {
      if (!surround(radius)) break;
      Candidate const middle = result_.all[centre()];
      Subproblem const model = models(radius);
      if (raised_penalty(model)) continue;  // another candidate may be the best one now
      Vector const step = step_of(model, middle.at);
      double const predicted = model.merit(Vector::Zero(step.size())) - model.merit(step);
      if (refined(middle, coordinates_.of(middle.at) + step, predicted)) continue;
      std::size_t const before = result_.all.size();
      auto const found = evaluate(coordinates_.at(coordinates_.of(middle.at) + step));
      if (!found) break;
      double const gain = merit(middle) - merit(result_.all[*found]), length = step.lpNorm<Eigen::Infinity>();
      bool const old = result_.all.size() == before;
      below_error = predicted < 0.1 * middle.sigma ? below_error + 1 : 0;
      if (old || !(gain > accepted * predicted))
        radius /= 2;
      else if (gain > trusted * predicted && length > 0.9 * radius)
        radius = std::min(2 * radius, largest_radius);
      else if (length < 0.5 * radius)
        radius = std::max(2 * length, radius / 4);
      if (radius < problem_.tolerance) return "the region is smaller than the tolerance";
      if (below_error > 1) return "the predicted gain is below the error";
    }
    return "";
  }

  // Of a whole number: the neighbours with a lower price, each with a search over the rest, while one is better.
  void walk_whole(Eigen::Index axis) {
    for (int i = 0; i < most_steps && result_.best(); ++i) {
      Candidate const here = *result_.best();
      std::vector<double> next = here.at;
      for (double const side : {-1e-9, 1e-9})
        if (auto const x = coordinates_.beside(here.at, axis, side); problem_.price(x) < problem_.price(next)) next = x;
      if (next == here.at || !evaluate(next)) return;
      fixed_ = Slice{axis, next[std::size_t(axis)]};
      approach();
      fixed_.reset();
      if (result_.best()->at == here.at) return;
    }
  }

  // Prices with steps: the last point of the step of `x` along an axis, and the first one beyond it, which is empty at
  // the end of the range.
  struct Edge {
    std::vector<double> last, beyond;
  };
  Edge edge(std::vector<double> const& x, Eigen::Index axis, double side) const {
    double const price = problem_.price(x);
    double inside = 0, outside = finest;
    auto const at = [&](double by) { return coordinates_.beside(x, axis, side * by); };
    while (problem_.price(at(outside)) == price) {
      if (outside >= 1) return {at(1), {}};
      inside = outside;
      outside = std::min(2 * outside, 1.0);
    }
    while (outside - inside > finest) {
      double const middle = 0.5 * (inside + outside);
      (problem_.price(at(middle)) == price ? inside : outside) = middle;
    }
    return {at(inside), at(outside)};
  }
  bool in_steps(std::vector<double> const& x, Eigen::Index axis) const {
    double const price = problem_.price(x);
    int changes = 0;
    for (double const by : {-2 * finest, -finest, finest, 2 * finest})
      changes += problem_.price(coordinates_.beside(x, axis, by)) != price;
    return changes <= 2;
  }

  // From the best point so far: to the point of least noise of its step, then to cheaper steps while limits are met, or
  // to dearer ones until they are.
  void walk_steps(Eigen::Index axis) {
    if (result_.stopped || result_.all.size() >= problem_.most) return;
    Candidate here = *result_.closest();
    if (!in_steps(here.at, axis)) return;
    double const side = quieter_side(here, axis);
    if (side == 0) return;
    auto const go = [&](std::vector<double> const& x) {
      auto const found = x.empty() ? std::nullopt : evaluate(x);
      if (found) here = result_.all[*found];
      return found.has_value();
    };
    if (!go(edge(here.at, axis, side).last)) return;
    bool const down = here.met();
    for (int i = 0; i < most_steps; ++i) {
      double const price = problem_.price(here.at);
      std::vector<double> const next = edge(here.at, axis, down ? -side : side).beyond;
      if (next.empty() || (down && problem_.price(next) >= price)) return;
      if (!go(down ? next : edge(next, axis, side).last) || here.met() != down) return;
    }
  }

  // Measured candidates about one of them: the nearest, and all within `reach`.
  struct Near {
    std::vector<Vector> steps;
    std::vector<Candidate const*> candidates;
    double radius = 0;
    Quadratic model(std::function<double(Candidate const&)> const& of) const {
      std::vector<double> values;
      for (Candidate const* c : candidates) values.push_back(of(*c));
      return fitted(steps, values, radius);
    }
  };
  Near around(Candidate const& here, double reach) const {
    Vector const u = coordinates_.of(here.at);
    std::vector<Candidate const*> all;
    for (Candidate const& c : result_.all)
      if (c.level == here.level && (std::isfinite(c.worst()) || c.excess.empty())) all.push_back(&c);
    auto const distance = [&](Candidate const* c) { return (coordinates_.of(c->at) - u).lpNorm<Eigen::Infinity>(); };
    std::stable_sort(all.begin(), all.end(), [&](auto* a, auto* b) { return distance(a) < distance(b); });
    Near out;
    for (Candidate const* c : all) {
      if (out.steps.size() > 2 * std::size_t(u.size()) + 3 && distance(c) > reach) break;
      out.steps.push_back(coordinates_.of(c->at) - u);
      out.candidates.push_back(c);
      out.radius = std::max(out.radius, distance(c));
    }
    return out;
  }
  // Along which the largest excess falls.
  double quieter_side(Candidate const& here, Eigen::Index axis) const {
    Near const near = around(here, 0);
    if (!(near.radius > 0)) return 0;
    double const slope = near.model([](Candidate const& c) { return c.worst(); }).slope[axis];
    return slope < 0 ? 1 : slope > 0 ? -1 : 0;
  }

  // Whether the price jumps along an axis and is constant in between.
  bool jumps(std::vector<double> const& x, Eigen::Index axis) const {
    if (!problem_.price || !in_steps(x, axis)) return false;
    std::vector<double> low = x, high = x;
    low[std::size_t(axis)] = problem_.ranges[std::size_t(axis)].low;
    high[std::size_t(axis)] = problem_.ranges[std::size_t(axis)].high;
    return problem_.price(low) != problem_.price(x) || problem_.price(high) != problem_.price(x);
  }
  // The multipliers that make the slope of the objective and those of the limits cancel along the free axes; their
  // errors are the changes by the replicas that all candidates share.
  std::vector<WithError> multipliers(Candidate const& best) const {
    std::vector<WithError> out(best.excess.size());
    std::vector<std::size_t> binding;
    for (std::size_t k = 0; k < out.size(); ++k)
      if (best.excess[k] > -near_limit) binding.push_back(k);
    auto const unknown = [&] {
      for (std::size_t const k : binding) out[k] = {not_a_number, not_a_number};
      return out;
    };
    Vector const u = coordinates_.of(best.at);
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      if (coordinates_.whole(i) || jumps(best.at, i)) return unknown();
      if (u[i] > finest && u[i] < 1 - finest) free.push_back(i);
    }
    Near const near = around(best, near_best);
    if (binding.empty() || free.empty() || !(near.radius > 0)) return unknown();
    Slopes const mean = slopes(near, binding, free, {});
    Vector const found = not_negative(mean.limits, -mean.objective);
    if ((mean.objective + mean.limits * found).norm() > stationary * mean.objective.norm()) return unknown();
    Vector square = Vector::Zero(found.size());
    std::size_t replicas = best.objective_deviations.size();
    for (auto const& of_limit : best.excess_deviations) replicas = std::max(replicas, of_limit.size());
    for (std::size_t r = 0; r < replicas; ++r) {
      Slopes const changed = slopes(near, binding, free, r);
      square += (not_negative(changed.limits, -changed.objective) - found).cwiseAbs2();
    }
    double const unit = !problem_.price ? 1 : logarithmic() ? best.objective : std::fabs(result_.all.front().objective);
    for (std::size_t k = 0; k < binding.size(); ++k)
      out[binding[k]] = {unit * found[Eigen::Index(k)], unit * std::sqrt(square[Eigen::Index(k)])};
    return out;
  }
  struct Slopes {
    Vector objective;
    Eigen::MatrixXd limits;  // [axis, limit]
  };
  // Of the models about a candidate along the free axes; with the deviations of one replica.
  Slopes slopes(Near const& near, std::vector<std::size_t> const& binding, std::vector<Eigen::Index> const& free,
                std::optional<std::size_t> replica) const {
    auto const deviation = [&](std::vector<double> const& of) {
      return replica && *replica < of.size() ? of[*replica] : 0;
    };
    Slopes out{near.model([&](Candidate const& c) { return scaled(c.objective) + deviation(c.objective_deviations); })
                   .slope(free),
               Eigen::MatrixXd(Eigen::Index(free.size()), Eigen::Index(binding.size()))};
    for (std::size_t k = 0; k < binding.size(); ++k) {
      auto const excess = [&, limit = binding[k]](Candidate const& c) {
        return c.excess[limit] + (limit < c.excess_deviations.size() ? deviation(c.excess_deviations[limit]) : 0);
      };
      out.limits.col(Eigen::Index(k)) = near.model(excess).slope(free);
    }
    return out;
  }
  // Least squares without negative numbers: the most negative one is left out until none is.
  static Vector not_negative(Eigen::MatrixXd matrix, Vector const& right) {
    for (;;) {
      Vector const x = matrix.completeOrthogonalDecomposition().solve(right);
      Eigen::Index worst = 0;
      if (x.size() == 0 || x.minCoeff(&worst) >= 0) return x;
      matrix.col(worst).setZero();
    }
  }

  SearchProblem const& problem_;
  Coordinates coordinates_;
  SearchResult result_;
  struct Slice {
    Eigen::Index axis;
    double value;
  };
  std::optional<Slice> fixed_;  // only candidates with this value
  bool exhausted_ = false;
  int level_ = 0;
  double penalty_ = first_penalty;  // on the largest excess; never lowered
};

}  // namespace

SearchResult search(SearchProblem const& problem) { return RegionSearch(problem).run(); }

}  // namespace straytrace::session
