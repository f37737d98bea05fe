// SPDX-License-Identifier: BSD-3-Clause
// The coupling table, which the noise stage takes from the trace. It contains no motion, calibration or frequency grid,
// so these can change without a new trace (docs/develop/architecture.md).
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <string>
#include <vector>

#include "base/math/constants.hpp"
#include "base/memory/ids.hpp"

namespace straytrace::trace {

constexpr int replica_count = 32;  // blocks with number = r modulo 32 share replica r (jackknife of the noise bands)

char letter(Event);  // emit, scatter, couple: 'S'; reflect: 'R'; transmit: 'T'; receive: 'D' (detected); start of a
                     // free beam: 'B'; diffract: 'E' (edge)

// Light of the Monte-Carlo walk and the routes computed without it (docs/theory/diffraction.md): specular returns and
// diffraction at rims: as an upper bound (edge), by Fourier propagation (wave), or in the mean over speckle (speckle;
// docs/theory/wave.md); light at small angles that surfaces in the field of a cavity scatter back (halo); and light
// that a moving rim takes from the main beam (rim; eq. N.21). All but the first are deterministic: a fixed set of path
// records, no Monte-Carlo error, and limits stated in words.
enum class ClassKind : std::uint8_t { scattered, ghost, edge, wave, speckle, halo, rim };
constexpr std::array class_kind_names{"scattered", "ghost", "edge", "wave", "speckle", "halo", "rim"};
constexpr char const* name_of(ClassKind kind) { return class_kind_names[std::size_t(kind)]; }

struct PathStep {
  GroupId group;
  Event event = Event::scatter;
  bool operator==(PathStep const& o) const { return group == o.group && event == o.event; }
};

// Mean with its Monte-Carlo error and convergence status. `why_not` is printed instead of a bare number.
struct Estimate {
  double mean = 0, std_error = 0;   // recoupled power fraction
  double variance_of_variance = 0;  // of std_error^2, relative
  double largest_share = 0;         // largest single history over the sum
  double effective_scores = 0;      // S1^2/S2
  std::uint64_t scored = 0;         // histories with a non-zero total
  bool trusted = false;
  std::string why_not;               // in words, empty when trusted
  double tail_slope = not_a_number;  // p of x^-p, of the largest totals; NaN: too few
  double halves = not_a_number;      // first blocks less the rest, in standard errors; NaN: no
};

constexpr std::uint32_t no_member = 0xffffffff;
constexpr std::uint32_t beam_of_port = 0xffffffff;

// One stored path: its address and the results of its replay.
struct PathRecord {
  std::uint64_t history = 0;     // of kind wave: the draw
  std::uint32_t event = 0;       // vertex number; of kind wave: the draw of the heights of the mirrors; rim: RimTerm
  std::uint32_t connection = 0;  // 2 i: hit footprint i, 2 i + 1: connected to it
  double coupling = 0;           // recoupled power fraction of this score times the number of histories [1]
  double weight = 0;             // share of the class mean it stands for; the weights of a class sum to the mean
  double path_length = 0;        // optical, m
  std::vector<PhaseSensitivity> phase_sensitivities;  // relative to the main mode; one entry per body touched
  // d(ln |s|)/d(coordinate) [1/m, 1/rad] of ghosts, by body; moments are not used (docs/theory/ghosts.md, eq. N.27).
  std::vector<PhaseSensitivity> amplitude_levers{};
  // Of a specular path of a coherent family: its field over that of the main mode, by principal state of polarisation,
  // phase relative to the other paths of its class; the squares sum to `weight`. Zero: its static phase is unknown.
  std::array<std::complex<double>, 2> field{};
  // In a row `other`: its route, by position in the `members` of the row; no_member: its row names it, or it is not
  // known, as from files before schema 2.1.
  std::uint32_t member = no_member;
  // The beam that its light leaves, by position in the table `beams` of the scene; beam_of_port: that of its port, as
  // of computed routes and in files before schema 2.4.
  std::uint32_t beam = beam_of_port;
};

// What a record of kind rim adds to the stray field s = -d (1 - first . x - 1/2 sum over second of +-(second . x)^2) of
// a rim that takes the share d of the main field; x: coordinates of the bodies, `first` and `second` the phase
// sensitivities of the records. Only the first has a weight, d^2 (docs/theory/diffraction.md, eq. N.21).
enum class RimTerm : std::uint32_t { first, second_plus, second_minus };

// Most paths that a class keeps in so many blocks; part of the run-file schema.
std::size_t records_kept(std::uint64_t blocks);

// Sum over paths of weight times phase sensitivity times phase sensitivity, of the histories of one replica: the
// moments that determine noise to first order in the motion (docs/theory/errors.md, Second moments of the
// phase sensitivities).
struct PhaseSensitivityProduct {
  std::uint32_t replica = 0;
  BodyId first, second;  // first <= second
  std::array<double, 36>
      sum{};  // row i, column j: coordinate i of `first` and j of `second`, as Phase sensitivity::d; (rad/m)^2 ...
};

// A route without a row of its own: part of a row `other`.
struct FoldedRoute {
  std::uint64_t hash = 0;
  std::vector<PathStep> steps;     // empty: routes beyond the length limit, together
  double mean = 0, std_error = 0;  // as those of an estimate; a hint
  bool trusted = false;            // the value is reliable, but its route is too long to be named
  std::string why;
};
constexpr std::size_t folded_kept = 12;  // by row `other`; rows of ghosts whose fields add keep all

// A route of the kept paths of a row `other`.
struct MemberRoute {
  std::vector<PathStep> steps;  // empty: more vertices than are named
};

// All ordered paths of one route. Couplings are of ORDERED paths; `reverse` (C_rev) is multiplied in by the projection.
struct CouplingClass {
  std::uint64_t hash = 0;  // stable name of the route
  PortId port;
  std::vector<PathStep> steps;  // empty for the class `other` (routes longer than the limit)
  ClassKind kind = ClassKind::scattered;
  std::string statement;  // of deterministic classes: meaning and validity of the value, in words
  Estimate coupling;
  double off_list = 0;                                 // part of coupling.mean by directions without a target
  double reverse = 1;                                  // C_rev, docs/theory/path_integral.md, eq. 1.5
  bool by_reverse = false;                             // taken entirely from the reversed route (reciprocity)
  std::array<double, replica_count> replica_sum = {};  // sum of scores of the histories of each replica
  std::vector<PathRecord> records;
  // Mean coupling times the mean of phase sensitivity times phase sensitivity, as contributions of the replicas, which
  // sum to it; for each replica, then each pair of bodies. Empty: not known.
  std::vector<PhaseSensitivityProduct> phase_sensitivities;
  // Of light below the crossover angle from mirrors of random heights: the coupling by equal parts of the azimuth, each
  // with that opposite to it. Parts are independent samples, whose spread is the std_error. Not in the run file.
  std::vector<double> azimuth_parts;
  std::uint64_t folded_routes = 0;   // of `other` and of coherent families: number of terms
  std::vector<FoldedRoute> folded;   // the largest of them, descending
  std::vector<MemberRoute> members;  // of a row `other` of light to ports: all routes of its records

  // A row `other`: bright still light and faint moving light may lie in it together.
  bool mixes_routes() const { return steps.empty() && !deterministic(); }
  bool deterministic() const { return kind != ClassKind::scattered; }
  // Whether its paths add as fields with known relative phases (docs/theory/ghosts.md, eq. 10.5), not in power.
  bool adds_fields() const {
    return records.size() > 1 && records.front().field != std::array<std::complex<double>, 2>{};
  }
};

struct CouplingTable {
  std::vector<CouplingClass> classes;   // light that rejoins ports, by hash
  std::vector<CouplingClass> received;  // light that ends on receivers [W per W of the main mode]; `port`: its number
  std::vector<std::string> groups, bodies, ports, receivers;  // names; ids are positions
  std::vector<Estimate> received_power;                       // by receiver, all routes together
  std::array<std::uint64_t, replica_count> replica_histories = {};
  std::uint64_t histories = 0, seed = 0;
  std::uint64_t block_size = largest_block;  // histories
  double wavelength = 0;                     // m
  // One sentence for each surface that contributes more than 1 % of an end's light without being a target
  // (docs/theory/errors.md).
  std::vector<std::string> warnings;
  bool reverse_routes = true;  // whether C_rev was applied (docs/theory/path_integral.md)
};

// "ITM·S > baffles·S > ITM·S", or "other" for routes beyond the length limit; of a coherent family its strongest path
// "and 3 more".
std::string route_name(CouplingTable const&, CouplingClass const&);
std::string received_name(CouplingTable const&, CouplingClass const&);  // of a route that ends on a receiver
std::string folded_name(CouplingTable const&, FoldedRoute const&);

}  // namespace straytrace::trace
