// SPDX-License-Identifier: BSD-3-Clause
// The axes of a scan, and one model per point: traced once per model hash, its noise projected.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "session/session.hpp"

namespace straytrace::session {

// One model per point of a scan: traced once per model hash, its noise projected.

// "aperture=50cm..80cm:7" and "n=40,80,160": the values that a scan gives to parameters.

struct ScanAxis {
  std::string name;
  std::vector<std::string> values;  // as -p takes them: "0.55 m", "80"
  std::vector<double> numbers;      // for pictures, in the unit written; NaN where a value is not a number
  std::string unit;                 // of the numbers; empty: plain
  bool range = false;               // given as lo..hi, with or without a count
};

// Those without an error; the others are added to `errors`, and none is returned where there are too many combinations.
// `open`: a range may omit the count, as for --invert.
std::vector<ScanAxis> parse_axes(std::vector<std::string> const& words, bool open, std::vector<InputError>& errors);

// "name=value" of each parameter, for every combination; the last parameter changes first.
std::vector<std::vector<std::string>> combinations(std::vector<ScanAxis> const&);

// A CSV of points: a header of parameters with their units, "rim [cm], baffles", and a row for each point. Throws one
// InputError with all problems.
struct ScanList {
  std::vector<ScanAxis> axes;  // columns
  std::vector<std::vector<std::string>> points;
  std::string file = {};
  std::vector<std::vector<Place>> places = {};  // of the values in the file
};
ScanList read_points(std::string const& file);
// The error of a point with the places in the file of points instead of those in the command line, in which the
// settings of the point come after `overrides` others.
InputError in_points(InputError const&, ScanList const&, std::size_t point, std::size_t overrides);

struct ScanPoint {
  std::vector<std::string> settings;  // "aperture=0.5 m"
  std::string model_hash;
  std::uint64_t histories = 0;
  enum class From { traced, stored, shared } from = From::traced;  // shared: the trace of an earlier point
  bool complete = true;                                            // false: interrupted
  std::vector<WithError> strain;                                   // at the frequencies of the scan, 1/sqrt(Hz)
  WithError ratio{not_a_number, not_a_number};                     // worst total over margin line
  double worst_hz = not_a_number;
  std::vector<std::string> unresolved;  // the total is then a lower bound
  std::vector<std::string> warnings;    // of its noise
};

struct ScanOptions : TraceOptions {
  std::string out;  // folder; empty: only print
};

// The line that a total is compared with.
struct Requirement {
  std::optional<double> margin;  // of the model where not given
  std::string against;           // design curve by name or file; of the model where empty
};
void apply(Requirement const&, ProjectionModel&);
std::string name_of_line(ProjectionModel const&);                             // "0.1 x adv-lal"; empty without a curve
std::vector<double> line_of(ProjectionModel const&);                          // ASD per bin; NaN: none
void judge(ScanPoint&, NoiseBudget const&, std::vector<double> const& line);  // ratio, worst_hz, unresolved

// Of the run file of a model under `runs/`, without its ending.
std::string run_name(std::string const& model_hash, std::uint64_t seed);

// What a trace leaves to judge a point by.
struct TracedLight {
  CouplingTable coupling;
  std::vector<ObjectRow> objects;  // light per history
};

class Scanner {
 public:
  static constexpr double frequencies[] = {10, 30, 100};  // Hz

  // `folder`: where runs are kept, by hash; empty: nowhere.
  Scanner(ScanOptions options, Requirement requirement, std::string folder);
  // Before any trace: throws one InputError with all problems and the points that have them, of up to 20 points.
  void check(ScanList const&) const;
  // Throws InputError for a model that cannot be read or has no noise, with the settings of the point at the end.
  Model model_at(std::vector<std::string> const& settings) const;
  // `look`: gets what the point is judged by.
  using Look = std::function<void(Model const&, TracedLight const&, NoiseBudget const&)>;
  ScanPoint at(std::vector<std::string> const& settings, Look const& look = {});
  // Runs that this scan has made already, by name: they count as traced, not as stored.
  void made(std::set<std::string> runs) { made_ = std::move(runs); }
  std::string const& line() const { return line_; }  // as the last point named it

 private:
  std::shared_ptr<TracedLight const> trace_of(Model& model, ScanPoint& point);

  ScanOptions options_;
  Requirement requirement_;
  std::string folder_, line_, told_;  // the warnings of the last point
  std::set<std::string> made_;
  std::map<std::string, std::shared_ptr<TracedLight const>> traced_;  // by hash and seed
};

// Points of a scan traced by several processes. Each run is what one process alone would have written, bit for bit: a
// trace depends on model, seed and histories only.

// Fills `runs/` of the folder with the traces that the points need, at most `jobs` at a time, each model once. The
// names of the run files that were made or continued. The scan that follows reports problems of a point.
std::set<std::string> trace_together(std::vector<std::vector<std::string>> const& points, ScanOptions const&,
                                     Requirement const&, unsigned jobs, std::atomic<bool> const& stop);

// The table of a scan as text, for spreadsheets and pictures.

struct ScanTable {
  std::string model, line;  // file name; "0.1 x adv-lal", empty: not compared
  std::vector<ScanAxis> axes;
  std::vector<ScanPoint> points;
  std::size_t wanted = 0;  // points requested
};

std::string scan_text(ScanTable const&);
std::string scan_csv(ScanTable const&);  // all digits
std::string scan_json(ScanTable const&);

}  // namespace straytrace::session
