// SPDX-License-Identifier: BSD-3-Clause
// Interface of the results module: run files, curves, tables and texts. All of them can be recreated from a run file.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/files/read_write.hpp"
#include "base/memory/storage.hpp"
#include "ifo/interferometer.hpp"
#include "motion/motion.hpp"
#include "noise/bands/input_band.hpp"
#include "noise/noise.hpp"
#include "scene/scene.hpp"
#include "trace/result.hpp"
#include "world/model/receiver.hpp"

namespace straytrace::results {

// Inputs of the projection of noise from the traced model, besides the coupling table. With it in the run file, no
// surface and no search structure is built again (docs/develop/architecture.md, Walk: one displacement).

struct ProjectionInputs {
  std::vector<std::string> bodies;  // names; BodyId = position. Elastic modes follow the bodies
  std::vector<bool> meets_light;    // by body: it, or the body of the mode, has surfaces
  double wavelength = 0;            // m
  std::vector<TracedPort> ports;    // in the order of PortId
  std::vector<DrawnOptic> optics;   // that the interferometer may name; of a run: that it names
  std::vector<MaterialSpread> materials;
  std::vector<double> scattered;  // by material: share of the light at normal incidence, to both sides together
  // Lines of the reports: assumptions and results of building the model; light that is not counted, and sources of
  // materials without status.
  std::vector<std::string> notes, limits;
  std::string warnings, warnings_json;  // of the scene: as text; for editors, JSON lists
};

}  // namespace straytrace::results

namespace straytrace::wave {
struct RingRecord;
struct WaveRecord;
}  // namespace straytrace::wave

namespace straytrace::results {

// Run file; its layout: schema/run-2.txt.

constexpr int run_schema_major = 2, run_schema_minor = 5;

struct Provenance {
  std::string program = "straytrace", version, commit, build_flags;
  std::string created;  // ISO 8601, UTC
};

// Surfaces that light must not reach, from the steering of the trace: adjoint of each side of each patch
// (docs/theory/sampling.md).
struct ImportanceMap {
  struct Strip {
    std::uint32_t group = 0, patch = 0;
    double low = 0, high = 0;  // m, along z
    double area = 0;           // m^2
  };
  std::vector<Strip> strips;               // all of the scene, in its order; empty: no steering
  std::vector<double> adjoint, law_share;  // front and back of patch 0, of patch 1, ...
};

// The noise of a run and that at another crossover angle, on which it must not depend (docs/theory/wave.md, eq. W.21).
struct SeamCheck {
  // At both angles, 1/sqrt(Hz), and the relative change, each with one standard error; NaN: rays are not resolved.
  struct Light {
    double strain = 0, strain_sigma = 0, other = 0, other_sigma = 0, change = 0, change_sigma = 0;
  };
  double frequency = 0;                       // Hz
  double crossover = 0, other_crossover = 0;  // rad
  std::uint64_t histories = 0;                // at the other angle
  Light baffles, total;                       // baffles: rays and halo
};

// Content of a run file apart from its numbers; no host names, user names or absolute paths of this machine.
struct RunContent {
  FileTexts files;
  std::string main_file, title;
  std::vector<std::string> overrides;  // as written on the command line
  std::string resolved;
  // The `files` that replace tables of the scene (motion, responses), one per line, in this order; may be empty.
  std::string motion_file;
  std::string model_hash;
  std::string interferometer;         // Interferometer::description()
  std::vector<std::string> warnings;  // of the scene; those of the trace are added by the writer
  std::vector<Receiver> receivers;    // in the order of CouplingTable::receivers
  Storage cells;                      // of their maps, where they were read from a file
  // By receiver, of each pixel or cell of its map within the rim of its surface, m^2 (world/model/world.hpp);
  // empty: not known, as in files before schema 2.1.
  std::vector<std::vector<double>> map_areas;
  ImportanceMap importance;
  double beam_power = 0;                          // W, of the main mode; 0: not stated
  std::shared_ptr<wave::WaveRecord const> waves;  // of the table `wave`; may be null
  std::shared_ptr<wave::RingRecord const> ring;   // the same of a ring or folded cavity
  std::shared_ptr<SeamCheck const> seam;          // null: not checked
  std::optional<ProjectionInputs> projection;     // absent in files of schema 1
  Provenance provenance;
  std::map<std::string, double> timing;  // s, by stage, without trace and noise
  TraceResult const* trace = nullptr;
  NoiseBudget const* noise = nullptr;  // may be absent

  std::vector<std::string> all_warnings() const;  // of scene, trace and noise
};

// A run file in memory: all of RunContent, owning its numbers.
struct RunFile {
  RunContent about;   // `trace` and `noise` are null here; see content()
  TraceResult trace;  // tree, total, coupling table with records
  std::optional<NoiseBudget> noise;
  bool complete = false;  // false: a checkpoint

  RunContent content() const;  // the same with the pointers set to this object
};

// Appears complete or not at all: written under a temporary name and renamed. Throws InputError with the reason of the
// system when the disk fails, NumericalError when the HDF5 library fails.
void write_run(std::string const& file, RunContent const&);
// Throws InputError: no such file, another kind of file, a newer schema, damaged content.
RunFile read_run(std::string const& file);

// Light per history: emitted, and the terms in which it ends; arriving at each group, and absorbed there.
struct BalanceRow {
  std::string name;
  Estimate power;
};
std::vector<BalanceRow> balance_rows(BlockSums const&);
struct ObjectRow {
  std::string name;                            // "(in media)", last: absorbed in glass
  std::optional<Estimate> arriving, absorbed;  // absent where older files lack it
};
std::vector<ObjectRow> object_rows(TraceResult const&);

// The classes, or curves, of routes by their hash.
template <class Route>
std::map<std::uint64_t, Route const*> by_hash(std::vector<Route> const& routes) {
  std::map<std::uint64_t, Route const*> all;
  for (Route const& r : routes) all[r.hash] = &r;
  return all;
}

std::string model_hash(std::span<std::string const> texts);  // sha256 over the texts, each with its length in front
// sha256 over every dataset and attribute in path order, except /timing and the attribute `created`: equal for equal
// results, independent of machine and time.
std::string data_hash(std::string const& run_file);
std::string utc_now();  // "2024-05-01T12:00:00Z"

// Text files with the same rule: complete or not at all.
void write_file(std::string const& file, std::string_view bytes);
// Name and content of each; nothing appears before all of them are on the disk.
void write_files(std::vector<std::pair<std::string, std::string>> const& files);
std::string read_file(std::string const& file);

// Path table.

struct WithError {
  double value = 0, sigma = 0;  // one standard error
  bool at_most = false;         // upper bounds make a part of it: it may be less by more than that
  bool incomplete = false;      // unresolved routes may add to it; with `at_most` it is no bound at all
  WithError over(double x) const { return {value / x, sigma / x, at_most, incomplete}; }
};

// A line in one bin of a curve: its total, since its mean over the bin depends on the width of the bin.
struct BinLine {
  WithError rms{not_a_number, not_a_number};  // unit of the curve times sqrt(Hz); NaN: no line
  double low = 0, high = 0;                   // Hz, edges of the bin
};

using ReplicaPattern = std::array<double, replica_count>;  // results/route_table/route_sums.hpp

struct TableSettings {
  std::vector<double> frequencies = {10, 30, 100};  // Hz, where h is printed
  double low = 0, high = 0;                         // Hz, band of shares and verdicts; 0, 0: the whole grid
  std::size_t show = 12;                            // rows for people; CSV and JSON have all
};

// A route inside a row `other`, and why it has no row of its own.
struct FoldedRow {
  std::uint64_t hash = 0;
  std::string sequence;
  WithError coupling;    // receivers: power; a hint unless `trusted`
  bool trusted = false;  // a good number whose route is too long to be named
  std::string why;
};

struct PathRow {
  std::size_t rank = 0;  // 1 = largest share, or largest coupling without a noise budget; unresolved ones last
  std::uint64_t hash = 0;
  std::string port, sequence;
  ClassKind kind = ClassKind::scattered;
  std::string statement;     // of deterministic routes: meaning and validity of the value
  std::size_t vertices = 0;  // 0 for `other`, as the counts below
  std::size_t scatters = 0, reflections = 0, bounces = 0, objects = 0;  // bounces: vertices but the first and the last
  std::string first_scatterer, last_scatterer;                          // of the bounces
  Estimate coupling;                                                    // of ordered paths; C_rev not multiplied in
  ReplicaPattern replicas = {};                                         // how it goes up and down with them
  double reverse = 1;                                                   // C_rev
  bool by_reverse = false;  // numbers of its reverse, on which it is better sampled
  bool resolved = false;
  bool faint = false;  // unresolved, but too faint to matter (noise.hpp)
  std::string why_not;
  std::vector<WithError> strain;              // 1/sqrt(Hz), one per frequency; NaN outside the grid
  std::vector<double> hint;                   // 1/sqrt(Hz), of unresolved routes: the observed part
  std::vector<double> input_low, input_high;  // of it: range due to stated input uncertainties; NaN where not computed
  std::vector<double> draws_low, draws_high;  // of it: percentiles 5 and 95 over draws of mirrors and edges; or NaN
  WithError power;                            // of its strain noise in the band, strain^2
  WithError share;               // of the resolved strain noise power in the band [1]; NaN without a budget
  std::string body;              // whose motion contributes most; without motion, of the largest phase sensitivity
  std::string moves;             // without motion: all bodies of nearly the largest phase sensitivity; else `body`
  double phase_sensitivity = 0;  // rad/m, of that body's translations: rms over the paths by power, of `other` by noise
  double sensitivity() const { return body.empty() ? not_a_number : phase_sensitivity; }  // rad/m
  bool upper_bound() const { return kind == ClassKind::edge; }
  WithError coupling_with_error() const { return {coupling.mean, coupling.std_error, upper_bound()}; }
  double rms_phase = 0;           // rad, of the strongest independent motion; above 1: fringes wrap
  std::string regime;             // results/curves/band.hpp, over the band; empty without a budget
  std::size_t folded_routes = 0;  // of `other` and rows of several ghosts: how many
  std::vector<FoldedRow> folded;  // the largest of them, descending
  double length_mean = 0, length_min = 0, length_max = 0;  // m, optical; NaN without records
};

struct PathTable {
  std::vector<PathRow> rows;        // by rank
  std::vector<double> frequencies;  // Hz
  double low = 0, high = 0;         // Hz
  double wavelength = 0;            // m
  bool has_noise = false, reverse_routes = true;
  std::vector<WithError> total_strain;    // 1/sqrt(Hz); a lower bound when a row is unresolved, unless `at_most`
  std::vector<BinLine> lines;             // of it, one per frequency
  WithError total_coupling;               // resolved rows
  std::size_t unresolved = 0, faint = 0;  // rows; `faint` of them cannot move the total
  std::size_t missing() const { return unresolved - faint; }
  bool incomplete() const;        // the total lacks routes, also those that a part of a table does not list
  bool has_upper_bounds() const;  // that show in the total, at any of the frequencies
};

// Kind of a total: "lower" bound where routes are missing, "upper" where upper bounds make a part of it, "neither"
// where both hold, or "".
std::string bound_name(bool has_upper_bounds, bool incomplete);
// The same in words: "lower bound: 2 routes unresolved", "upper bound", "contains upper bounds; 2 routes unresolved".
std::string bound_text(bool has_upper_bounds, std::size_t missing);

// `budget` and `motion` may be null; columns that need them are then absent.
PathTable path_table(CouplingTable const&, NoiseBudget const* budget, MotionSet const* motion, TableSettings const&);

std::vector<FoldedRow> folded_rows(CouplingTable const&, CouplingClass const&);
// "other > ITM sums 42 routes: ..." and a line for each of the largest.
std::string folded_text(std::string const& row, std::size_t routes, std::vector<FoldedRow> const&);

std::string path_text(PathTable const&, std::size_t show);  // aligned, UTF-8, for terminals
std::string path_csv(PathTable const&, RunContent const&);  // all digits
std::string path_json(PathTable const&, RunContent const&);

// Curves, summary, report.

// Columns frequency, mean, sigma, low, high, phase, amplitude, design, ratio. Needs content.noise.
std::string asd_text(RunContent const&);
std::string summary_json(RunContent const&, PathTable const&);
// As text. `assumptions`: further lines for that section.
std::string text_report(RunContent const&, PathTable const&, std::size_t show,
                        std::vector<std::string> const& assumptions = {});
// The energy balance: emitted, then a line for each term, and whether it closes.
std::string energy_balance_text(RunContent const&);
// Power arriving on each group and absorbed by it, then that absorbed by media; largest absorber first.
std::string objects_text(RunContent const&);
// "Stray light stays a factor 6.1 ± 0.2 below the margin line 0.1 x adv-lal between 10 and 500 Hz; ..."
std::string verdict_sentence(NoiseBudget const&, double low_hz, double high_hz);
// Whether the noise depends on the crossover angle; empty for a run without noise or without a field beside its rays.
std::string seam_sentence(RunContent const&);

// A design curve at a frequency, 1/sqrt(Hz); NaN outside the grid.
double design_at(DesignCurve const&, FrequencyGrid const&, double hz);

// "1.23e-24 ± 0.04e-24": one digit of the error, two when it begins with 1. "unresolved" when not finite; "1.23e-24
// (computed)" without an error, as of routes that are not sampled.
std::string with_error(double value, double sigma);
// "at most 1.3e-24" for an upper bound: two digits, rounded up; "about 1.3e-24" where it is incomplete as well.
std::string with_error(WithError const&);
// "1.23(4)e-24": the error in units of the last digit, for tables; "1.23e-24 computed" without one.
std::string with_brackets(double value, double sigma);
std::string with_brackets(WithError const&);
std::string two_digits(double value, bool up);     // of a positive number, rounded up or down
std::string percent_text(WithError const& share);  // of 1 in per cent; all of it has no error: "100"

}  // namespace straytrace::results
