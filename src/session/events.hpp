// SPDX-License-Identifier: BSD-3-Clause
// Lines of JSON on stderr for a program that has started this one (straytrace --events): how far a trace is, and the
// problems of the input. Each is an object with the key `event`; all other lines are for people.
#pragma once

#include <string>

#include "base/errors.hpp"
#include "trace/run/trace.hpp"

namespace straytrace {

void print_events();  // from now on
bool events_on();
// {"event": "progress", histories, wanted_histories, seconds, histories_per_s, rays_per_s, error, wanted_error, line};
// errors are relative, null where there is none; `line` is for people.
void print_progress(TraceProgress const&, std::string const& line);
void print_problems(InputError const&);  // {"event": "problems", text, "problems": [as problems_as_json]}

}  // namespace straytrace
