// SPDX-License-Identifier: BSD-3-Clause
#include "wave/modes/mode_table.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
#include "beams/higher_modes.hpp"

namespace straytrace::wave {
namespace {

// The modes of one order, found from its Hermite-Gauss modes HG(N,0), HG(N-1,1), ... as starts.
struct Family {
  std::vector<RitzPair> modes;  // with the largest share in the starts, by loss
  int starts = 0;
};

using HermiteGauss = std::function<Field(int n, int m)>;

std::vector<Eigen::VectorXcd> starts_of(RoundTrip const& trip, HermiteGauss const& hermite_gauss, int order) {
  std::vector<Eigen::VectorXcd> starts;
  for (int m = 0; m <= order; ++m) starts.push_back(trip.band().pack(hermite_gauss(order - m, m)));
  return starts;
}

double loss_of(RitzPair const& pair) { return 1 - std::norm(pair.value); }

// What distinguishes eigenvalues, at the error of the losses.
double resolution(RitzPair const& pair, SolveOptions const& options) {
  return options.loss_error * std::max(loss_of(pair), 1e-9);
}

std::vector<RitzPair> modes_in(Krylov const& krylov) {
  std::vector<RitzPair> modes = krylov.ritz();
  modes.resize(std::size_t(krylov.starts()));
  std::ranges::stable_sort(modes, {}, loss_of);
  return modes;
}

bool unchanged(std::vector<RitzPair> const& now, std::vector<RitzPair> const& before, SolveOptions const& options) {
  if (before.size() != now.size()) return false;
  for (RitzPair const& pair : now) {
    double nearest = infinity;
    for (RitzPair const& other : before) nearest = std::min(nearest, std::abs(pair.value - other.value));
    if (!(nearest < std::max(0.1 * resolution(pair, options), 1e-14))) return false;
  }
  return true;
}

// Until two more round trips of each start change no eigenvalue.
Family family_of(RoundTrip const& trip, HermiteGauss const& hermite_gauss, int order, SolveOptions const& options) {
  Krylov krylov(starts_of(trip, hermite_gauss, order), trip.threads());
  Field work(trip.trip().grid);
  Family family{{}, krylov.starts()};
  int quiet = 0;
  for (int trips = 1; trips <= options.most_round_trips && quiet < 2; ++trips) {
    bool more = true;
    for (int i = 0; i < krylov.starts() && more; ++i) {
      trip.band().unpack(krylov.next(), work);
      trip.travel(work);
      more = krylov.extend(trip.band().pack(work));
    }
    std::vector<RitzPair> modes = modes_in(krylov);
    quiet = unchanged(modes, family.modes, options) ? quiet + 1 : 0;
    family.modes = std::move(modes);
    if (options.progress) options.progress(trips, family.modes.back().residual);
    if (!more) break;
  }
  std::erase_if(family.modes, [](RitzPair const& mode) { return mode.overlap * mode.overlap < 0.5; });
  return family;
}

// Numbers of modes that have one eigenvalue, one after the other in the order of their loss.
std::vector<int> alike_in(std::vector<RitzPair> const& modes, SolveOptions const& options) {
  std::vector<int> sizes;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    bool const with_last = i > 0 && std::abs(modes[i].value - modes[i - 1].value) < resolution(modes[i], options);
    if (with_last)
      ++sizes.back();
    else
      sizes.push_back(1);
  }
  return sizes;
}

// Orthonormal columns that span the modes of a group in the modes of the starts: HG(N,0), HG(N-1,1), ...
Eigen::MatrixXcd span_of(std::vector<RitzPair> const& modes, std::size_t first, int count, int starts) {
  Eigen::MatrixXcd whole(modes[first].coordinates.size(), count);
  for (int i = 0; i < count; ++i) whole.col(i) = modes[first + std::size_t(i)].coordinates;
  Eigen::MatrixXcd const span =
      Eigen::HouseholderQR<Eigen::MatrixXcd>(whole).householderQ() * Eigen::MatrixXcd::Identity(whole.rows(), count);
  return span.topRows(starts);
}

// Named modes by what they have in the span, the largest `count`.
std::vector<ModeLine::Named> largest(std::vector<ModeLine::Named> named, int count) {
  std::ranges::stable_sort(named, std::ranges::greater{}, [](auto const& n) { return std::round(1e6 * n.shared); });
  named.resize(std::size_t(count));
  return named;
}

std::vector<ModeLine::Named> hermite_shares(Eigen::MatrixXcd const& span, int order) {
  std::vector<ModeLine::Named> named;
  for (int m = 0; m <= order; ++m) named.push_back({order - m, m, span.row(m).squaredNorm()});
  return named;
}

std::vector<ModeLine::Named> laguerre_shares(Eigen::MatrixXcd const& span, int order) {
  std::vector<ModeLine::Named> named;
  for (int l = order; l >= -order; l -= 2) named.push_back({(order - std::abs(l)) / 2, l, 0});
  for (Eigen::Index i = 0; i < span.cols(); ++i) {
    beams::ModeCoefficients hermite(order);
    for (int m = 0; m <= order; ++m) hermite(order - m, m) = span(m, i);
    beams::LaguerreCoefficients const laguerre(hermite);
    for (ModeLine::Named& n : named) n.shared += std::norm(laguerre(n.one, n.two));
  }
  return named;
}

void add_lines(std::vector<ModeLine>& lines, Family const& family, int order, Complex fundamental,
               SolveOptions const& options) {
  std::size_t first = 0;
  for (int const count : alike_in(family.modes, options)) {
    Eigen::MatrixXcd const span = span_of(family.modes, first, count, family.starts);
    auto const hermite = largest(hermite_shares(span, order), count),
               laguerre = largest(laguerre_shares(span, order), count);
    for (int i = 0; i < count; ++i) {
      RitzPair const& mode = family.modes[first + std::size_t(i)];
      double const turns = std::arg(mode.value / fundamental) / (2 * pi);
      lines.push_back({order, hermite[std::size_t(i)], laguerre[std::size_t(i)], mode.overlap * mode.overlap,
                       loss_of(mode), turns, mode.residual, count});
    }
    first += std::size_t(count);
  }
}

}  // namespace

std::vector<ModeLine> mode_table(RoundTrip const& trip, HermiteGauss const& hermite_gauss, int highest_order,
                                 SolveOptions const& options) {
  std::vector<ModeLine> lines;
  Complex fundamental = 1;
  for (int order = 0; order <= highest_order; ++order) {
    Family const family = family_of(trip, hermite_gauss, order, options);
    if (order == 0 && !family.modes.empty()) fundamental = family.modes.front().value;
    add_lines(lines, family, order, fundamental, options);
  }
  return lines;
}

}  // namespace straytrace::wave
