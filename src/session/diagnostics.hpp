// SPDX-License-Identifier: BSD-3-Clause
// Warnings on stderr: sentences, JSON lists with --format json, nothing with --quiet.
#pragma once

#include <string>

#include "base/errors.hpp"
#include "session/model.hpp"
#include "session/options.hpp"
#include "trace/run/trace.hpp"

namespace straytrace::session {

void print_warnings(ProjectionModel const&, PrintOptions const&);
void print_warnings(Scene const&, PrintOptions const&);
// Without a place in a file; a remedy follows in a line of its own, after two spaces.
void print_warning(std::string const& sentence, PrintOptions const&);
std::string warning_as_json(std::string const& sentence);  // a list of one (problems_as_json)

// Lines of JSON on stderr for a program that runs this one (straytrace --events): progress of a trace, and problems of
// the input, which are then printed in no other form. Each is an object with the key `event`; all other lines are plain
// text.

void print_events();  // from now on
bool events_on();
// {"event": "progress", histories, wanted_histories, seconds, histories_per_s, rays_per_s, error, wanted_error, line};
// errors are relative, null where there is none; `line` is plain text.
void print_progress(TraceProgress const&, std::string const& line);
void print_problems(InputError const&);  // {"event": "problems", text, "problems": [as problems_as_json]}

}  // namespace straytrace::session
