// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdint>
#include <set>

#include "hdf5/writer.hpp"
#include "report/pygwinc_trace.hpp"
#include "report/report.hpp"

namespace straytrace {
namespace {

std::string style(BudgetTrace const& trace) {
  YAML::Emitter out;
  out << YAML::Flow << YAML::BeginMap << YAML::Key << "label" << YAML::Value << YAML::DoubleQuoted << trace.label
      << YAML::EndMap;
  return out.c_str();
}

void write_trace(hdf5::Writer& out, std::string const& group, BudgetTrace const& trace) {
  out.group(group, trace.label);
  out.attribute(group, "style", style(trace));
  out.array(group + "/PSD", trace.psd, "1/Hz");
  if (trace.parts.empty()) return;
  out.group(group + "/budget", "what it is the sum of");
  std::set<std::string> taken;
  for (BudgetTrace const& part : trace.parts) {
    std::string name = part.name;
    std::replace(name.begin(), name.end(), '/', ':');  // a slash would begin another group
    while (!taken.insert(name).second) name += "'";
    write_trace(out, group + "/budget/" + name, part);
  }
}

}  // namespace

std::string budget_file_bytes(BudgetFile const& budget, std::vector<std::pair<std::string, std::string>> const& about) {
  hdf5::Writer out;
  out.attribute("/", "SCHEMA", std::string("GWINC noise budget"));
  out.attribute("/", "SCHEMA_VERSION", std::vector<std::uint64_t>{2});
  out.attribute("/", "date", utc_now());
  if (!budget.ifo.empty()) out.attribute("/", "ifo", budget.ifo);
  if (!budget.models.empty()) out.attribute("/", "models", fmt::format("{}", fmt::join(budget.models, " ")));
  out.attribute("/", "plot_style", std::string("{ylabel: 'Strain [1/sqrt(Hz)]'}"));
  for (auto const& [name, value] : about) out.attribute("/", name, value);
  out.array("/Freq", budget.hz, "Hz");
  write_trace(out, "/" + budget.total.name, budget.total);
  return out.bytes();
}

}  // namespace straytrace
