// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <iostream>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/files/text_file.hpp"
#include "base/input/document.hpp"
#include "cli/inspect/inspect.hpp"
#include "io/delimited_text.hpp"
#include "results/curves/curve_file.hpp"
#include "results/results.hpp"
#include "results/text/picture.hpp"
#include "results/text/scatter_text.hpp"
#include "world/scatter_data/scatter_file.hpp"

namespace straytrace::cli {
namespace {

// "1064 nm" of the command line.
double length_of(std::string const& text) {
  auto const number = leading_number(text);
  auto const unit = number ? parse_unit(number->rest) : std::nullopt;
  double const length = unit && unit->dimension == dim::length ? to_si(number->value, *unit) : 0;
  if (!(length > 1e-8 && length < 1e-3))
    throw InputError(fmt::format("'{}' is not a wavelength", text), "write --wavelength \"1064 nm\"");
  return length;
}

ScatterFile read(ScatterRequest const& r) {
  auto const [text, why] = bytes_of_file(r.file);
  if (!why.empty()) throw InputError(fmt::format("cannot read '{}': {}", r.file, why), "name a file");
  ScatterDeclared given;
  given.angles = r.angles;
  given.entry = r.entry;
  if (!r.wavelength.empty()) given.wavelength = length_of(r.wavelength);
  std::vector<Problem> problems;
  ScatterFile file = read_scatter_file(text, given, problems);
  if (problems.empty()) check_scatter_points(file.points, problems);
  if (problems.empty()) return file;
  throw errors_in(r.file, std::move(problems));
}

void draw(nlohmann::json const& data, std::string const& png) {
  std::string message;
  std::string const picture = picture_of(data.dump(), "scatter", message);
  if (picture.empty()) throw InputError(message, "or remove --plot");
  write_file(png, picture);
}

}  // namespace

int inspect_scatter(ScatterRequest const& r) {
  if (!r.plot.empty()) check_ending(r.plot, {".png"}, "--plot");
  ScatterFile const file = read(r);
  std::string const name = std::filesystem::path(r.file).filename().string();
  ScatterAudit const audit = audit_scatter(file, r.beyond);
  std::vector<ScatterFit> const fits = fit_scatter(file, name);
  std::string ssdd, why;
  if (!r.write.empty()) {
    if (!r.write.ends_with(".ssdd"))
      throw InputError(fmt::format("'{}' is not an SSDD file", r.write), "write --write NAME.ssdd");
    ssdd = ssdd_text(file, r.beyond, why);
    if (!why.empty()) throw InputError(fmt::format("cannot convert '{}' to SSDD: {}", r.file, why), "remove --write");
  }
  nlohmann::json const data = scatter_json(name, file, audit, fits);
  if (!r.plot.empty()) draw(data, r.plot);
  if (!r.write.empty()) write_file(r.write, ssdd);
  if (r.json()) {
    std::cout << data.dump() << '\n';
    return done;
  }
  std::cout << scatter_text(name, file, audit, fits, r.beyond);
  if (!r.plot.empty()) std::cout << "\npicture: " << r.plot << '\n';
  if (!r.write.empty()) std::cout << "written: " << r.write << '\n';
  return done;
}

}  // namespace straytrace::cli
