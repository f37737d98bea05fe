// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/mode_bases.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/linear_algebra.hpp"
#include "beams/overlap.hpp"
#include "ifo/network_ways.hpp"

namespace straytrace::ifo {

namespace {

double radius(std::complex<double> q, double k) {
  if (!(q.imag() > 0))
    throw NumericalError(fmt::format(
        "a beam of complex curvature {:.9g} + {:.9g} i 1/m has no radius: the imaginary part must be above zero",
        q.real(), q.imag()));
  return std::sqrt(2 / (k * q.imag()));
}

// Calls with the orders and the index of every mode.
template <class Use>
void each_mode(int order, Use const& use) {
  for (int sum = 0; sum <= order; ++sum)
    for (int m = 0; m <= sum; ++m) use(sum - m, m, mode_index(sum - m, m));
}

std::vector<double> hermite_functions(int order, double x) {
  std::vector<double> h(std::size_t(order) + 1);
  for (int n = 0; n <= order; ++n) h[n] = beams::hermite_function(n, x);
  return h;
}

// Integrals of the products h_n h_m from `from` to `to`. Those of unequal orders are Wronskians, as both functions
// solve h'' = (x^2 - 2n - 1) h; those of equal orders follow by the ladder from the error function.
Eigen::MatrixXd incomplete_products(int order, double from, double to) {
  auto const a = hermite_functions(order, from), b = hermite_functions(order, to);
  auto const step = [&](int n, int m) { return b[n] * b[m] - a[n] * a[m]; };
  Eigen::MatrixXd products(order + 1, order + 1);
  products(0, 0) = 0.5 * (std::erf(to) - std::erf(from));
  for (int n = 1; n <= order; ++n) {
    products(n, n) = products(n - 1, n - 1) - step(n, n - 1) / std::sqrt(2.0 * n);
    for (int m = 0; m < n; ++m) {
      double const lower = m > 0 ? std::sqrt(2.0 * m) * step(n, m - 1) : 0;
      products(n, m) = products(m, n) = (std::sqrt(2.0 * n) * step(n - 1, m) - lower) / (2.0 * (m - n));
    }
  }
  return products;
}

}  // namespace

Eigen::MatrixXcd axis_coupling(AxisCoupling const& axis, double k, int order) {
  double const w1 = radius(axis.in, k), w2 = radius(axis.out, k), d = axis.shift;
  std::complex<double> const i{0, 1};
  std::complex<double> const p = -0.5 * i * k * (axis.in - std::conj(axis.out));
  std::complex<double> const j = i * (axis.kick - k * axis.in * d);
  std::complex<double> const a = 2.0 / (p * w2 * w2) - 1.0, b = 2.0 / (p * w1 * w2), c = 2.0 / (p * w1 * w1) - 1.0;
  std::complex<double> const out = j / (p * w2), in = j / (p * w1) - 2 * d / w1;  // D and F

  Eigen::MatrixXcd coupling(order + 1, order + 1);
  coupling(0, 0) = std::sqrt(2.0 / (w1 * w2 * p)) * std::exp(j * j / (4.0 * p) + 0.5 * i * k * axis.in * d * d);
  for (int m = 1; m <= order; ++m) {
    std::complex<double> next = in * coupling(0, m - 1);
    if (m > 1) next += c * std::sqrt(m - 1.0) * coupling(0, m - 2);
    coupling(0, m) = next / std::sqrt(double(m));
  }
  for (int n = 0; n < order; ++n)
    for (int m = 0; m <= order; ++m) {
      std::complex<double> next = out * coupling(n, m);
      if (n > 0) next += a * std::sqrt(double(n)) * coupling(n - 1, m);
      if (m > 0) next += b * std::sqrt(double(m)) * coupling(n, m - 1);
      coupling(n + 1, m) = next / std::sqrt(n + 1.0);
    }
  return coupling;
}

Eigen::MatrixXcd mode_coupling(AxisCoupling const& x, AxisCoupling const& y, double k, int order) {
  Eigen::MatrixXcd const along = axis_coupling(x, k, order), across = axis_coupling(y, k, order);
  Eigen::MatrixXcd coupling(mode_count(order), mode_count(order));
  each_mode(order, [&](int n, int m, int row) {
    each_mode(order, [&](int n1, int m1, int column) { coupling(row, column) = along(n, n1) * across(m, m1); });
  });
  return coupling;
}

namespace {

// Half width, in units of w/sqrt(2), beyond which the modes up to an order hold less than rounding: some distance past
// the turning point of the highest Hermite function.
double extent_of_modes(int order) { return std::sqrt(2.0 * order + 1) + 8; }

struct Angles {
  double low, high;
  bool empty() const { return !(high > low); }
};

// Where the heights offset + radius sin(angle) lie within `most` of the axis.
Angles angles_with_light(double radius, double offset, double most) {
  auto const angle = [&](double height) { return std::asin(std::clamp((height - offset) / radius, -1.0, 1.0)); };
  return {angle(-most), angle(most)};
}

}  // namespace

Eigen::MatrixXd stop_coupling(CircularStop const& stop, std::array<double, 2> w, int order) {
  double const sx = std::sqrt(2.0) / w[0], sy = std::sqrt(2.0) / w[1], far = extent_of_modes(order);
  double const reach_x = std::fabs(stop.offset[0]) + far / sx, reach_y = std::fabs(stop.offset[1]) + far / sy;
  Eigen::MatrixXd passed = Eigen::MatrixXd::Zero(mode_count(order), mode_count(order));
  if (std::hypot(reach_x, reach_y) <= stop.radius) return passed.setIdentity();
  Angles const lit = angles_with_light(stop.radius, stop.offset[1], far / sy);
  if (lit.empty()) return passed;
  // With y = radius sin(angle) the integrand is analytic and of period pi, and it vanishes at the other ends: the
  // midpoint rule converges exponentially.
  double const range = lit.high - lit.low;
  int const points = 64 + 8 * order + int(16 * range / pi * stop.radius * std::max(sx, sy));
  for (int point = 0; point < points; ++point) {
    double const angle = lit.low + range * (point + 0.5) / points, half = stop.radius * std::cos(angle);
    auto const across = hermite_functions(order, sy * (stop.offset[1] + stop.radius * std::sin(angle)));
    Eigen::MatrixXd const along =
        incomplete_products(order, sx * (stop.offset[0] - half), sx * (stop.offset[0] + half));
    double const weight = range / points * sy * half;
    each_mode(order, [&](int n, int m, int row) {
      each_mode(order, [&](int n1, int m1, int column) {
        passed(row, column) += weight * across[m] * across[m1] * along(n, n1);
      });
    });
  }
  return passed;
}

namespace {

using Kind = Network::Component::Kind;

constexpr std::size_t most_beams = 24, most_steps = 200000;

class Search {
 public:
  explicit Search(Network const& network) : network_(network), other_(neighbours(network)) {}
  std::vector<NetworkCavity> run() {
    for (std::uint32_t first = 0; first < network_.ports(); ++first) {
      way_ = {{first, 1, 0}};
      follow(first);
    }
    std::ranges::stable_sort(found_, {}, [](NetworkCavity const& c) { return c.beams.size(); });
    return std::move(found_);
  }

 private:
  struct Beam {
    std::uint32_t port;
    Phasor amplitude;  // from the first beam to this one
    int mirrors;       // reflections at normal incidence so far
  };

  // From the last beam of the way: through the space behind it and the component there. Beams before `first` have
  // been searched.
  void follow(std::uint32_t first) {
    Beam const last = way_.back();
    auto const [entered, space] = other_[last.port];
    if (entered == network_.ports() || way_.size() > most_beams || ++steps_ > most_steps) return;
    Network::Component const& c = network_.at(network_.owner_of(entered));
    Phasor const turn = std::polar(1.0, phase_along(network_.spaces()[space], 0));
    std::uint32_t const in = entered - c.first_port;
    for (std::uint32_t out = 0; out < c.ports; ++out) {
      if (c.kind == Kind::mirror && out != in) continue;  // a resonator ends at a mirror
      Phasor const amplitude = last.amplitude * turn * carrier_way(network_, c, out, in);
      int const mirrors = last.mirrors + (c.kind == Kind::mirror ? 1 : 0);
      std::uint32_t const left = c.first_port + out;
      if (amplitude == 0.0 || mirrors > 2) continue;
      if (left == first) {
        add(amplitude);
      } else if (left > first && std::ranges::none_of(way_, [&](Beam const& b) { return b.port == left; })) {
        way_.push_back({left, amplitude, mirrors});
        follow(first);
        way_.pop_back();
      }
    }
  }

  // A name that begins at a mirror, where there is one.
  std::vector<Beam> from_a_mirror() const {
    std::vector<Beam> way = way_;
    auto const mirror = std::ranges::find_if(
        way, [&](Beam const& b) { return network_.at(network_.owner_of(b.port)).kind == Kind::mirror; });
    if (mirror != way.end()) std::rotate(way.begin(), mirror, way.end());
    return way;
  }

  void add(Phasor round_trip) {
    double const phase = std::arg(round_trip);
    NetworkCavity cavity{.round_trip = std::abs(round_trip), .phase = std::fabs(phase) > 1e-12 ? phase : 0};
    std::multiset<std::size_t> spaces;
    std::vector<std::string> named;
    for (Beam const& b : from_a_mirror()) {
      std::size_t const space = other_[b.port].second;
      spaces.insert(space);
      cavity.beams.push_back(b.port);
      cavity.length += network_.spaces()[space].length;
      std::string const& name = network_.name(network_.owner_of(b.port));
      if (std::ranges::find(named, name) == named.end()) named.push_back(name);
    }
    for (std::string const& name : named) cavity.name += (cavity.name.empty() ? "" : "-") + name;
    if (cavity.finesse() >= 1 && seen_.insert(spaces).second) found_.push_back(std::move(cavity));
  }

  Network const& network_;
  std::vector<std::pair<std::uint32_t, std::size_t>> other_;
  std::vector<Beam> way_;
  std::set<std::multiset<std::size_t>> seen_;
  std::vector<NetworkCavity> found_;
  std::size_t steps_ = 0;
};

}  // namespace

double NetworkCavity::free_spectral_range() const { return length > 0 ? speed_of_light / length : infinity; }
double NetworkCavity::finesse() const { return pi * std::sqrt(round_trip) / (1 - round_trip); }
double NetworkCavity::pole() const { return free_spectral_range() / (2 * finesse()); }

std::vector<NetworkCavity> cavities_of(Network const& network) { return Search(network).run(); }

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
  std::vector<std::string> known;
  for (NetworkCavity const& c : all) known.push_back(c.name);
  throw ModeError(fmt::format("the network has no cavity with {}", fmt::join(names, ", ")),
                  fmt::format("it has: {}", fmt::join(known, ", ")));
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
  ComplexModes const solved = complex_modes(trip);
  Eigen::Index best = 0;
  solved.vectors.colwise().normalized().row(0).cwiseAbs().maxCoeff(&best);
  return solved.values[best];
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
