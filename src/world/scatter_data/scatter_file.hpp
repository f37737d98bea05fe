// SPDX-License-Identifier: BSD-3-Clause
// Files of measured scatter of all formats, as points of a BSDF with directions from the normal.
// Formats: docs/reference/scatter/measured_files.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/errors.hpp"
#include "optics/scatter/measured.hpp"

namespace straytrace::world {

// Declarations about a measurement in a file, a scene or a command line.
struct ScatterDeclared {
  double wavelength = 0;                                    // m; 0: not declared, NaN: reported as wrong
  std::string angles = {};                                  // from_normal, from_specular; empty: not declared
  std::string polarisation_in = {}, polarisation_out = {};  // s, p, unpolarised, both; empty: not declared
  double noise_floor = -1;                                  // 1/sr; 0: none; below 0: not declared
  double theta_i = -1;                                      // rad, of all points; below 0: not declared
  std::string entry = {};                                   // name in a catalogue
};

struct ScatterPoint {
  double theta_i = 0;  // rad, 0 to below pi/2
  double theta_s = 0;  // rad from the normal, positive on the side of the specular direction; NaN: only offset known
  double phi = 0;      // rad, azimuth of scatter; 0 in the plane of incidence
  double offset = 0;   // |alpha - alpha_0| in direction cosines
  double value = 0;    // BSDF in 1/sr, 0 and up
  double error = 0;    // one standard error, 1/sr; 0: not given
  bool limit = false;  // an upper limit: at or below the noise floor
  std::uint32_t line = 0, column = 0;  // of the value in the file
};

// The total that a file states for an incidence, and the integral of its own table over the hemisphere.
struct StatedTis {
  double theta_i = 0, stated = 0, integral = 0;  // rad, share of the power
};

struct ScatterFile {
  std::string format;  // "laboratory CSV"; empty: not read
  ScatterDeclared declared;
  bool transmitted = false;        // a BTDF
  std::vector<std::string> notes;  // how the file was read, a sentence each
  std::vector<ScatterPoint> points;
  std::vector<StatedTis> stated;
  std::size_t incidences_left_out = 0;  // beyond the limit of the BSDF model
};

// Incidence and scatter in rad from the normal, azimuth of scatter (0: on the side of the specular direction).
ScatterPoint scatter_point(double theta_i, double theta_s, double phi, double value);

// Problems carry line and column. `given` counts where the file declares nothing, and must not contradict the file.
ScatterFile read_scatter_file(std::string_view text, ScatterDeclared const& given, std::vector<Problem>& problems);

// Points of one incidence each, in increasing incidence, in the order of the file.
std::vector<std::vector<ScatterPoint>> by_incidence(std::vector<ScatterPoint> const&);

// Requires several angles of scatter for each incidence.
void check_scatter_points(std::vector<ScatterPoint> const&, std::vector<Problem>&);

// As SSDD, on the grid of the measured directions. Empty, with `why`, if they form neither a grid nor planes.
std::string ssdd_text(ScatterFile const&, std::string_view beyond, std::string& why);

// Readers of single formats.
ScatterDeclared read_declarations(std::string_view text, std::vector<Problem>&);
void read_scatter_columns(std::string_view text, ScatterFile&, std::vector<Problem>&);
void read_zemax_table(std::string_view text, ScatterFile&, std::vector<Problem>&);
void read_abg_catalogue(std::string_view text, ScatterFile&, std::vector<Problem>&);
void read_astm(std::string_view text, ScatterFile&, std::vector<Problem>&);
void read_ssdd(std::string_view text, ScatterFile&, std::vector<Problem>&);

// A warning follows where the stated total and the integral of the values differ by more, relative.
constexpr double stated_tis_tolerance = 0.05;

// The BSDF model of measured points, without its sampling table, which prepare() makes. `beyond`: constant, power or
// zero.
Measured law_of_points(std::vector<ScatterPoint> const&, std::string_view beyond, MeasuredSummary&);

}  // namespace straytrace::world
