// SPDX-License-Identifier: BSD-3-Clause
// A folder for results that is there before anything is computed, and gone again when nothing came of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace straytrace {

class OutputFolder {
 public:
  // Made with its parents. Throws InputError when it cannot be made or written to, or when one of the `files` it is for
  // is a folder.
  explicit OutputFolder(std::string const& name, std::vector<std::string> const& files = {});
  ~OutputFolder();  // removes what was made and is still empty
  OutputFolder(OutputFolder const&) = delete;
  OutputFolder& operator=(OutputFolder const&) = delete;
  std::string path(std::string const& file) const { return (folder_ / file).string(); }

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  // the outermost first
};

}  // namespace straytrace
