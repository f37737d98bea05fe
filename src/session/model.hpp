// SPDX-License-Identifier: BSD-3-Clause
// A scene read by all modules: the model that is traced, and the part of it that projects noise.
#pragma once

#include <nlohmann/json.hpp>

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "motion/motion.hpp"
#include "noise/bands/input_band.hpp"
#include "noise/noise.hpp"
#include "results/results.hpp"
#include "scene/model_tree.hpp"
#include "scene/scene.hpp"
#include "wave/arm/arm_cavity.hpp"
#include "wave/ring/ring_cavity.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
struct RingRecord;
struct WaveRecord;
}  // namespace straytrace::wave

namespace straytrace::results {
struct SeamCheck;
}  // namespace straytrace::results

namespace straytrace::session {

// When a trace ends: by error, by number, by clock; whichever comes first.
struct StopRule {
  // total, routes: largest relative error of these curves in the band; receiver: of its power; route: of its coupling.
  struct Goal {
    enum class Of { total, routes, receiver, route } of = Of::total;
    std::string name;  // of the receiver or route; "*": all, of the routes those with more than 1 % of their end
    double relative_error = 0;
  };
  struct Complaint {
    std::string what, suggestion;
  };
  std::vector<Goal> goals;  // all must hold
  double max_seconds = std::numeric_limits<double>::infinity();
  std::string error_rule;  // the part about errors, in words
  bool by_error() const { return !goals.empty(); }
  double wanted_error() const;  // the smallest of the goals
};
// "h_total < 5 %" (or "h < 5 %"), "routes < 10 %", "receiver:PD1 < 5 %", "class:* < 10 %", "10 min", or several with
// commas. Throws InputError.
StopRule parse_stop_rule(std::string const&);
// "50min", "1 h" or "90 s", in s. Throws InputError.
double parse_duration(std::string const&);

inline constexpr std::uint64_t no_limit = 1ull << 36;   // histories
inline constexpr std::uint64_t fewest_histories = 256;  // for errors: 32 blocks of 8

// Inputs of the projection of a coupling table to strain noise: motion, interferometer, band and design curves, without
// surfaces and search structure, so that a run file is opened without them.
struct ProjectionModel {
  Scene scene;
  ProjectionInputs traced;  // `materials` and the texts are there once the model has no problems
  MotionSet motion;
  std::unique_ptr<Interferometer> detector;  // none: light on receivers only, no noise
  NoiseSettings noise;
  std::vector<DesignCurve> design;
  std::size_t paths_shown = 12;
  std::string warnings;       // rendered: of the scene, or of the file that its motion was taken from instead
  std::string warnings_json;  // the same for editors: JSON lists

  NoiseBudget project(CouplingTable const&) const;
  NoiseBudget project_with_bands(CouplingTable const&) const;  // input and speckle bands too
  std::vector<std::string> assumptions() const;                // lines for reports
};

struct Model : ProjectionModel {
  World world;
  std::optional<wave::ArmCavity> arm;    // plan of the field of the table `wave`, of two mirrors
  std::optional<wave::RingCavity> ring;  // of three mirrors or more
  std::uint64_t seed = 1, histories = 0;
  bool histories_stated = false;  // by the scene: an upper limit for every stop rule
  StopRule until;
  // Of the table `wave`, once it is solved; before, of an earlier run: its key tells whether it is of this model.
  std::shared_ptr<WaveRecord const> waves;
  std::shared_ptr<wave::RingRecord const> ring_waves;  // of a ring or folded cavity, solved or of an earlier run

  std::shared_ptr<results::SeamCheck const> seam;  // of the histories of an earlier run, or of this one

  std::string hash() const;  // of everything that decides the trace
};

// Worst error over the goals, scaled so that all hold when it is below wanted_error().
double stop_rule_error(StopRule const&, Model const&, CouplingTable const&);
// Names of the rule that the model lacks.
std::optional<StopRule::Complaint> complaint_about(StopRule const&, Model const&);

// Reads the scene and everything in it; throws one InputError with all problems. `texts`: of a run file, instead of
// disk.
Model read_model(std::string const& file, std::vector<std::string> const& overrides, FileTexts const* texts = nullptr);
// The part of a traced model that projects noise, from the texts of its run file: no surface is built.
ProjectionModel read_projection_model(std::string const& file, std::vector<std::string> const& overrides,
                                      FileTexts const& texts, ProjectionInputs const&);
// The same with motion, noise and interferometer, or responses of its ports alone, taken from another file where it
// gives them. `texts`: of a run file, instead of disk; `read`: gets the texts that were read; `responses`: it must hold
// some.
void replace_motion(ProjectionModel&, std::string const& file, FileTexts const* texts, FileTexts* read,
                    bool responses = false);
// The motion in a file with nothing to trace, as far as it can be judged without a run: with all problems that
// `straytrace noise --motion` tells of any run. Warnings are left in the scene.
MotionSet read_motion_file(Scene const&);
// Warns of files of motion that do not cover the band of the noise; at `table` those that stand elsewhere.
void warn_of_gaps(MotionSet const&, NoiseSettings const&, Node const& table, double wavelength_m);

// Every key with its value in SI, its origin, and how the readers ask for it (type, unit, range, default, choices).
nlohmann::ordered_json model_as_json(Scene const&);

}  // namespace straytrace::session
