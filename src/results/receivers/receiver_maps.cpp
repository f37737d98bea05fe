// SPDX-License-Identifier: BSD-3-Clause
// Maps of receivers as CSV and NPY. Row 0 is the lowest row, column 0 the leftmost column, seen
// from the front, with e1 to the right and e2 up.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "results/receivers/receivers.hpp"
#include "results/text/columns.hpp"

namespace straytrace::results {
namespace {

static_assert(std::endian::native == std::endian::little);

// Version 1.0 of the format of numpy.save; the header is padded so that the data begin at a multiple of 64 bytes.
template <class T>
std::string npy(std::vector<T> const& values, std::size_t rows, std::size_t columns) {
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}",
                                   std::is_same_v<T, double> ? "<f8" : "<c16", rows, columns);
  header.append(63 - (10 + header.size()) % 64, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += char(header.size() & 0xff);
  bytes += char(header.size() >> 8);
  bytes += header;
  return bytes.append(reinterpret_cast<char const*>(values.data()), values.size() * sizeof(T));
}

struct Grid {
  std::size_t rows = 0, columns = 0;
  double half_x = 0, half_y = 0;
  std::string x, y, area;  // titles with units
  std::string words() const {
    return fmt::format("{} columns x {} rows, from the lower left row by row", columns, rows);
  }
  double centre_x(std::size_t i) const { return half_x * (2 * (double(i % columns) + 0.5) / double(columns) - 1); }
  double centre_y(std::size_t i) const { return half_y * (2 * (double(i / columns) + 0.5) / double(rows) - 1); }
};

std::string vector_text(Vec3 v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }

std::string map_header(RunContent const& run, std::string const& name, Receiver const& r, std::string const& what) {
  std::string text = file_header(run) + fmt::format("# receiver {}, {}, seen from the front\n", name, what);
  text += fmt::format("# centre {} m, x along {}, y along {}, front {}\n", vector_text(r.frame.origin),
                      vector_text(r.frame.e1), vector_text(r.frame.e2), vector_text(r.frame.e3));
  if (run.beam_power > 0) return text + fmt::format("# main mode: {} W\n", run.beam_power);
  return text + "# no beam states its power: values are per watt of the main mode\n";
}

class MapWriter {
 public:
  MapWriter(std::string folder, RunContent const& run) : folder_(std::move(folder)), run_(run) {}

  void receiver(std::string const& name, Receiver const& r, ReceiverSums const& sums,
                std::vector<double> const& areas) {
    name_ = name;
    std::string file = name;
    std::replace(file.begin(), file.end(), '/', '_');
    Grid const image{r.rows, r.columns, r.half_width, r.half_height, "x_m", "y_m", "area_m2"};
    Grid const angles{r.angle_bins, r.angle_bins, r.half_angle_sine, r.half_angle_sine,
                      "cosine_x",   "cosine_y",   "area_cosine2"};
    if (r.by_light) cells(file + "_image", r, sums, areas);
    if (r.columns > 0) {
      watts(file + "_image", r, image, sums.image, areas, irradiance_words(), "irradiance");
      field(file + "_field", r, image, field_map(r, sums, run_.trace->total.histories, areas));
    }
    if (r.angle_bins > 0) {
      double const side = 2 * r.half_angle_sine / r.angle_bins;
      watts(file + "_angles", r, angles, sums.angles, std::vector(sums.angles.sum.size(), side * side),
            watt_words("direction cosine^2"), "power");
    }
    if (r.quadrants) {
      Receiver own = r;
      own.frame = r.quadrant_frame;
      quadrants(file + "_quadrants", own, sums.quadrants);
    }
  }
  std::vector<std::string> files;

 private:
  double watt() const { return run_.beam_power > 0 ? run_.beam_power : 1; }
  std::string watt_words(std::string const& per) const { return (run_.beam_power > 0 ? "W/" : "(W/W)/") + per; }
  std::string irradiance_words() const { return watt_words("m^2") + " of the area within the rim of the surface"; }
  void save(std::string const& name, std::string const& bytes) {
    write_file(folder_ + "/" + name, bytes);
    files.push_back(name);
  }

  // `areas`: of the pixels in m^2, or in direction cosines squared.
  void watts(std::string const& name, Receiver const& r, Grid const& g, MapSums const& map,
             std::vector<double> const& areas, std::string const& unit, std::string const& what) {
    CellEstimates cells = cell_estimates(map, run_.trace->total.histories, run_.trace->total.blocks);
    for (auto* list : {&cells.mean, &cells.error})
      for (std::size_t i = 0; i < list->size(); ++i) (*list)[i] *= watt() / areas.at(i);
    std::string text = map_header(run_, name_, r, g.words());
    text += fmt::format(
        "# {0} and sigma (one standard error) in {1}; nan: no light seen there, or sigma not resolved\n", what, unit);
    text += fmt::format("column,row,{},{},{},sigma,{}\n", g.x, g.y, what, g.area);
    for (std::size_t i = 0; i < cells.mean.size(); ++i)
      text += fmt::format("{},{},{},{},{},{},{}\n", i % g.columns, i / g.columns, g.centre_x(i), g.centre_y(i),
                          csv_number(true, cells.mean[i]), csv_number(true, cells.error[i]), areas[i]);
    save(name + ".csv", text);
    save(name + ".npy", npy(cells.mean, g.rows, g.columns));
    save(name + "_sigma.npy", npy(cells.error, g.rows, g.columns));
  }

  // A row per cell. The field is that of the same cells.
  void cells(std::string const& name, Receiver const& r, ReceiverSums const& sums, std::vector<double> const& areas) {
    char const* const sides[] = {"x_low_m,x_high_m,y_low_m,y_high_m",
                                 "radius_low_m,radius_high_m,angle_low_rad,angle_high_rad",
                                 "along_low_m,along_high_m,arc_low_m,arc_high_m"};
    CellEstimates const all = cell_estimates(sums.image, run_.trace->total.histories, run_.trace->total.blocks);
    FieldMap const wave = field_map(r, sums, run_.trace->total.histories, areas);
    bool const coherent = !wave.field.empty();
    std::string text = map_header(run_, name_, r,
                                  fmt::format("{} cells of a {} chart, fine where the light is", r.cells.size,
                                              chart_names[std::size_t(r.chart)]));
    text += fmt::format(
        "# irradiance and sigma (one standard error) in {}; nan: no light seen there, or sigma not resolved\n",
        irradiance_words());
    if (coherent)
      text += fmt::format("# real, imaginary: coherent field in {}; coherence as of pixels\n",
                          run_.beam_power > 0 ? "sqrt(W)/m" : "sqrt(W/W)/m");
    text += fmt::format("cell,{},area_m2,irradiance,sigma{}\n", sides[std::size_t(r.chart)],
                        coherent ? ",real,imaginary,coherence" : "");
    for (std::size_t i = 0; i < r.cells.size; ++i) {
      auto const& [u_low, u_high, v_low, v_high] = r.cells[i];
      double const scale = watt() / areas.at(i);
      text += fmt::format("{},{},{},{},{},{},{},{}", i, u_low, u_high, v_low, v_high, areas[i],
                          csv_number(true, scale * all.mean[i]), csv_number(true, scale * all.error[i]));
      if (coherent) {
        bool const seen = !std::isnan(wave.coherence[i]);
        std::complex<double> const e = std::sqrt(watt()) * wave.field[i];
        text += fmt::format(",{},{},{}", csv_number(seen, e.real()), csv_number(seen, e.imag()),
                            csv_number(seen, wave.coherence[i]));
      }
      text += '\n';
    }
    save(name + ".csv", text);
  }

  void field(std::string const& name, Receiver const& r, Grid const& g, FieldMap map) {
    if (map.field.empty()) return;
    for (auto& e : map.field) e *= std::sqrt(watt());
    std::string const unit = run_.beam_power > 0 ? "sqrt(W)/m" : "sqrt(W/W)/m";
    std::string text = map_header(run_, name_, r, g.words());
    text += fmt::format("# coherent field of free beams: sum over routes of sqrt(irradiance) e^(i phase), {}\n", unit);
    text += "# irradiance of the coherent light: real^2 + imaginary^2; phase in rad; nan: no light seen there\n";
    text += "# coherence: smallest share of a route in phase with its mean within the pixel; near 1 or too coarse\n";
    text += fmt::format("column,row,{},{},real,imaginary,phase,coherence\n", g.x, g.y);
    for (std::size_t i = 0; i < map.field.size(); ++i) {
      bool const seen = !std::isnan(map.coherence[i]);
      text += fmt::format("{},{},{},{},{},{},{},{}\n", i % g.columns, i / g.columns, g.centre_x(i), g.centre_y(i),
                          csv_number(seen, map.field[i].real()), csv_number(seen, map.field[i].imag()),
                          csv_number(seen, std::arg(map.field[i])), csv_number(seen, map.coherence[i]));
      if (!seen) map.field[i] = {not_a_number, not_a_number};
    }
    save(name + ".csv", text);
    save(name + ".npy", npy(map.field, g.rows, g.columns));
    save(name + "_coherence.npy", npy(map.coherence, g.rows, g.columns));
  }

  void quadrants(std::string const& name, Receiver const& r, MapSums const& map) {
    CellEstimates const cells = cell_estimates(map, run_.trace->total.histories, run_.trace->total.blocks);
    std::string text = map_header(run_, name_, r, Grid{2, 2, 0, 0, "", "", ""}.words());
    text += fmt::format(
        "# gap {} m; power and sigma in {}; nan: no light seen there, or sigma not resolved\n"
        "quadrant,power,sigma\n",
        r.gap, run_.beam_power > 0 ? "W" : "W/W");
    char const* const names[] = {"lower_left", "lower_right", "upper_left", "upper_right", "gap"};
    for (std::size_t i = 0; i < cells.mean.size(); ++i)
      text += fmt::format("{},{},{}\n", names[i], csv_number(true, watt() * cells.mean[i]),
                          csv_number(true, watt() * cells.error[i]));
    save(name + ".csv", text);
  }

  std::string folder_, name_;
  RunContent const& run_;
};

}  // namespace

std::vector<std::string> write_maps(std::string const& folder, RunContent const& run,
                                    std::vector<std::vector<double>> const& areas) {
  MapWriter writer(folder, run);
  std::vector<std::string> const& names = run.trace->coupling.receivers;
  for (std::size_t i = 0; i < names.size(); ++i)
    writer.receiver(names[i], run.receivers.at(i), run.trace->total.receivers.at(i), areas.at(i));
  return writer.files;
}

}  // namespace straytrace::results
