// SPDX-License-Identifier: BSD-3-Clause
// A mesh file read in a copy of the process; what it holds comes back as bytes.
#include <fmt/format.h>

#include "base/apart.hpp"
#include "base/pack.hpp"
#include "world/mesh_file.hpp"

namespace straytrace {
namespace {

// The library takes about 20 bytes for each of a file, our parts as much again.
Bounds bounds_for(std::size_t bytes) { return {(std::size_t{1} << 30) + 100 * bytes, 60 + bytes / 100000}; }

std::string packed(MeshFault const& fault, MeshFile const& file, std::vector<std::string> const& asked) {
  Packer out;
  out.add(fault.what);
  out.add(fault.suggestion);
  out.count(asked.size());
  for (std::string const& name : asked) out.add(name);
  out.value(file.stated_unit);
  out.count(file.left_out);
  out.count(file.parts.size());
  for (MeshPart const& p : file.parts) {
    for (std::string const* text : {&p.name, &p.material, &p.colour}) out.add(*text);
    out.add(p.vertices);
    out.add(p.triangles);
  }
  return out.take();
}

}  // namespace

MeshFault read_mesh_file(std::string const& bytes, CompanionFile const& companion, MeshFile& out) {
  auto const work = [&] {
    std::vector<std::string> asked;
    CompanionFile const noted = [&](std::string const& name) { return asked.push_back(name), companion(name); };
    MeshFile file;
    file.name = out.name;
    MeshFault const fault = import_mesh(bytes, companion ? noted : companion, file);
    return packed(fault, file, asked);
  };
  Apart const done = done_apart(work, bounds_for(bytes.size()));
  if (!done.why.empty())
    return {fmt::format("not a readable mesh file: {}", done.why), "check that the file is complete; export it again"};
  Unpacker in(done.bytes);
  MeshFault fault;
  fault.what = in.text();
  fault.suggestion = in.text();
  for (std::uint64_t n = in.count(); n > 0; --n) (void)companion(in.text());  // what it asked for is noted here too
  out.stated_unit = in.value<double>();
  out.left_out = in.count();
  out.parts.resize(in.count());
  for (MeshPart& p : out.parts) {
    p.name = in.text(), p.material = in.text(), p.colour = in.text();
    p.vertices = in.values<MeshVertex>();
    p.triangles = in.values<MeshTriangle>();
  }
  return fault;
}

}  // namespace straytrace
