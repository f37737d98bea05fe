// SPDX-License-Identifier: BSD-3-Clause
// /importance: the tables that steered the trace.
#include "results/run_file/run_file.hpp"

namespace straytrace {

void write_importance(hdf5::Writer& out, ImportanceMap const& map) {
  std::vector<std::uint32_t> group, patch;
  std::vector<double> z, area;
  for (ImportanceMap::Strip const& s : map.strips) {
    group.push_back(s.group);
    patch.push_back(s.patch);
    z.insert(z.end(), {s.low, s.high});
    area.push_back(s.area);
  }
  out.group("/importance", "what steered the trace: strips of surfaces, and the adjoint of each side of their patches");
  out.array("/importance/group", group, "row of /names/groups");
  out.array("/importance/patch", patch, "row of /importance/adjoint");
  out.array("/importance/z", z, "m", {map.strips.size(), 2});
  out.array("/importance/area", area, "m^2");
  out.array("/importance/adjoint", map.adjoint, "1", {map.adjoint.size() / 2, 2});
  out.array("/importance/law_share", map.law_share, "1", {map.law_share.size() / 2, 2});
}

ImportanceMap read_importance(hdf5::Reader const& in, std::size_t groups) {
  ImportanceMap map;
  if (!in.has("/importance")) return map;
  auto const group = in.array<std::uint32_t>("/importance/group");
  std::size_t const strips = group.size();
  auto const patch = in.rows<std::uint32_t>("/importance/patch", strips);
  auto const z = in.rows<double>("/importance/z", strips, 2), area = in.rows<double>("/importance/area", strips);
  map.adjoint = in.array<double>("/importance/adjoint", 2);
  map.law_share = in.rows<double>("/importance/law_share", map.adjoint.size() / 2, 2);
  for (std::size_t i = 0; i < strips; ++i) {
    if (patch[i] >= map.adjoint.size() / 2) damaged_run("'/importance/patch' names a patch that is not there");
    if (group[i] >= groups) damaged_run("'/importance/group' names a group that is not there");
    map.strips.push_back({group[i], patch[i], z[2 * i], z[2 * i + 1], area[i]});
  }
  return map;
}

}  // namespace straytrace
