// SPDX-License-Identifier: BSD-3-Clause
// Errors of the program as those of the library.
#pragma once

#include <utility>

#include "base/errors.hpp"
#include "straytrace/straytrace.hpp"

namespace straytrace::api {

InputError as_public(straytrace::InputError const&);

template <class Function>
auto with_public_errors(Function&& function) {
  try {
    return std::forward<Function>(function)();
  } catch (straytrace::InputError const& e) {
    throw as_public(e);
  } catch (straytrace::NumericalError const& e) {
    throw NumericalError(e.what());
  }
}

}  // namespace straytrace::api
