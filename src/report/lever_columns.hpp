// SPDX-License-Identifier: BSD-3-Clause
// Second moments of levers as columns of a run file.
#pragma once

#include <string>
#include <vector>

#include "report/node_columns.hpp"

namespace straytrace {

// Products of levers, row after row.
struct ProductColumns {
  std::vector<std::uint32_t> replica, body;  // body: two of each
  Doubles sum;                               // 36 of each

  void add(LeverProduct const&);
  std::size_t rows() const { return replica.size(); }
  LeverProduct at(std::size_t i) const;
  void write(hdf5::Writer&, std::string const& path) const;
  static ProductColumns read(hdf5::Reader const&, std::string const& path);
};

// Of the classes of all nodes. Files below schema 1.8 have none: their sums are given up.
struct LeverColumns {
  Counts paths, offset = {0};
  std::vector<std::uint8_t> given_up;
  Doubles weight;
  ProductColumns products;

  void add(LeverSums const&);
  LeverSums at(std::size_t i) const;
  void write(hdf5::Writer&) const;
  static LeverColumns read(hdf5::Reader const&, std::size_t rows);
};

// Of the routes of a coupling table to ports.
void write_lever_moments(hdf5::Writer&, CouplingTable const&);
void read_lever_moments(hdf5::Reader const&, CouplingTable&);

}  // namespace straytrace
