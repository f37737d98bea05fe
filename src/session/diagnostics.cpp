// SPDX-License-Identifier: BSD-3-Clause
#include "session/diagnostics.hpp"

#include <iostream>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "scene/diagnostics.hpp"

namespace straytrace {

void print_warnings(Model const& model, PrintOptions const& options) {
  if (!options.quiet) std::cerr << (options.json() ? model.warnings_json : printable(model.warnings));
}

void print_warnings(Scene const& scene, PrintOptions const& options) {
  if (!options.quiet) std::cerr << (options.json() ? warnings_as_json(scene) : printable(scene.warnings()));
}

void print_warning(std::string const& sentence, PrintOptions const& options) {
  if (options.quiet) return;
  if (options.json())
    std::cerr << problems_as_json(InputError({{{}, sentence, "", Severity::warning}}, ""));
  else
    std::cerr << "warning: " << printable(sentence) << '\n';
}

}  // namespace straytrace
