// SPDX-License-Identifier: BSD-3-Clause
// What files of others say, as a terminal may have it.
#pragma once

#include <string>
#include <string_view>

namespace straytrace {

// Control characters but line ends and tabs become '?', so that no text steers a terminal; of lines beyond 8000 bytes
// the rest is left out.
std::string printable(std::string_view text);

}  // namespace straytrace
