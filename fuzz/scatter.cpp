// SPDX-License-Identifier: BSD-3-Clause
// Measured scatter in all formats, and lists of materials.
#include "base/every_module.hpp"
#include "fuzz.hpp"
#include "world/import/newmtl.hpp"
#include "world/scatter_data/scatter_file.hpp"
#include "world/scatter_data/scatter_fit.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace straytrace;
  std::string_view const text = fuzz::text_of(data, size);
  std::vector<Problem> problems, of_list;
  (void)read_newmtl(text, of_list);
  ScatterDeclared given;
  given.wavelength = 1064e-9;
  ScatterFile const file = read_scatter_file(text, given, problems);
  if (problems.empty()) check_scatter_points(file.points, problems);
  if (!problems.empty() || file.points.empty()) return 0;
  std::string why;
  (void)by_incidence(file.points);
  (void)ssdd_text(file, "zero", why);
  return 0;
}
