// SPDX-License-Identifier: BSD-3-Clause
// Light of the field of a cavity beside its axis: irradiance by rings and sectors, and photodiodes.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

#include "wave/arm/arm_cavity.hpp"
#include "wave/cavity.hpp"
#include "wave/diodes/photodiode.hpp"

namespace straytrace::wave {

// Irradiance of the field of a cavity on its planes, by rings and sectors about the axis.

// |psi|^2 of the light that arrives at a plane, before its mask, over the power of the mode: means over cells of equal
// width in radius and azimuth. Ring i holds radii from i to i + 1 times `step`; sector j azimuths from j to j + 1 times
// 2 pi/sectors, from x towards y of the frame of the cavity. A ring with fewer points of the grid than sectors has the
// mean over the whole ring in each sector.
struct PolarIrradiance {
  double step = 0;  // m
  int rings = 0, sectors = 0;
  std::vector<float> mean;    // of |psi|^2, 1/m^2, [ring * sectors + sector]
  std::vector<float> square;  // of |psi|^4, 1/m^4: with speckle twice the square of the mean

  double radius(int ring) const { return (ring + 0.5) * step; }  // m
  double azimuth(int sector) const;                              // rad
  double cell_area(int ring) const;                              // m^2
  double ring_mean(double radius) const;  // of |psi|^2 over the azimuth, 1/m^2; 0 outside of the rings
  // Share of the power of the mode on a ring between two radii.
  double power(double from, double to) const;
  // In each sector, the share that falls beyond the edge of an opening about the axis.
  std::vector<double> beyond(RoundHole const&) const;
};

// Of all planes of a cavity, in the order of `Arrival::plane`.
struct PlaneIrradiance {
  std::vector<PolarIrradiance> towards_mirror2, towards_mirror1;  // empty where light does not arrive
  PolarIrradiance const& of(int plane, Travel) const;
};

// Collects the irradiance of all arrivals of round trips, whose mean is the result.
class IrradianceMeter {
 public:
  IrradianceMeter(Grid const&, std::size_t planes);
  void operator()(Arrival const&);
  PlaneIrradiance result() &&;

 private:
  double step_;
  int rings_;
  std::vector<std::int32_t> cell_;    // of each point of the grid; -1: outside of the rings
  std::vector<std::int32_t> points_;  // in each cell
  int round_trips_ = 0;
  PlaneIrradiance result_;  // sums
};

// What the photodiodes of a table `wave` are expected to receive, over mirrors whose heights are not known
// (docs/theory/wave.md, eq. W.17, W.40 to W.43).

// Puts those of the table into the frame of a cavity with its mirrors and edges; their planes are to hold the light
// that meets them, and without a stated crossover angle the grid as well. A problem where their screen is not between
// the mirrors.
void place_diodes(WaveSettings const&, ArmCavity&);

// Of the light that reaches the farthest point of a diode from the mirror that it comes from, rad. The grid holds it up
// to the crossover angle.
double diode_angle(ArmCavity const&, Photodiode const&);

struct DiodeExpectation {
  std::vector<Photodiode> diodes;
  Eigen::VectorXd smooth;  // without the light that unknown heights scatter; over the power of the mode
  HaloStatistics halo;
};
// Solves the cavity with its stated heights alone. Throws as arm_cavity, and InputError where it has no mode.
DiodeExpectation expected_on_diodes(World const&, WaveSettings const&, HaloMoments, Computing);

}  // namespace straytrace::wave
