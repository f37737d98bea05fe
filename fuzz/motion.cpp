// SPDX-License-Identifier: BSD-3-Clause
// Records of motion as text and HDF5, spectra, responses, coupling functions.
#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "fuzz.hpp"
#include "io/delimited_text.hpp"
#include "spectra/curve.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/files/series_file.hpp"
#include "spectra/files/unit_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace straytrace;
  std::string const bytes(fuzz::text_of(data, size));
  try {
    (void)parse_series(bytes, "record", {"", "um", {}});
  } catch (InputError const&) {
  }
  if (bytes.starts_with("\x89HDF")) return 0;
  (void)parse_numbers(bytes, NonFinite::kept, HeaderRow::allowed);
  (void)parse_curve(bytes);
  (void)parse_named_curve(bytes, strain_columns);
  try {
    (void)parse_coupling(bytes, "coupling.csv", "1/m", "m");
  } catch (InputError const&) {
  }
  try {
    (void)parse_gps(bytes);
  } catch (InputError const&) {
  }
  return 0;
}
