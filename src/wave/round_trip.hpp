// SPDX-License-Identifier: BSD-3-Clause
// The way of the light once around a cavity, linear, folded or ring, and the modes that come back to themselves
// (docs/theory/wave.md, eq. W.8, W.9, W.24, W.53 to W.55).
#pragma once

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "wave/field.hpp"
#include "wave/lines/line_kernels.hpp"
#include "wave/transform.hpp"
#include "wave/wave_device.hpp"

namespace straytrace::wave {

// What a field meets on its way: openings, mirrors and the free space between planes (docs/theory/wave.md, eq. W.1 to
// W.7).

struct RoundHole {
  double radius = 0;    // m
  double x = 0, y = 0;  // of its centre, m
  double cosine = 1;    // of the angle by which its plane is turned about y: seen along the axis, its half axis along x
                        // is radius * cosine
  bool operator==(RoundHole const&) const = default;
};

// Transmission of amplitude of an opening: its Fourier series, cut at Nyquist's frequency, so that it overshoots by a
// few percent next to the rim (eq. W.7).
class Mask {
 public:
  Mask(RoundHole const&, Grid const&, Transform const&);
  // Sum of |values|^2 beyond the rim, exact for a field below Nyquist's frequency over sqrt(2): the power on the
  // screen, without the ripple of the series.
  double clipped(Field const&) const;
  std::vector<double> const& values() const { return values_; }
  // Rows and columns about the axis beyond which nothing passes: the opening and the reach of the ripple, which changes
  // losses by less than 1e-6 of themselves.
  int rows() const { return rows_; }
  int columns() const { return columns_; }

 private:
  std::vector<double> values_;
  int rows_, columns_;
};

// A mirror, seen by the light that falls on it. Left out: its reflectivity, which multiplies the eigenvalue.
struct WaveMirror {
  double curvature = 0;           // 1/RoC, positive when concave. 1/m
  RoundHole outline;              // clear aperture; its cosine is that of the angle of incidence (eq. W.55)
  double tilt_x = 0, tilt_y = 0;  // turns the reflected beam by twice this towards +x, +y. rad
  std::vector<double> height;     // towards the light, without the curvature, on the grid across it; empty: none. m
  double scattered = 0;           // power that it scatters beyond the crossover angle (eq. W.2)
  double lit = 0;                 // m, distance from the axis up to which light around it is wanted
};
// eq. W.1, W.55: its factor on the grid. `wavefront`: curvature of the wave that the grid follows to it less that of
// the wave from it (eq. W.54), 1/m.
Field reflection(WaveMirror const&, Mask const& outline, double wavelength, Grid const&, double wavefront = 0);

// Free space with a smooth limit of angles: 1 below `keep`, 0 from `cut` on (eq. W.3 to W.6). The limit lies some
// widths sqrt(lambda/length) of Fresnel diffraction beyond the largest angle between points that matter at both ends.
class Leg {
 public:
  // `reach`: sum of the radii of the two planes up to which light matters, m. InputError if the window is too
  // narrow for it.
  Leg(double length, double reach, double wavelength, Grid const&);

  double length() const { return length_; }
  double cut() const { return cut_; }       // rad
  int columns() const { return columns_; }  // for Transform: all frequencies below `cut`
  LegTables tables() const;                 // as long as the leg exists
  void apply(Field& spectrum, int threads = 1) const;

 private:
  double length_, keep_, cut_;
  double angle_step_;  // rad per element of the spectrum
  double quartic_;     // of the exponent beyond the paraxial one, per rad^4; 0 where it does not matter
  int columns_;
  std::vector<double> paraxial_;  // cos, sin by frequency
  std::vector<double> taper_;     // w_j of eq. W.4, of the angle squared between keep^2 and cut^2
};

// Eigenvalues of the round trip of a field, from the field after each of a few round trips (docs/theory/wave.md, eq.
// W.9).

// The elements of a spectrum below a frequency [1/m], as a vector.
class SpectrumDisc {
 public:
  SpectrumDisc() = default;
  SpectrumDisc(Grid const&, double largest_frequency);
  Eigen::VectorXcd pack(Field const& spectrum) const;
  void unpack(Eigen::VectorXcd const&, Field& spectrum) const;

 private:
  std::vector<std::size_t> at_;
};

// An eigenvalue with its eigenvector.
struct RitzPair {
  Complex value;
  double residual = 0, overlap = 0;  // eq. W.9; share of amplitude in the starts
  Eigen::VectorXcd coordinates;      // of the eigenvector, in the basis of Arnoldi
};

// Arnoldi's orthonormal vectors of one or several starts s, G s, G^2 s, ... and the matrix of G between them. With
// several starts, eigenvalues of one size keep as many eigenvectors apart.
class Krylov {
 public:
  explicit Krylov(Eigen::VectorXcd const& start, int threads = 1)
      : Krylov(std::vector<Eigen::VectorXcd>{start}, threads) {}
  explicit Krylov(std::vector<Eigen::VectorXcd> const& starts, int threads = 1);

  int steps() const { return int(matrix_.cols()); }
  int starts() const { return starts_; }  // that are independent
  std::vector<Eigen::VectorXcd> const& vectors() const { return vectors_; }
  Eigen::VectorXcd const& next() const { return vectors_[std::size_t(steps())]; }  // whose image `extend` takes
  // `image` is G times `next()`. False when nothing new is left to map.
  bool extend(Eigen::VectorXcd image);
  Eigen::MatrixXcd const& matrix() const { return matrix_; }
  std::vector<RitzPair> ritz() const;  // by overlap with the starts, largest first
  Eigen::VectorXcd vector(RitzPair const&) const;

 private:
  // Takes the shares of the vectors out of one; the shares. The same bits for any number of threads.
  Eigen::VectorXcd orthogonalise(Eigen::VectorXcd&) const;

  unsigned threads_;
  std::vector<Eigen::VectorXcd> vectors_;
  int starts_ = 0;
  Eigen::MatrixXcd matrix_;  // Hessenberg with as many subdiagonals as starts; rows: vectors, columns: steps
};

// What the light meets at the end of a leg: an opening, or a mirror with this outline. Coordinates are those of the
// light that comes; a mirror leaves them as they are, so that behind it they are those of the image of the frame.
struct TripStop {
  double leg = 0;     // from the stop before it, m
  RoundHole opening;  // of a mirror: its outline
  std::optional<WaveMirror> mirror;
  double scale = 1;  // pitch of the grid over that at the last stop, where it is 1 (eq. W.54)
  double lit = 0;    // m, distance from the axis up to which light beside the opening is wanted
};
struct Trip {
  double wavelength = 0;        // m
  Grid grid;                    // at the last stop
  std::vector<TripStop> stops;  // the last is the mirror where the round trip begins
  bool mirrored = false;        // x of the frame that comes back is -x of that of the start (eq. W.53)
};

// A Gaussian beam along one axis across it: 1/e^2 radius [m], and curvature of the wavefront [1/m], positive where it
// diverges; centre [m] and direction of travel [rad].
struct AxisBeam {
  double radius = 0, curvature = 0, centre = 0, slope = 0;
};

// Where the power of a field of unit power goes in one round trip (eq. W.24).
struct TripLosses {
  std::vector<double> taken;  // by each stop; by a mirror: beyond its outline, and scattered beyond the crossover angle
  double beyond_band = 0;     // at angles that reach no opening
  double total() const;
};

// A mode of the cavity without the transmission of its mirrors: after the reflection by the last mirror of the round
// trip, in the plane of it.
struct WaveMode {
  Complex eigenvalue;                                        // of the round trip, without exp(ikL) of its length
  double residual = 0;                                       // norm of G E - gamma E (eq. W.9)
  int round_trips = 0;                                       // that the search took
  Field spectrum;                                            // of unit power
  double loss() const { return 1 - std::norm(eigenvalue); }  // of power per round trip
};

struct SolveOptions {
  int most_round_trips = 60;
  double loss_error = 1e-3;  // relative, or of 1e-9 per round trip: ten times what two more round trips change
  std::function<void(int round_trips, double residual)> progress;  // after each round trip
};

class RoundTrip {
 public:
  // InputError: eq. W.6, as Leg; or the field does not fit into the memory of the device.
  explicit RoundTrip(Trip, Computing = {});
  ~RoundTrip();
  RoundTrip(RoundTrip&&) noexcept;
  Trip const& trip() const;
  Transform const& transform() const;
  int threads() const;
  Computing computing() const;
  Mask const& mask(std::size_t stop) const;
  SpectrumDisc const& band() const;  // frequencies at the start of the fields of which modes are made
  // Another surface of the mirror at a stop, as WaveMirror::height.
  void set_height(std::size_t stop, std::vector<double>);

  // Spectrum of a Hermite-Gauss mode after the last mirror, n quanta along x and m along y. Unit power.
  Field hermite_gauss(AxisBeam x, AxisBeam y, int n = 0, int m = 0) const;
  // eq. W.8, in place. The fields that arrive at a stop before its mask are shown in order of the way. Multiplied by
  // exp(i pi curvature rho^2/lambda) and divided by the scale they are those of the light, on a grid of pitch times
  // scale (eq. W.54).
  void travel(Field& spectrum, Watch const& = {}) const;
  // The mode that shares most with `start`, a spectrum after the last mirror. NumericalError if none is found.
  WaveMode mode(Field const& start, SolveOptions const& = {}) const;
  TripLosses losses(WaveMode const&) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace straytrace::wave
