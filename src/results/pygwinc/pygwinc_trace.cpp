// SPDX-License-Identifier: BSD-3-Clause
#include "results/pygwinc/pygwinc_trace.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <sstream>

#include "base/errors.hpp"
#include "io/hdf5/reader.hpp"
#include "io/hdf5/writer.hpp"
#include "results/results.hpp"

namespace straytrace::results {
namespace {

using hdf5::Reader;

[[noreturn]] void reject(std::string const& file, std::string const& path, std::string const& how) {
  throw InputError(fmt::format("'{}' is not a noise budget of pygwinc: '{}' {}", file, path, how),
                   "write it with gwinc --save FILE.hdf5, or give a two-column text file");
}

Reader opened(std::string const& bytes, std::string const& file) {
  try {
    return Reader(bytes);
  } catch (InputError const& e) {
    throw InputError(fmt::format("'{}': {}", file, e.reason()), "copy or make it again");
  }
}

// Of the file; empty where it has none.
std::string about(Reader const& in, std::string const& name) {
  return in.has_attribute("/", name) ? hdf5::text_in(in.object("/").attributes.at(name)).value_or("") : "";
}

struct Loader {
  std::string const& file;
  Reader const& in;
  std::size_t points;

  std::vector<double> psd(std::string const& path) const {
    if (!in.has(path)) reject(file, path, "is missing");
    std::vector<double> values = in.array<double>(path);
    if (values.size() != points)
      reject(file, path, fmt::format("has {} values for {} frequencies", values.size(), points));
    return values;
  }
  BudgetTrace version_2(std::string const& group, std::string const& name) const {
    BudgetTrace trace{name, name, psd(group + "/PSD"), {}};
    std::string const below = group + "/budget";
    if (in.has(below))
      for (std::string const& part : in.members(below)) trace.parts.push_back(version_2(below + "/" + part, part));
    return trace;
  }
  BudgetTrace version_1(std::string const& group, std::string const& name) const {
    BudgetTrace trace{name, name, psd(group + "/Total"), {}};
    for (std::string const& part : in.members(group)) {
      std::string const path = group + "/" + part;
      if (part == "Total") continue;
      if (in.is_group(path))
        trace.parts.push_back(version_1(path, part));
      else
        trace.parts.push_back({part, part, psd(path), {}});
    }
    return trace;
  }
};

BudgetFile read_opened(std::string const& file, Reader const& in) {
  if (!in.has("/Freq")) reject(file, "/Freq", "is missing");
  BudgetFile budget;
  budget.hz = in.array<double>("/Freq");
  for (std::size_t i = 0; i < budget.hz.size(); ++i)
    if (!(budget.hz[i] > (i > 0 ? budget.hz[i - 1] : 0))) reject(file, "/Freq", "does not increase from above 0");
  budget.ifo = about(in, "ifo");
  std::istringstream models(about(in, "models"));
  for (std::string model; models >> model;) budget.models.push_back(model);
  Loader const load{file, in, budget.hz.size()};
  if (in.has("/traces")) {
    budget.total = load.version_1("/traces", "Total");
    return budget;
  }
  std::vector<std::string> tops;
  for (std::string const& name : in.members("/"))
    if (in.is_group("/" + name)) tops.push_back(name);
  if (tops.size() != 1)
    reject(file, "/", fmt::format("holds {} groups, and the total must be the only one", tops.size()));
  budget.total = load.version_2("/" + tops.front(), tops.front());
  return budget;
}

}  // namespace

bool is_hdf5(std::string const& bytes) { return bytes.starts_with("\x89HDF"); }

bool is_budget_file(std::string const& bytes, std::string const& name) {
  return is_hdf5(bytes) && !opened(bytes, name).has_attribute("/", "file_type");
}

BudgetFile read_budget_file(std::string const& file) {
  std::string const bytes = read_file(file);
  if (!is_hdf5(bytes)) reject(file, "/", "is not HDF5");
  return read_opened(file, opened(bytes, file));
}

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
  out.group(group + "/budget", "the traces that add up to it");
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

}  // namespace straytrace::results
