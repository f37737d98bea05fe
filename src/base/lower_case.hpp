// SPDX-License-Identifier: BSD-3-Clause
// The letters A to Z of a text as a to z, everything else unchanged, whatever the locale.
#pragma once

#include <string>
#include <string_view>

namespace straytrace {

inline std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

}  // namespace straytrace
