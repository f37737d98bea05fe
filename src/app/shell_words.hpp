// SPDX-License-Identifier: BSD-3-Clause
// Words for a POSIX shell, whatever is in them.
#pragma once

#include <string>
#include <string_view>

namespace straytrace {

// As one word that the shell takes as it is: plain words stay, others are put between single quotes.
inline std::string shell_word(std::string_view text) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
  if (!text.empty() && text.front() != '-' && text.find_first_not_of(plain) == text.npos) return std::string(text);
  std::string quoted = "'";
  for (char const c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace straytrace
