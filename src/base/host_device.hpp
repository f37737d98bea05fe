// SPDX-License-Identifier: BSD-3-Clause
// Marks functions that compile for the host and, under nvcc, for the device.
#pragma once

#if defined(__CUDACC__)
#define STRAY_HD __host__ __device__ inline
#else
#define STRAY_HD inline
#endif
