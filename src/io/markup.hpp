// SPDX-License-Identifier: BSD-3-Clause
// Text and bytes in HTML and XML.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "base/namespaces.hpp"

namespace straytrace::io {

std::string escaped(std::string_view text);  // also within attributes
std::string base64(void const* bytes, std::size_t size);

}  // namespace straytrace::io
