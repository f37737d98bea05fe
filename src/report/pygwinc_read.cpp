// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <sstream>

#include "base/message.hpp"
#include "hdf5/hdf5.hpp"
#include "report/pygwinc_trace.hpp"
#include "report/report.hpp"

namespace straytrace {
namespace {

using hdf5::Reader;

[[noreturn]] void refuse(std::string const& file, std::string const& path, std::string const& how) {
  throw InputError(
      fmt::format("error: '{}' is not a noise budget of pygwinc: '{}' {}\n  write it with "
                  "gwinc --save FILE.hdf5, or give a two-column text file",
                  file, path, how));
}

Reader opened(std::string const& bytes, std::string const& file) {
  try {
    return Reader(bytes);
  } catch (InputError const&) {
    throw InputError(
        fmt::format("error: '{}' is a damaged HDF5 file: it was cut short or changed\n  copy or make it again", file));
  }
}

// Text of any length kind, as pygwinc (through h5py) writes it; empty when absent.
std::string text_attribute(H5::H5File const& file, std::string const& name) {
  H5::Group const root = file.openGroup("/");
  if (!root.attrExists(name)) return "";
  H5::Attribute const a = root.openAttribute(name);
  if (a.getDataType().getClass() != H5T_STRING) return "";
  std::string text;
  a.read(a.getStrType(), text);
  return text.substr(0, text.find('\0'));
}

std::vector<std::string> members(H5::H5File const& file, std::string const& group) {
  H5::Group const g = file.openGroup(group);
  std::vector<std::string> names;
  for (hsize_t i = 0; i < g.getNumObjs(); ++i) names.push_back(g.getObjnameByIdx(i));
  return names;
}

bool is_group(H5::H5File const& file, std::string const& path) { return file.childObjType(path) == H5O_TYPE_GROUP; }

struct Loader {
  std::string const& file;
  Reader const& in;
  std::size_t points;

  std::vector<double> psd(std::string const& path) const {
    if (!in.has(path)) refuse(file, path, "is missing");
    std::vector<double> values = in.array<double>(path);
    if (values.size() != points)
      refuse(file, path, fmt::format("has {} values for {} frequencies", values.size(), points));
    return values;
  }
  BudgetTrace version_2(std::string const& group, std::string const& name) const {
    BudgetTrace trace{name, name, psd(group + "/PSD"), {}};
    std::string const below = group + "/budget";
    if (in.has(below))
      for (std::string const& part : members(in.file(), below))
        trace.parts.push_back(version_2(below + "/" + part, part));
    return trace;
  }
  BudgetTrace version_1(std::string const& group, std::string const& name) const {
    BudgetTrace trace{name, name, psd(group + "/Total"), {}};
    for (std::string const& part : members(in.file(), group)) {
      std::string const path = group + "/" + part;
      if (part == "Total") continue;
      if (is_group(in.file(), path))
        trace.parts.push_back(version_1(path, part));
      else
        trace.parts.push_back({part, part, psd(path), {}});
    }
    return trace;
  }
};

BudgetFile read_opened(std::string const& file, Reader const& in) {
  if (!in.has("/Freq")) refuse(file, "/Freq", "is missing");
  BudgetFile budget;
  budget.hz = in.array<double>("/Freq");
  for (std::size_t i = 0; i < budget.hz.size(); ++i)
    if (!(budget.hz[i] > (i > 0 ? budget.hz[i - 1] : 0))) refuse(file, "/Freq", "does not increase from above 0");
  budget.ifo = text_attribute(in.file(), "ifo");
  std::istringstream models(text_attribute(in.file(), "models"));
  for (std::string model; models >> model;) budget.models.push_back(model);
  Loader const load{file, in, budget.hz.size()};
  if (in.has("/traces")) {
    budget.total = load.version_1("/traces", "Total");
    return budget;
  }
  std::vector<std::string> tops;
  for (std::string const& name : members(in.file(), "/"))
    if (is_group(in.file(), "/" + name)) tops.push_back(name);
  if (tops.size() != 1)
    refuse(file, "/", fmt::format("holds {} groups, and the total must be the only one", tops.size()));
  budget.total = load.version_2("/" + tops.front(), tops.front());
  return budget;
}

}  // namespace

bool is_hdf5(std::string const& bytes) { return bytes.starts_with("\x89HDF"); }

bool is_budget_file(std::string const& bytes, std::string const& name) {
  return is_hdf5(bytes) && !opened(bytes, name).file().openGroup("/").attrExists("file_type");
}

BudgetFile read_budget_file(std::string const& file) {
  std::string const bytes = read_file(file);
  if (!is_hdf5(bytes)) refuse(file, "/", "is not HDF5");
  Reader const in = opened(bytes, file);
  try {
    return read_opened(file, in);
  } catch (H5::Exception const&) {
    refuse(file, "/", "holds something that cannot be read");
  }
}

}  // namespace straytrace
