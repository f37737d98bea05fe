// SPDX-License-Identifier: BSD-3-Clause
// The table of inputs that are not exactly known: the one list of its columns behind text, JSON and pages.
#pragma once

#include <string>
#include <vector>

#include "results/text/table.hpp"

namespace straytrace::results {

struct SourceRow {
  InputSource const& source;
  std::string status;  // of its material, or "assumed"; empty: not known
};

std::vector<SourceRow> source_rows(NoiseBands const&, ProjectionInputs const* = nullptr);
TableWriter<SourceRow> const& source_table();

}  // namespace straytrace::results
