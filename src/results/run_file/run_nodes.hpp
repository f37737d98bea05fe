// SPDX-License-Identifier: BSD-3-Clause
// Moments as columns of a run file.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/math/constants.hpp"
#include "results/run_file/run_file.hpp"

namespace straytrace::results {

inline constexpr std::size_t moment_sums = 6, moment_counts = 2;  // columns of Moments: doubles and counts
using Doubles = std::vector<double>;
using Counts = std::vector<std::uint64_t>;

// Moments laid end to end: two flat arrays.
struct MomentColumns {
  Doubles values;
  Counts numbers;

  void add(Moments const& m) {
    values.insert(values.end(), {m.sum, m.sum2, m.sum3, m.sum4, m.block_sum2, m.largest});
    numbers.insert(numbers.end(), {m.largest_history, m.scored});
  }
  Moments at(std::size_t i) const {
    double const* v = values.data() + moment_sums * i;
    std::uint64_t const* n = numbers.data() + moment_counts * i;
    return {v[0], v[1], v[2], v[3], v[4], v[5], n[0], n[1], 0, {}};
  }
  void write(hdf5::Writer& out, std::string const& path, hdf5::Sizes shape) const {
    shape.push_back(moment_sums);
    out.array(path, values, "1", shape);
    shape.back() = moment_counts;
    out.array(path + "_counts", numbers, "1", shape);
  }
  static MomentColumns read(hdf5::Reader const& in, std::string const& path, std::size_t rows, std::size_t each = 1) {
    MomentColumns const c{in.rows<double>(path, rows, moment_sums * each),
                          in.rows<std::uint64_t>(path + "_counts", rows, moment_counts * each)};
    for (double const sum : c.values)
      if (!std::isfinite(sum)) damaged_run(fmt::format("'{}' holds a sum that is not a number", path));
    return c;
  }
};

// Further columns of scores: the largest of each row, and its sum over the first blocks. Files of schema 1.1 lack both:
// they read as an infinite score and a NaN.
struct ScoreColumns {
  MomentColumns moments;
  Counts offset = {0};
  Doubles largest, first_sum;

  void add(Moments const& m) {
    moments.add(m);
    largest.insert(largest.end(), m.tail.begin(), m.tail.end());
    offset.push_back(largest.size());
    first_sum.push_back(m.first_sum);
  }
  Moments at(std::size_t i) const {
    Moments m = moments.at(i);
    m.first_sum = first_sum[i];
    m.tail.assign(largest.begin() + std::ptrdiff_t(offset[i]), largest.begin() + std::ptrdiff_t(offset[i + 1]));
    return m;
  }
  std::size_t rows() const { return first_sum.size(); }
  // `path`: of the moments; `name`: what the other columns begin with.
  void write(hdf5::Writer& out, std::string const& path, std::string const& name) const {
    moments.write(out, path, {rows()});
    out.array(name + "_first_sum", first_sum, "1");
    out.array(name + "_largest_offset", offset, "1");
    out.array(name + "_largest", largest, "1");
  }
  static ScoreColumns read(hdf5::Reader const& in, std::string const& path, std::string const& name, std::size_t rows) {
    ScoreColumns c;
    c.moments = MomentColumns::read(in, path, rows);
    if (!in.has(name + "_first_sum")) {
      c.first_sum.assign(rows, not_a_number);
      c.largest.assign(rows, infinity);
      for (std::size_t i = 1; i <= rows; ++i) c.offset.push_back(i);
      return c;
    }
    c.first_sum = in.rows<double>(name + "_first_sum", rows);
    c.largest = in.array<double>(name + "_largest");
    c.offset = read_offsets(in, name + "_largest_offset", rows, c.largest.size());
    return c;
  }
};

// Second moments of phase sensitivities as columns of a run file.

// Products of phase sensitivities, row after row.
struct ProductColumns {
  std::vector<std::uint32_t> replica, body;  // body: two of each
  Doubles sum;                               // 36 of each

  void add(PhaseSensitivityProduct const&);
  std::size_t rows() const { return replica.size(); }
  PhaseSensitivityProduct at(std::size_t i) const;
  void write(hdf5::Writer&, std::string const& path) const;
  static ProductColumns read(hdf5::Reader const&, std::string const& path);
};

// Of the classes of all nodes. Files below schema 1.8 have none: their sums are given up.
struct PhaseSensitivityColumns {
  Counts paths, offset = {0};
  std::vector<std::uint8_t> given_up;
  Doubles weight;
  ProductColumns products;

  void add(PhaseSensitivitySums const&);
  PhaseSensitivitySums at(std::size_t i) const;
  void write(hdf5::Writer&) const;
  static PhaseSensitivityColumns read(hdf5::Reader const&, std::size_t rows);
};

// Of the routes of a coupling table to ports.
void write_phase_sensitivity_moments(hdf5::Writer&, CouplingTable const&);
void read_phase_sensitivity_moments(hdf5::Reader const&, CouplingTable&);

}  // namespace straytrace::results
