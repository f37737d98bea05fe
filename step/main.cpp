// SPDX-License-Identifier: BSD-3-Clause
// straytrace-step: converts a STEP file to the geometry that straytrace reads.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/prctl.h>

#include <Standard_Version.hxx>
#include <csignal>
#include <filesystem>
#include <iostream>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "base/units/quantity.hpp"
#include "session/build_info.hpp"
#include "step/read_step.hpp"
#include "step/write_cad.hpp"

namespace {

namespace fs = std::filesystem;
using namespace straytrace;

double length_in(std::string const& option, std::string const& text) {
  auto const number = leading_number(text);
  auto const unit = number ? parse_unit(number->rest) : std::nullopt;
  double const length = unit && unit->dimension == dim::length ? to_si(number->value, *unit) : 0;
  if (!(length >= 1e-9 && length <= 1e-2))
    throw step::Refused{fmt::format("'{}' is not what --{} takes", text, option),
                        fmt::format("write for example --{} 1um, from 1nm to 1cm", option)};
  return length;
}

int convert(std::string const& input, std::string output, std::string const& tolerance, std::string const& chord,
            bool quiet) {
  std::string const name = fs::path(input).filename().string();
  try {
    step::Settings settings;
    settings.tolerance = length_in("tolerance", tolerance);
    settings.chord = length_in("chord", chord);
    step::Model const model = step::read_step(input, settings);
    if (output.empty()) output = fs::path(input).replace_extension(".cad.json").string();
    AtomicFile file(output);
    file.write(step::as_json(
        model, settings,
        fmt::format("straytrace-step {}, OpenCASCADE {}", session::build_info::version, OCC_VERSION_COMPLETE)));
    file.publish();
    if (!quiet) std::cout << step::summary(model, name) << "wrote  " << output << '\n';
    return 0;
  } catch (step::Refused const& r) {
    std::cerr << fmt::format("{}: error: {}\n  {}\n", name, r.what, r.suggestion);
  } catch (InputError const& e) {  // no place to write to
    std::cerr << name << ": " << e.what() << '\n';
  }
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Converts a STEP file (AP203, AP214, AP242) to geometry for straytrace: exact planes, cylinders, cones,\n"
      "spheres and tori, with names, colours and metres.");
  std::string input, output, tolerance = "1um", chord = "10um";
  bool quiet = false, with_parent = false;
  app.add_option("file", input, "STEP file")->required();
  app.add_option("-o,--output", output, "file to write; FILE.cad.json otherwise");
  app.add_option("--tolerance", tolerance, "of edges that are no circles about an axis and no straight lines");
  app.add_option("--chord", chord, "between free surfaces and the triangles that stand for them");
  app.add_flag("--quiet", quiet, "do not print what the file holds");
  app.add_flag("--end-with-parent", with_parent, "end when the program that started it ends");
  app.set_version_flag("--version", fmt::format("straytrace-step {}", session::build_info::version));
  app.footer(
      "Examples:\n"
      "  straytrace-step ne_bench.step\n"
      "  straytrace-step ne_bench.step -o bench.cad.json --tolerance 0.1um --chord 1um");
  try {
    app.parse(argc, argv);
  } catch (CLI::ParseError const& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  if (with_parent) ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  return convert(input, output, tolerance, chord, quiet);
}
