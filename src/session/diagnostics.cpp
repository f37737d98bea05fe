// SPDX-License-Identifier: BSD-3-Clause
#include "session/diagnostics.hpp"

#include <nlohmann/json.hpp>

#include <iostream>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "scene/diagnostics.hpp"

namespace straytrace::session {

void print_warnings(ProjectionModel const& model, PrintOptions const& options) {
  if (!options.quiet) std::cerr << (options.json() ? model.warnings_json : printable(model.warnings));
}

void print_warnings(Scene const& scene, PrintOptions const& options) {
  if (!options.quiet) std::cerr << (options.json() ? warnings_as_json(scene) : printable(scene.warnings()));
}

std::string warning_as_json(std::string const& sentence) {
  constexpr std::string_view between = "\n  ";
  std::size_t const at = sentence.find(between);
  std::string const remedy = at == sentence.npos ? "" : sentence.substr(at + between.size());
  return problems_as_json(InputError({{{}, sentence.substr(0, at), remedy, Severity::warning}}, ""));
}

void print_warning(std::string const& sentence, PrintOptions const& options) {
  if (options.quiet || !options.warnings) return;
  if (options.json())
    std::cerr << warning_as_json(sentence);
  else
    std::cerr << "warning: " << printable(sentence) << '\n';
}

namespace {

using SortedJson = nlohmann::json;
bool told = false;

void tell(SortedJson const& event) {
  std::cerr << event.dump(-1, ' ', false, SortedJson::error_handler_t::replace) << '\n' << std::flush;
}

}  // namespace

void print_events() { told = true; }
bool events_on() { return told; }

void print_progress(TraceProgress const& p, std::string const& line) {
  tell({{"event", "progress"},
        {"histories", p.histories},
        {"wanted_histories", p.wanted_histories},
        {"seconds", p.seconds},
        {"histories_per_s", p.histories_per_s},
        {"rays_per_s", p.rays_per_s},
        {"error", p.error},  // not a number: null
        {"wanted_error", p.wanted_error},
        {"line", line}});
}

void print_problems(InputError const& e) {
  tell({{"event", "problems"}, {"text", e.what()}, {"problems", SortedJson::parse(problems_as_json(e))}});
}

}  // namespace straytrace::session
