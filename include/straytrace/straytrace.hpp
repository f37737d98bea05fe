// SPDX-License-Identifier: BSD-3-Clause
/** @file
 * The C++ library of straytrace: read a scene, trace its light, project motion to strain noise, rank the paths.
 *
 * @code
 * using namespace straytrace::api;
 * Model const model = Model::read("arm.yaml", {"rim=48cm"});
 * Run const run = model.trace({.until = "h_total < 5 %"});
 * Noise const noise = run.noise();
 * for (Path const& path : noise.paths({.frequencies = {10, 30, 100}}).rows) ...
 * run.save("arm.h5");
 * @endcode
 *
 * All numbers are in SI units. Every error is one standard error. Strain noise is a one-sided amplitude spectral
 * density in 1/sqrt(Hz), averaged over the static phases; each value is the mean over its frequency bin. The commands
 * of straytrace call the same functions, so a run has the same bits from both. A result depends on scene, seed and
 * number of histories only, not on the number of threads.
 *
 * Objects are values that share what they hold; several threads may use one object. Scenes are read, and traces run,
 * one at a time; a trace uses all cores. The library writes nothing to stdout or stderr and installs no signal
 * handlers.
 */
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#define STRAYTRACE_API __attribute__((visibility("default")))

namespace straytrace::api {

/** Version of the library, "0.1.0". */
STRAYTRACE_API std::string version();

/** One sentence with an error, or a warning, and its reason; one with the remedy. */
struct Problem {
  std::string file;              ///< empty: no place in a file
  std::uint32_t line = 0;        ///< from 1; 0: the file as a whole
  std::uint32_t column = 0;      ///< from 1; 0: the line as a whole
  bool warning = false;          ///< false: an error
  std::string what, suggestion;  ///< `suggestion` may be empty
};

/** What is wrong with the input; all problems at once. what() is the text that the commands print. */
class STRAYTRACE_API InputError : public std::runtime_error {
 public:
  InputError(std::string const& text, std::vector<Problem> found);
  ~InputError() override;
  std::vector<Problem> const& problems() const { return *problems_; }

 private:
  std::shared_ptr<std::vector<Problem> const> problems_;
};

/** A computation failed although its input is valid. */
class STRAYTRACE_API NumericalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  ~NumericalError() override;
};

/** State of a trace. */
struct Progress {
  std::uint64_t histories = 0;
  std::uint64_t wanted_histories = 0;  ///< until the next check of the stop rule
  double seconds = 0;
  double histories_per_s = 0;
  double error = 0;         ///< relative error of what the stop rule names; NaN before its first check
  double wanted_error = 0;  ///< 0: the rule names no error
};

/** What a trace is to do; what is absent is taken from the scene. */
struct TraceSettings {
  std::optional<std::uint64_t> seed = {};
  std::optional<std::uint64_t> histories = {};
  std::string until = {};     ///< stop rule: "h_total < 5 %", "receiver:PD < 2 %", "10 min"; empty: of the scene
  unsigned threads = 0;       ///< 0: all cores
  double max_seconds = 0;     ///< 0: no limit
  std::string run_file = {};  ///< written from time to time; a run of the same scene and seed is resumed from it
  bool overwrite = false;     ///< a run of another scene or seed at `run_file`
  /** Called some times a second by the thread that called trace(). False: the trace ends with a valid result. */
  std::function<bool(Progress const&)> progress = {};
};

/** A design curve at the frequencies of a noise budget. */
struct DesignCurve {
  std::string name;
  std::vector<double> asd;  ///< 1/sqrt(Hz), one per bin; NaN outside its range
};

/** Other inputs of the noise than those of the run. */
struct NoiseSettings {
  std::string motion = {};            ///< a file with motion that replaces that of the scene
  std::vector<std::string> set = {};  ///< "steel=x2", "steel.brdf=5e-3/sr", "tube.motion=x2": straytrace noise --set
  std::string motion_text = {};       ///< of the file `motion`, which then need not exist
};

/** A value with its standard error. */
struct Value {
  double value = 0, sigma = 0;
};

/** A row of the ranked table: all paths over the same surfaces in the same order. */
struct Path {
  std::size_t rank = 0;          ///< from 1, by share of the noise; unresolved ones last
  std::string port, sequence;    ///< "ITM", "ITM·S > baffles·S > ITM·S"
  Value coupling;                ///< power that rejoins the mode over power in the mode, 1
  bool upper_bound = false;      ///< the coupling is one
  bool resolved = false;         ///< false: too few samples; numbers are hints
  std::string why_not;           ///< the reason, where it is not resolved
  Value share;                   ///< of the noise power of the band, 1; NaN without noise
  std::vector<Value> strain;     ///< 1/sqrt(Hz), one per frequency; NaN where not known
  std::string body;              ///< whose motion contributes most
  double phase_sensitivity = 0;  ///< rad/m, rms over the paths, for motion of that body
  double mean_length = 0;        ///< m, optical; NaN: not known
};

/** Which columns a path table has. */
struct PathSettings {
  std::vector<double> frequencies = {10, 30, 100};  ///< Hz
  double low = 0, high = 0;                         ///< Hz, band of the shares; 0, 0: the whole grid
};

/** The ranked table of paths. */
struct PathTable {
  std::vector<double> frequencies;  ///< Hz
  std::vector<Path> rows;           ///< by rank
  std::string text;                 ///< as `straytrace paths` prints it
};

/** Strain noise of stray light. Vectors have one value per bin, `edges` one more. */
class STRAYTRACE_API Noise {
 public:
  std::vector<double> edges;                  ///< Hz, increasing
  std::vector<double> frequency;              ///< Hz, geometric mean of the edges of the bin
  std::vector<double> asd, sigma;             ///< 1/sqrt(Hz), of the total, and its Monte Carlo error
  std::vector<double> input_low, input_high;  ///< 1/sqrt(Hz), range by the stated uncertainties; empty: none stated
  std::vector<DesignCurve> design;
  std::vector<std::string> unresolved;  ///< routes with too few samples that could matter, each with its reason
  std::vector<std::string> warnings;
  bool lower_bound() const { return !unresolved.empty(); }  ///< of `asd`
  std::string headline;                                     ///< the sentence that the commands print

  /** Strain between the bins, 1/sqrt(Hz), as the commands print it; NaN outside the band. */
  Value at(double hz) const;
  /** The paths ranked by their share of this noise. */
  PathTable paths(PathSettings const& = {}) const;

 private:
  friend class Run;
  struct Budget;
  std::shared_ptr<Budget const> budget_;
};

class Run;

/** A scene that was read and checked. */
class STRAYTRACE_API Model {
 public:
  /** Reads a scene. `set`: values by name of a parameter or by place, as option -p. Throws InputError with all
   * problems. */
  static Model read(std::string const& file, std::vector<std::string> const& set = {});
  /** The same of a text; files that it names are relative to the folder of `name`. */
  static Model of_text(std::string const& text, std::string const& name = "scene.yaml",
                       std::vector<std::string> const& set = {});

  std::string title() const;
  std::string hash() const;  ///< of everything that decides a trace, but seed and histories
  std::vector<std::string> bodies() const, ports() const, receivers() const;
  std::size_t surfaces() const;
  std::string warnings() const;  ///< as `straytrace check` prints them; may be empty

  /** Traces the light. Throws InputError, NumericalError. */
  Run trace(TraceSettings const& = {}) const;

 private:
  struct Source;
  explicit Model(std::shared_ptr<Source const>);
  std::shared_ptr<Source const> source_;
};

/** Traced light: a table of couplings, from which noise follows without tracing. */
class STRAYTRACE_API Run {
 public:
  /** Reads a run file. Throws InputError. */
  static Run open(std::string const& file);
  /** Writes a run file with the noise of its own motion; it appears complete or not at all. Throws InputError. */
  void save(std::string const& file) const;

  std::string title() const;
  std::uint64_t seed() const, histories() const;
  bool complete() const;  ///< false: stopped early, with a valid result
  std::vector<std::string> warnings() const;

  /** Strain noise. Throws InputError where the run cannot answer. */
  Noise noise(NoiseSettings const& = {}) const;
  /** The paths ranked by coupling, where there is no noise; otherwise Noise::paths(). */
  PathTable paths() const;

 private:
  friend class Model;
  struct Source;
  explicit Run(std::shared_ptr<Source const>);
  std::shared_ptr<Source const> source_;
};

}  // namespace straytrace::api
