// SPDX-License-Identifier: BSD-3-Clause
// The files of the folders data/ and library/, compiled in, so that the program does not depend on where it is
// installed.
#pragma once

#include <span>
#include <string_view>

#include "base/namespaces.hpp"

namespace straytrace {

struct EmbeddedFile {
  std::string_view name, text;  // "curves/et-d.txt", "library/arm.yaml"
};
std::span<EmbeddedFile const> embedded_files();         // by name
std::string_view embedded_file(std::string_view name);  // text of a file; empty: no such file

}  // namespace straytrace
