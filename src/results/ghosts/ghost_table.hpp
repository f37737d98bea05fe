// SPDX-License-Identifier: BSD-3-Clause
// The table of ghosts: the strongest of any number, the families with common phase sensitivities, and the objects they
// meet. Memory is bounded by the number of rows kept and of families.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trace/coupling.hpp"
#include "world/ghosts/main_beam.hpp"

namespace straytrace::results {

constexpr std::array<double, 3> ghost_frequencies = {10, 30, 100};  // Hz, where h is printed
using GhostStrain = std::array<double, 3>;                          // 1/sqrt(Hz); NaN: not known

// How ghosts with equal phase sensitivities add: their powers, as for static phases that are unknown, or their fields
// with the phases of the geometry as it is written.
enum class GhostSum : std::uint8_t { independent, coherent };

// Limits and summation of ghosts: the table `ghosts` of a scene, or the command line.
struct GhostSettings {
  static constexpr double default_floor = 1e-15;
  double floor =
      default_floor;  // smallest power followed, over the launched power: of a cavity, that transmitted by its mirror
  std::uint32_t order = TreeLimits{}.order;
  GhostSum sum = GhostSum::independent;
  TreeLimits limits(BeamLaunch const& launch) const {
    TreeLimits tree;
    tree.floor = floor * launch.passes;
    tree.order = order;
    return tree;
  }
};

// Ghosts of one route in a family.
struct GhostPart {
  std::vector<PathStep> steps;
  double share = 0, reverse = 1;        // sum of the shares at the port, without C_rev; C_rev (eq. 1.5)
  double largest = 0, path_length = 0;  // of the strongest
  std::vector<OverlapLever> levers{};   // of the strongest (eq. N.27)
};

// Ghosts that return to the port with equal phase sensitivities: they move together (docs/theory/ghosts.md, eq. 10.5).
struct GhostFamily {
  PortId port;
  std::vector<PhaseSensitivity> phase_sensitivities;
  std::array<std::complex<double>, 2> field{};  // at the launch, relative to the main mode, by state of polarisation
  double incoherent = 0, root_sum = 0;          // sum of the shares times C_rev (eq. 1.5), and of their roots
  std::uint64_t ghosts = 0, strongest = 0;      // number of them; of the strongest one
  double largest = 0, path_length = 0;          // of the strongest
  std::vector<PathStep> steps;                  // all of the strongest, and its way back
  std::vector<OverlapLever> levers;             // of the strongest (eq. N.27)
  std::map<std::uint32_t, double> through;      // of `incoherent`, by group that a ghost has met or left
  std::vector<GhostPart> parts;                 // the strongest routes
  std::uint64_t others = 0;                     // ghosts of weaker routes, and
  GhostPart rest;                               // their sum, C_rev in the share; its steps: of the strongest
  GhostStrain per_root_power = {not_a_number, not_a_number, not_a_number};  // strain over the root of the share
  GhostSum sum = GhostSum::independent;
  double coherent() const { return std::norm(field[0]) + std::norm(field[1]); }
  double share() const { return sum == GhostSum::coherent ? coherent() : incoherent; }
  double worst() const { return root_sum * root_sum; }
  std::uint64_t routes() const { return parts.size() + others; }  // at most, if `others` have common routes
};

class GhostFamilies {
 public:
  static constexpr std::size_t most = 4096;      // also of routes, beyond one for each family
  static constexpr std::size_t most_parts = 64;  // of one family
  GhostFamilies(World const&, BeamLaunch const&, MainBeam const&, std::optional<PortId>, GhostSum);

  void add(Ghost const&);
  std::vector<GhostFamily>& all() { return families_; }
  std::vector<GhostFamily> const& all() const { return families_; }
  // Of the light that runs back along the main beam and counts at the port, as all couplings are: over the launched
  // mode, times the square of its own share (eq. 1.2); nothing when it does not count. Light that runs along a beam of
  // the network counts too (eq. N.18).
  std::optional<double> share_at_port(Ghost const&) const;
  GhostStrain strain_of(Ghost const&) const;  // of this ghost alone
  std::vector<OverlapLever> levers_of(Ghost const& g) const {
    return main_.overlap_levers(g.standing.recoupled, g.way);
  }
  // By surface, of rims whose motion is in no lever: the largest change of the share at the port per share that they
  // take.
  std::map<std::uint32_t, double> rims_left_out;
  std::uint64_t left_out = 0;  // ghosts beyond the most families, and
  double left_out_share = 0;   // the sum of their shares
  std::optional<PortId> port() const { return port_; }

 private:
  using Key = std::vector<long long>;
  void add_part(GhostFamily&, GhostPart, Ghost const&);
  Key key_of(bool against, std::vector<PhaseSensitivity> const&) const;
  std::vector<PathStep> steps_of(Ghost const&) const;  // to where it joins the main beam, and back along that
  double factor(bool against) const;                   // of a share at the port
  World const& world_;
  MainBeam const& main_;
  std::optional<PortId> port_;
  GhostSum sum_;
  double beam_share_;  // q of the launched beam
  struct Forward {
    PortId port;
    double share = 0;    // q of the beam of that port
    double reverse = 1;  // C_rev: the tree of the other beam finds the same light
  };
  std::optional<Forward> forward_;  // of light that runs along the beam
  std::vector<GhostFamily> families_;
  std::map<Key, std::size_t> place_;
  std::size_t parts_ = 0;  // of all families
};
// The port of the beam nearest to its launch: there light in the reversed main beam is counted.
std::optional<PortId> ghost_port(World const&, BeamLaunch const&, MainBeam const&);

enum class GhostRank : std::uint8_t { power, strain, recoupled };

struct GhostRow {
  Ghost ghost;  // its way is `steps`
  std::string route, end;
  std::vector<PathStep> steps;
  std::vector<Vec3> points;  // of the way, from the launch
  std::vector<OverlapLever> levers;
  GhostStrain strain;
  double key = 0;
};

// Effect of an object on ghosts.
struct GhostObject {
  double ends = 0;       // ghost power that is absorbed or scattered there, or passes beside its rim; over the launched
  double recoupled = 0;  // share of the recoupled light that has met or left it as a ghost: saved by a perfect dump
  std::array<double, 3> strain2 = {0, 0, 0};  // the same in strain^2/Hz; NaN: not known
};

struct GhostReport;

class GhostTable {
 public:
  static constexpr std::size_t main_shown = 4;  // strongest ends of the main beam
  GhostTable(World const&, BeamLaunch const&, GhostFamilies const&, GhostRank, std::size_t show);
  void add(Ghost const&);
  std::vector<GhostRow> rows() const;  // of the main beam, then ghosts by rank
  GhostRow row(Ghost const&) const;
  void fill(GhostReport&) const;  // after all ghosts, with the energy balance of their tree in it

 private:
  std::vector<GhostObject> objects(BeamEnergyBalance const&) const;  // by group
  World const& world_;
  BeamLaunch const& launch_;
  GhostFamilies const& families_;
  GhostRank rank_;
  std::size_t show_;
  void keep(std::vector<GhostRow>& heap, std::size_t most, double key, Ghost const&) const;
  std::vector<GhostRow> heap_, main_;  // ghosts, main beam; the least at the top
  std::vector<double> met_;            // recoupled share by group
  std::uint64_t ghosts_ = 0;
  std::vector<std::uint64_t> by_order_;                // number, and
  std::vector<double> power_by_order_;                 // sum of powers where they end
  double recoupled_with_ = 0, recoupled_against_ = 0;  // sums of shares
};

struct GhostReport {
  std::string beam;  // name
  double power = 0;  // W launched; 0: not stated
  TreeLimits limits;
  double floor = 0;  // over what leaves
  GhostSum sum = GhostSum::independent;
  double passes = 1;  // share of the launched power that leaves its cavity
  GhostRank rank = GhostRank::power;
  std::vector<GhostRow> rows;
  std::vector<GhostObject> objects;
  std::vector<std::string> groups, bodies;
  std::vector<std::string> notes, warnings;
  BeamEnergyBalance energy_balance;
  std::uint64_t ghosts = 0;
  std::vector<std::uint64_t> by_order;
  std::vector<double> power_by_order;
  double recoupled_with = 0, recoupled_against = 0;
  // Of the families: as they count, as fields of the drawn geometry, powers added, worst case; shares at the port,
  // strain.
  bool has_port = false, has_noise = false;
  std::string port;
  std::size_t families = 0;
  double share = 0, coherent = 0, incoherent = 0, worst = 0;
  GhostStrain strain{not_a_number, not_a_number, not_a_number};
};

std::string ghost_text(GhostReport const&, std::size_t objects_shown);
std::string ghost_json(GhostReport const&);
nlohmann::ordered_json ghost_page_table(GhostReport const&);
// CSV of the ghosts of several beams, row by row.
class GhostCsv {
 public:
  explicit GhostCsv(bool watts);  // some beam states its power
  ~GhostCsv();
  std::string head() const;
  // `where`: object on which it ends; `power`: W launched, 0: not stated.
  std::string row(std::string const& beam, GhostRow const&, std::string const& where, double power,
                  std::vector<std::string> const& bodies) const;

 private:
  struct List;
  std::unique_ptr<List> list_;
};

}  // namespace straytrace::results
