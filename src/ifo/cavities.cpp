// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/cavities.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "ifo/network_ways.hpp"

namespace straytrace::ifo {
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

}  // namespace straytrace::ifo
