// SPDX-License-Identifier: BSD-3-Clause
// Marks functions that compile for the host and, under nvcc, for the device.
#pragma once

#include "base/namespaces.hpp"

#if defined(__CUDACC__)
#define STRAY_HD __host__ __device__ inline
#define STRAY_NO_CHECK(check)
#else
#define STRAY_HD inline
#define STRAY_NO_CHECK(check) __attribute__((no_sanitize(check)))  // `check`: one of those of -fsanitize
#endif
