// SPDX-License-Identifier: BSD-3-Clause
// schema/run-2.txt against a written file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "io/hdf5/read_write.hpp"
#include "results/run_file/run_file.hpp"
#include "unit/results/synthetic.hpp"

namespace straytrace::test {
namespace {

std::string written(bool with_noise) {
  Folder const folder;
  TraceResult const trace = trace_result();
  NoiseBudget const noise = noise_budget(trace.coupling);
  write_run(folder / "run.h5", content(trace, with_noise ? &noise : nullptr));
  return read_file(folder / "run.h5");
}

// Every path of schema/run-2.txt exists in the file and vice versa; units agree.
std::set<std::string> schema_paths() {
  std::istringstream lines(read_file(std::string(STRAY_SOURCE_DIR) + "/schema/run-2.txt"));
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

std::string type_word(hdf5::Values const& v) {
  if (v.kind == hdf5::Kind::text) return "text";
  return (v.kind == hdf5::Kind::real ? "f" : "u") + std::to_string(8 * v.size);
}

std::set<std::string> file_paths(std::string const& image) {
  std::set<std::string> found;
  for (auto const& [path, object] : hdf5::contents_of(image)) {
    if (object.is_group) {
      for (auto const& [name, values] : object.attributes)
        if (name != "meaning") found.insert("@" + path + ":" + name + " " + type_word(values));
      if (path != "/") found.insert(path + " group");
      continue;
    }
    EXPECT_TRUE(object.attributes.contains("unit")) << path;
    std::string const place = path.starts_with("/input/files/") ? "/input/files/<n>" : path;
    found.insert(place + " " + type_word(object.values));
  }
  return found;
}

TEST(ReportSchema, AgreesWithAWrittenFile) {
  EXPECT_THAT(file_paths(unsealed(written(true), "run.h5")), ::testing::ContainerEq(schema_paths()));
}

TEST(ReportSchema, ComparisonSeesAMissingPath) {
  EXPECT_NE(file_paths(unsealed(written(false), "run.h5")), schema_paths());
}

}  // namespace
}  // namespace straytrace::test
