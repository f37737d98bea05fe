// SPDX-License-Identifier: BSD-3-Clause
// schema/run-1.txt against a written file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <H5Cpp.h>
#include <set>
#include <sstream>

#include "hdf5/hdf5.hpp"
#include "report/seal.hpp"
#include "unit/report_synthetic.hpp"

namespace straytrace::test {
namespace {

std::string written(bool with_noise) {
  Folder const folder;
  TraceResult const trace = trace_result();
  NoiseBudget const noise = noise_budget(trace.coupling);
  write_run(folder / "run.h5", content(trace, with_noise ? &noise : nullptr));
  return read_file(folder / "run.h5");
}

// Every path of schema/run-1.txt stands in the file and the reverse; units agree.
std::set<std::string> schema_paths() {
  std::istringstream lines(read_file(std::string(STRAY_SOURCE_DIR) + "/schema/run-1.txt"));
  std::set<std::string> paths;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("/") && !line.starts_with("@")) continue;
    std::istringstream words(line);
    std::string path, type;
    words >> path >> type;
    paths.insert(path + " " + type);
  }
  return paths;
}

std::string type_word(H5::DataType const& type) {
  if (type.getClass() == H5T_STRING) return "text";
  if (type.getClass() == H5T_FLOAT) return "f64";
  return "u" + std::to_string(8 * type.getSize());
}

std::set<std::string> file_paths(H5::Group const& group, std::string const& path) {
  std::set<std::string> found;
  for (int i = 0; i < group.getNumAttrs(); ++i) {
    H5::Attribute const a = group.openAttribute(unsigned(i));
    if (a.getName() != "meaning") found.insert("@" + path + ":" + a.getName() + " " + type_word(a.getDataType()));
  }
  for (hsize_t i = 0; i < group.getNumObjs(); ++i) {
    std::string const name = group.getObjnameByIdx(i);
    std::string const full = (path == "/" ? "" : path) + "/" + name;
    if (group.childObjType(name) == H5O_TYPE_GROUP) {
      found.insert(full + " group");
      found.merge(file_paths(group.openGroup(name), full));
      continue;
    }
    H5::DataSet const set = group.openDataSet(name);
    EXPECT_TRUE(set.attrExists("unit")) << full;
    found.insert((full.starts_with("/input/files/") ? "/input/files/<n>" : full) + " " + type_word(set.getDataType()));
  }
  return found;
}

TEST(ReportSchema, AgreesWithAWrittenFile) {
  hdf5::Reader const in(unsealed(written(true), "run.h5"));
  EXPECT_THAT(file_paths(in.file().openGroup("/"), "/"), ::testing::ContainerEq(schema_paths()));
}

TEST(ReportSchema, ComparisonSeesAMissingPath) {
  hdf5::Reader const in(unsealed(written(false), "run.h5"));
  EXPECT_NE(file_paths(in.file().openGroup("/"), "/"), schema_paths());
}

}  // namespace
}  // namespace straytrace::test
