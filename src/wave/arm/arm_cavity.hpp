// SPDX-License-Identifier: BSD-3-Clause
// The cavity of a scene as planes of a wave computation: frame, grid, crossover angle, mirrors and rims
// (docs/theory/wave.md).
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "wave/cavity.hpp"
#include "wave/cavity_rims.hpp"
#include "wave/diodes/photodiode.hpp"
#include "wave/heights/height_map.hpp"
#include "world/ghosts/obstacle.hpp"
#include "world/model/wave_settings.hpp"

namespace straytrace::wave {

// z from mirror 1 to mirror 2, from its centre.
struct CavityFrame {
  Vec3 origin, x, y, z;
  Vec3 to_local(Vec3 p) const { return {dot(p - origin, x), dot(p - origin, y), dot(p - origin, z)}; }
  Vec3 to_world(Vec3 v) const { return v.x * x + v.y * y + v.z * z; }  // of a direction
};

// A mirror of the cavity: its spot and what it scatters at an angle from the specular direction.
struct ArmMirror {
  SurfaceId surface;
  double radius = 0, curvature = 0, spot = 0;  // clear aperture [m], 1/RoC [1/m], 1/e^2 radius of the mode [m]
  double scattered = 0;                        // beyond the crossover angle (eq. W.2)
  double roughness = 0;                        // rms of its heights in the map, m
  Vec3 travel{};                               // of the light that falls on it
  std::uint32_t footprint = 0;                 // of the mode on it
};
// BRDF [1/sr] of a mirror that the beam meets at its centre, by the angle from the specular direction [rad]. The world
// must outlive it.
class MirrorBrdf {
 public:
  MirrorBrdf(World const&, ArmMirror const&, Vec3 travel);
  double operator()(double angle) const;

 private:
  WorldView view_;
  Optic optic_;
};
// Share of the light that it scatters at angles below the crossover.
double scattered_within(World const&, ArmMirror const&, double crossover);
// The BRDF of each of its BSDF models that reflects.
std::vector<std::function<double(double angle)>> mirror_models(World const&, ArmMirror const&);

struct ArmRim {
  SurfaceId surface;
  InnerRim rim;                   // in the world
  Vec3 centre;                    // in the frame of the cavity, m
  double angle1 = 0, angle2 = 0;  // from the mirrors, rad
  bool in_band = false;           // both within the crossover angle: the grid holds the light that meets it
};

// An error or a warning about the table `wave`.
struct ArmProblem {
  std::vector<std::string> keys;  // below `wave`, of the value that causes it; where it is absent, of the next above
  std::string what, remedy;
  Severity severity = Severity::error;
  std::optional<Place> in_file = {};  // line and column in the file of heights that `keys` name
  bool of_noise = false;              // it matters where something moves
};

void throw_errors(std::vector<ArmProblem> const&);  // InputError with all of them
// Heights of mirrors that no map states: drawn with their seed, or left out.
enum class RandomHeights : bool { left_out, drawn };

struct ArmCavity {
  CavityFrame frame;
  std::array<ArmMirror, 2> mirrors;
  std::array<std::optional<HeightMap>, 2> maps;  // as measured, without the low orders that the scene removes
  std::vector<ArmRim> rims;                      // in order of place; the baffles of `cavity` are these
  double crossover = 0;                          // rad
  WaveCavity cavity;
  std::vector<Photodiode> diodes;
  std::vector<ArmProblem> problems;
  std::vector<std::string> warnings;  // of the solution
};
// Frame, rims, crossover angle, grid and measured maps, with all that is wrong with them; no field and no heights.
ArmCavity planned_arm(World const&, WaveSettings const&);
// With the heights of the mirrors. Throws InputError with all errors of the plan.
ArmCavity arm_cavity(World const&, WaveSettings const&, ArmCavity planned, RandomHeights = RandomHeights::drawn);
inline ArmCavity arm_cavity(World const& world, WaveSettings const& settings) {
  return arm_cavity(world, settings, planned_arm(world, settings));
}
// The heights of its mirrors with other random numbers; draw 0 is that of `arm_cavity`.
std::array<std::vector<double>, 2> drawn_heights(World const&, WaveSettings const&, ArmCavity const&,
                                                 std::uint32_t draw);
double height_rms(std::vector<double> const& heights);

// As stated, or chosen from mirrors and edges, rad.
double crossover_angle(World const&, WaveSettings const&);
// Leaves the light that the mirrors of the table `wave` scatter below the crossover angle to the field: their rays
// begin there (eq. W.20). Once, before the trace.
void begin_rays_at_crossover(World&);

// The curve of a rim in the frame of the cavity, teeth included, displaced and widened [m].
RimCurve curve_of(ArmCavity const&, ArmRim const&, Vec3 displacement = {}, double wider = 0);

}  // namespace straytrace::wave
