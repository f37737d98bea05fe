// SPDX-License-Identifier: BSD-3-Clause
// One reader, given any bytes: it accepts them or throws InputError (a wrong run file also NumericalError). libFuzzer
// calls this entry with bytes of its own making, replay.cpp with the files of fuzz/corpus.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

namespace straytrace::fuzz {

inline std::string_view text_of(std::uint8_t const* data, std::size_t size) {
  return {reinterpret_cast<char const*>(data), size};
}

}  // namespace straytrace::fuzz
