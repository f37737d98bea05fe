// SPDX-License-Identifier: BSD-3-Clause
#include "report/lever_columns.hpp"

#include <algorithm>

namespace straytrace {
namespace {

constexpr std::size_t products_each = std::tuple_size_v<decltype(LeverProduct::sum)>;

}  // namespace

void ProductColumns::add(LeverProduct const& p) {
  replica.push_back(p.replica);
  body.insert(body.end(), {p.first.value, p.second.value});
  sum.insert(sum.end(), p.sum.begin(), p.sum.end());
}

LeverProduct ProductColumns::at(std::size_t i) const {
  LeverProduct p{replica[i], {body[2 * i]}, {body[2 * i + 1]}};
  std::copy_n(sum.begin() + std::ptrdiff_t(products_each * i), products_each, p.sum.begin());
  return p;
}

void ProductColumns::write(hdf5::Writer& out, std::string const& path) const {
  out.array(path + "_replica", replica, "1");
  out.array(path + "_body", body, "row of /names/bodies", {rows(), 2});
  out.array(path, sum, "products of 3 x rad/m, 3 x rad/rad", {rows(), products_each});
}

ProductColumns ProductColumns::read(hdf5::Reader const& in, std::string const& path) {
  ProductColumns c;
  c.replica = in.array<std::uint32_t>(path + "_replica");
  c.body = in.rows<std::uint32_t>(path + "_body", c.rows(), 2);
  c.sum = in.rows<double>(path, c.rows(), products_each);
  for (std::uint32_t const r : c.replica)
    if (r >= replica_count) damaged_run("a product of levers of an unknown replica");
  return c;
}

void LeverColumns::add(LeverSums const& s) {
  paths.push_back(s.paths);
  given_up.push_back(s.given_up);
  weight.insert(weight.end(), s.weight.begin(), s.weight.end());
  for (LeverProduct const& p : s.products) products.add(p);
  offset.push_back(products.rows());
}

LeverSums LeverColumns::at(std::size_t i) const {
  LeverSums s;
  s.paths = paths[i];
  s.given_up = given_up[i] != 0;
  std::copy_n(weight.begin() + std::ptrdiff_t(replica_count * i), replica_count, s.weight.begin());
  for (std::size_t k = offset[i]; k < offset[i + 1]; ++k) s.products.push_back(products.at(k));
  return s;
}

void LeverColumns::write(hdf5::Writer& out) const {
  out.array("/nodes/lever_paths", paths, "1");
  out.array("/nodes/lever_given_up", given_up, "0 or 1");
  out.array("/nodes/lever_weight", weight, "1", {paths.size(), replica_count});
  out.array("/nodes/lever_offset", offset, "1");
  products.write(out, "/nodes/lever_product");
}

LeverColumns LeverColumns::read(hdf5::Reader const& in, std::size_t rows) {
  LeverColumns c;
  if (!in.has("/nodes/lever_paths")) {
    c.paths = c.offset = Counts(rows + 1);
    c.given_up.assign(rows, 1);
    c.weight.resize(rows * replica_count);
    return c;
  }
  c.paths = in.rows<std::uint64_t>("/nodes/lever_paths", rows);
  c.given_up = in.rows<std::uint8_t>("/nodes/lever_given_up", rows);
  c.weight = in.rows<double>("/nodes/lever_weight", rows, replica_count);
  c.products = ProductColumns::read(in, "/nodes/lever_product");
  c.offset = read_offsets(in, "/nodes/lever_offset", rows, c.products.rows());
  return c;
}

void write_lever_moments(hdf5::Writer& out, CouplingTable const& table) {
  std::vector<std::uint32_t> owner;
  ProductColumns products;
  for (std::size_t i = 0; i < table.classes.size(); ++i)
    for (LeverProduct const& p : table.classes[i].levers) {
      owner.push_back(std::uint32_t(i));
      products.add(p);
    }
  out.group("/levers", "mean coupling times mean product of two levers, contributions of the replicas");
  out.array("/levers/class", owner, "row of /classes");
  products.write(out, "/levers/product");
}

void read_lever_moments(hdf5::Reader const& in, CouplingTable& table) {
  if (!in.has("/levers")) return;  // since schema 1.8
  ProductColumns const products = ProductColumns::read(in, "/levers/product");
  auto const owner = in.rows<std::uint32_t>("/levers/class", products.rows());
  for (std::size_t i = 0; i < owner.size(); ++i) {
    LeverProduct const p = products.at(i);
    if (owner[i] >= table.classes.size() || std::max(p.first.value, p.second.value) >= table.bodies.size())
      damaged_run("a product of levers without a route or a body");
    table.classes[owner[i]].levers.push_back(p);
  }
}

}  // namespace straytrace
