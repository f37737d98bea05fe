// SPDX-License-Identifier: BSD-3-Clause
// Histories on the threads of this processor.
#pragma once

#include "trace/backend/backend.hpp"

namespace straytrace {

std::unique_ptr<Backend> cpu_backend();

}  // namespace straytrace
