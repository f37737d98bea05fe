// SPDX-License-Identifier: BSD-3-Clause
// JSON output and errors of a command.
#pragma once

#include <nlohmann/json.hpp>

#include "scenes/program.hpp"

namespace straytrace::testing {

inline std::string data(std::string const& name) { return source_folder + "/examples/data/" + name; }

inline nlohmann::json answer(Words words) {
  words.insert(words.end(), {"--format", "json"});
  Finished const f = straytrace(words);
  EXPECT_EQ(f.code, 0) << f.err;
  return f.code == 0 ? nlohmann::json::parse(f.out) : nlohmann::json();
}

// Its message; stdout stays empty.
inline std::string error_text(Words const& words) {
  Finished const f = straytrace(words);
  EXPECT_EQ(f.code, 2) << f.out;
  EXPECT_EQ(f.out, "");
  return f.err;
}

}  // namespace straytrace::testing
