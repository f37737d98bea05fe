// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/mode_bases.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>

#include "base/errors.hpp"
#include "ifo/modes/mode_coupling.hpp"
#include "ifo/network_ways.hpp"

namespace straytrace::ifo {
namespace {

using Component = Network::Component;
using Complex = std::complex<double>;

constexpr double same_curvature = 1e-9;  // of two bases, relative: rounding of the carried one

Complex flown(Complex q, double length) { return q / (1.0 + length * q); }
BeamCurvature flown(BeamCurvature const& q, double length) { return {flown(q[0], length), flown(q[1], length)}; }
BeamCurvature reversed(BeamCurvature const& q) { return {-std::conj(q[0]), -std::conj(q[1])}; }

// What a component takes from 1/RoC of the light on its way, along x and y: twice the curvature of a mirror, over and
// times the cosine of incidence along x and y; 1/f of a lens.
std::array<double, 2> focusing(Component const& c, std::uint32_t out, std::uint32_t in) {
  if (auto const* lens = std::get_if<LensParameters>(&c.stated))
    return {1 / lens->focal_length, 1 / lens->focal_length};
  if (!c.reflects(out, in)) return {0, 0};
  auto const& p = std::get<MirrorParameters>(c.stated);
  double const cosine = std::cos(p.incidence), side = in < c.ports / 2 ? 1 : -1;
  return {side * 2 * p.curvature / cosine, side * 2 * p.curvature_across.value_or(p.curvature) * cosine};
}

struct RayMatrix2 {
  double a = 1, b = 0, c = 0, d = 1;  // of offset and slope
  void fly(double length) { a += length * c, b += length * d; }
  void focus(double power) { c -= power * a, d -= power * b; }
};

// The shortest cavity with all these components.
NetworkCavity find_cavity(std::vector<NetworkCavity> const& all, Network const& n,
                          std::vector<std::string> const& names) {
  for (NetworkCavity const& c : all) {
    auto const meets = [&](std::string const& name) {
      return std::ranges::any_of(c.beams, [&](std::uint32_t b) { return n.name(n.owner_of(b)) == name; });
    };
    if (std::ranges::all_of(names, meets)) return c;
  }
  throw ModeError(fmt::format("the network has no cavity with {}", fmt::join(names, ", ")),
                  fmt::format("it has: {}", fmt::join(all | std::views::transform(&NetworkCavity::name), ", ")));
}

std::vector<CavityMode> chosen(Network const& n, ModeSettings const& settings) {
  std::vector<NetworkCavity> all = cavities_of(n), used;
  for (auto const& names : settings.cavities) used.push_back(find_cavity(all, n, names));
  if (settings.cavities.empty()) {
    used = std::move(all);
    std::ranges::stable_sort(used, std::greater{}, &NetworkCavity::finesse);
  }
  std::vector<CavityMode> modes;
  for (NetworkCavity const& c : used) modes.push_back(mode_of(n, c));
  return modes;
}

// Gives every beam of a network a curvature.
class Tracer {
 public:
  explicit Tracer(Network const& n)
      : network_(n),
        other_(neighbours(n)),
        known_(n.ports(), false),
        leaving_(n.ports(), BeamCurvature{i_unit, i_unit}) {}

  // Beams of the cavity that have no curvature yet. Returns whether there was one.
  bool begin_in(CavityMode const& mode) {
    bool new_beam = false;
    BeamCurvature q = mode.curvature;
    for (std::uint32_t const port : mode.cavity.beams) {
      auto const [end, space] = other_[port];
      if (!known_[port]) {
        require_stable(mode);
        assign(port, q);
        new_beam = true;
      }
      Component const& c = network_.at(network_.owner_of(end));
      std::uint32_t const next = next_beam(mode.cavity, port);
      q = through(c, next - c.first_port, end - c.first_port, flown(q, network_.spaces()[space].length));
    }
    return new_beam;
  }
  // The mode of a laser, as far as the next mirrors that transmit: there the bases of cavities begin.
  void carry_from_lasers() {
    std::vector<std::uint32_t> const of_cavities = std::exchange(waiting_, {});
    for (Component const& c : network_.components())
      if (auto const* p = std::get_if<LaserParameters>(&c.stated); p && p->mode) begin_at(c.first_port, *p->mode);
    std::vector<std::uint32_t> ends;
    for (std::size_t i = 0; i < waiting_.size(); ++i)
      if (network_.at(network_.owner_of(waiting_[i])).kind == Component::Kind::mirror)
        ends.push_back(waiting_[i]);
      else
        carry(waiting_[i]);
    waiting_ = of_cavities;
    waiting_.insert(waiting_.end(), ends.begin(), ends.end());
  }
  // Through all components, to the ends of the network.
  void carry_on() {
    for (std::size_t i = 0; i < waiting_.size(); ++i) carry(waiting_[i]);
    waiting_.clear();
  }
  std::vector<BeamCurvature> finished() {
    for (std::uint32_t p = 0; p < network_.ports(); ++p)
      if (!known_[p] && other_[p].first != network_.ports())
        throw ModeError(fmt::format("no cavity gives a mode to the beam at '{}'", network_.port_name(p)),
                        "state curvatures of mirrors, or the mode of the laser");
    return std::move(leaving_);
  }

 private:
  void begin_at(std::uint32_t laser, LaserMode const& m) {
    if (known_[laser]) return;
    Complex const q(m.curvature, network_.wavelength() / (pi * m.radius * m.radius));
    assign(laser, {q, q});
  }
  void carry(std::uint32_t port) {
    Component const& c = network_.at(network_.owner_of(port));
    Eigen::MatrixXcd const s = network_.scattering(c, 0);
    std::uint32_t const in = port - c.first_port;
    for (std::uint32_t out = 0; out < c.ports; ++out)
      if (s(out, in) != 0.0 && !known_[c.first_port + out])
        assign(c.first_port + out, through(c, out, in, reversed(leaving_[port])));
  }
  static std::uint32_t next_beam(NetworkCavity const& c, std::uint32_t port) {
    auto const at = std::ranges::find(c.beams, port);
    return std::next(at) == c.beams.end() ? c.beams.front() : *std::next(at);
  }
  static void require_stable(CavityMode const& mode) {
    if (mode.stable()) return;
    throw ModeError(fmt::format("the cavity {} is unstable: (A + D)/2 of a round trip is {:.9g} in the plane of "
                                "incidence and {:.9g} across it, not between -1 and 1",
                                mode.cavity.name, mode.stability[0], mode.stability[1]),
                    "state other curvatures, or name stable cavities in 'modes: {cavities: ...}'");
  }
  void assign(std::uint32_t port, BeamCurvature const& q) {
    leaving_[port] = q;
    known_[port] = true;
    waiting_.push_back(port);
    auto const [end, space] = other_[port];
    if (end == network_.ports()) return;
    leaving_[end] = reversed(flown(q, network_.spaces()[space].length));
    known_[end] = true;
    waiting_.push_back(end);
  }

  Network const& network_;
  std::vector<std::pair<std::uint32_t, std::size_t>> other_;
  std::vector<bool> known_;
  std::vector<BeamCurvature> leaving_;
  std::vector<std::uint32_t> waiting_;  // whose reverse light is not carried on yet
};

Eigen::VectorXcd turns_of(Network::Space const& s, BeamCurvature const& q,
                          std::vector<std::array<int, 2>> const& orders) {
  double const x = std::arg(1.0 + s.length * q[0]), y = std::arg(1.0 + s.length * q[1]);
  Eigen::VectorXcd turns(Eigen::Index(orders.size()));
  for (std::size_t i = 0; i < orders.size(); ++i)
    turns[Eigen::Index(i)] = std::polar(1.0, -(orders[i][0] * x + orders[i][1] * y));
  return turns;
}

bool same(BeamCurvature const& a, BeamCurvature const& b) {
  for (int axis : {0, 1})
    if (std::abs(a[axis] - b[axis]) > same_curvature * b[axis].imag()) return false;
  return true;
}

}  // namespace

BeamCurvature through(Component const& c, std::uint32_t out, std::uint32_t in, BeamCurvature const& q) {
  auto const power = focusing(c, out, in);
  return {q[0] - power[0], q[1] - power[1]};
}

CavityMode mode_of(Network const& n, NetworkCavity const& cavity) {
  CavityMode mode{.cavity = cavity};
  auto const other = neighbours(n);
  std::array<RayMatrix2, 2> rays;
  for (std::size_t i = 0; i < cavity.beams.size(); ++i) {
    auto const [end, space] = other[cavity.beams[i]];
    Component const& c = n.at(n.owner_of(end));
    std::uint32_t const out = cavity.beams[(i + 1) % cavity.beams.size()] - c.first_port, in = end - c.first_port;
    auto const power = focusing(c, out, in);
    for (int axis : {0, 1}) {
      rays[axis].fly(n.spaces()[space].length);
      rays[axis].focus(power[axis]);
    }
    if (c.reflects(out, in)) mode.turned = !mode.turned;
  }
  for (int axis : {0, 1}) {
    RayMatrix2 const& m = rays[axis];
    mode.stability[axis] = (m.a + m.d) / 2;
    double const g = mode.stability[axis], sine = std::sqrt(std::fmax(0, 1 - g * g));
    // Q = (C + D Q)/(A + B Q) with Im Q > 0; a ray of the mode turns by e^{-i gouy} per round trip.
    if (!(sine > 0)) continue;
    mode.curvature[axis] = Complex((m.d - m.a) / (2 * m.b), sine / std::fabs(m.b));
    double const angle = std::atan2(m.b > 0 ? sine : -sine, g);
    mode.gouy[axis] = angle < 0 ? angle + 2 * pi : angle;
  }
  return mode;
}

Phasor round_trip_in_modes(Network const& n, ModeBases const& bases, NetworkCavity const& cavity) {
  auto const other = neighbours(n);
  auto const count = Eigen::Index(bases.count());
  Eigen::MatrixXcd trip = Eigen::MatrixXcd::Identity(count, count);
  for (std::size_t i = 0; i < cavity.beams.size(); ++i) {
    auto const [end, space] = other[cavity.beams[i]];
    Component const& c = n.at(n.owner_of(end));
    std::uint32_t const next = cavity.beams[(i + 1) % cavity.beams.size()], in = end - c.first_port;
    for (Eigen::Index mode = 0; mode < count; ++mode)
      trip.row(mode) *= turn_along(n, &bases, space, 0, std::size_t(mode));
    trip = carrier_way(n, c, next - c.first_port, in) * (bases.coupling(next, in) * trip);
  }
  Eigen::ComplexEigenSolver<Eigen::MatrixXcd> const solved(trip);
  Eigen::Index best = 0;
  solved.eigenvectors().colwise().normalized().row(0).cwiseAbs().maxCoeff(&best);
  return solved.eigenvalues()[best];
}

double CavityMode::phase_beyond(int n, int m) const {
  double const phase = n * gouy[0] + m * gouy[1] + (turned && n % 2 != 0 ? pi : 0);
  return phase - 2 * pi * std::floor(phase / (2 * pi));
}

ModeBases::ModeBases(Network const& n) : wave_number_(n.wavenumber()) {
  if (!n.modes()) throw ModeError("the network uses plane waves", "add 'modes: {order: 2}'");
  order_ = n.modes()->order;
  for (int sum = 0; sum <= order_; ++sum)
    for (int m = 0; m <= sum; ++m)
      if (!n.modes()->even || ((sum - m) % 2 == 0 && m % 2 == 0)) orders_.push_back({sum - m, m});

  Tracer tracer(n);
  for (CavityMode const& c : chosen(n, *n.modes()))
    if (tracer.begin_in(c)) cavities_.push_back(c);
  tracer.carry_from_lasers();
  tracer.carry_on();
  leaving_ = tracer.finished();

  for (Network::Space const& s : n.spaces()) turns_.push_back(turns_of(s, leaving_[s.from], orders_));
  couplings_.resize(std::size_t(n.ports()) * most_ports);
  for (Component const& c : n.components()) {
    Eigen::MatrixXcd const s = n.scattering(c, 0);
    for (std::uint32_t out = 0; out < c.ports; ++out)
      for (std::uint32_t in = 0; in < c.ports; ++in) {
        if (s(out, in) == 0.0) continue;
        std::uint32_t const from = c.first_port + in, to = c.first_port + out;
        couplings_[std::size_t(to) * most_ports + in] = coupled(c, out, in);
        BeamCurvature const brought = through(c, out, in, entering(from));
        if (!same(brought, leaving_[to])) {
          Eigen::MatrixXcd const k =
              mode_coupling({brought[0], leaving_[to][0]}, {brought[1], leaving_[to][1]}, wave_number_, 0);
          mismatches_.push_back({n.port_name(from), n.port_name(to), 1 - std::norm(k(0, 0))});
        }
      }
  }
}

BeamCurvature ModeBases::entering(std::uint32_t port) const { return reversed(leaving_[port]); }

std::string ModeBases::name(std::size_t mode) const {
  return fmt::format("({},{})", orders_[mode][0], orders_[mode][1]);
}

Eigen::MatrixXcd ModeBases::kept(Eigen::MatrixXcd const& all) const {
  auto const count = Eigen::Index(orders_.size());
  Eigen::MatrixXcd some(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      some(i, j) = all(mode_index(orders_[i][0], orders_[i][1]), mode_index(orders_[j][0], orders_[j][1]));
  return some;
}

// In the frame of the leaving light. A turn about y takes the light of both sides toward +x of its frame; one about x
// takes that of the back the other way.
Eigen::MatrixXcd ModeBases::changed_basis(Component const& c, std::uint32_t out, std::uint32_t in) const {
  auto const count = Eigen::Index(orders_.size());
  BeamCurvature brought = through(c, out, in, entering(c.first_port + in));
  BeamCurvature const& basis = leaving_[c.first_port + out];
  bool const matched = same(brought, basis);
  std::array<double, 2> kick{};
  if (c.reflects(out, in)) {
    auto const& p = std::get<MirrorParameters>(c.stated);
    double const side = in < c.ports / 2 ? 1 : -1;
    kick = {2 * wave_number_ * p.tilt[0], side * 2 * wave_number_ * std::cos(p.incidence) * p.tilt[1]};
  }
  if (matched) brought = basis;
  if (matched && kick[0] == 0 && kick[1] == 0) return Eigen::MatrixXcd::Identity(count, count);
  return kept(mode_coupling({brought[0], basis[0], kick[0]}, {brought[1], basis[1], kick[1]}, wave_number_, order_));
}

Eigen::MatrixXcd ModeBases::passed(Component const& c, std::uint32_t in) const {
  auto const& stop = std::get<ApertureParameters>(c.stated);
  BeamCurvature const& basis = leaving_[c.first_port + 1 - in];
  auto const w = [&](int axis) { return std::sqrt(2 / (wave_number_ * basis[axis].imag())); };
  double const side = in == 0 ? 1 : -1;  // the light that runs back has x turned round
  return kept(
      stop_coupling({stop.radius, {side * stop.offset[0], stop.offset[1]}}, {w(0), w(1)}, order_).cast<Complex>());
}

Eigen::MatrixXcd ModeBases::coupled(Component const& c, std::uint32_t out, std::uint32_t in) const {
  Eigen::MatrixXcd k = changed_basis(c, out, in);
  if (c.kind == Component::Kind::aperture) k = passed(c, in) * k;
  if (c.reflects(out, in))
    for (Eigen::Index j = 0; j < k.cols(); ++j)
      if (orders_[std::size_t(j)][0] % 2 != 0) k.col(j) = -k.col(j);
  return k;
}

double ModeBases::stopped(Component const& c, std::uint32_t in, Eigen::VectorXcd const& entering) const {
  Eigen::VectorXcd const a = changed_basis(c, 1 - in, in) * entering;
  return a.squaredNorm() - std::real(a.dot(passed(c, in) * a));
}

Eigen::VectorXcd ModeBases::emitted(Component const& c) const {
  auto const count = Eigen::Index(orders_.size());
  auto const& laser = std::get<LaserParameters>(c.stated);
  if (!laser.mode) return Eigen::VectorXcd::Unit(count, 0);
  Complex const q(laser.mode->curvature, 2 / (wave_number_ * laser.mode->radius * laser.mode->radius));
  BeamCurvature const& basis = leaving_[c.first_port];
  if (same({q, q}, basis)) return Eigen::VectorXcd::Unit(count, 0);
  return kept(mode_coupling({q, basis[0]}, {q, basis[1]}, wave_number_, order_)).col(0);
}

}  // namespace straytrace::ifo
