// SPDX-License-Identifier: BSD-3-Clause
// Whether this is a build with sanitizers, which is slow and reserves terabytes of addresses.
#pragma once

namespace straytrace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#elif defined(__has_feature)
inline constexpr bool sanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool sanitized = false;
#endif

}  // namespace straytrace
