// SPDX-License-Identifier: BSD-3-Clause
// Several runs in one HTML page, each compared with the first: `straytrace report A.h5 B.h5`.
#pragma once

#include <string>
#include <vector>

#include "results/results.hpp"

namespace straytrace::session {

// "before", "after" of before/run.h5 and after/run.h5, without the folders above them; names of two runs that are
// alike get their number.
std::vector<std::string> run_labels(std::vector<std::string> const& files);

// Reads all of them. Throws one InputError with the problems of all: at least two runs, each with noise in a band that
// overlaps that of the first.
std::vector<RunFile> read_compared(std::vector<std::string> const& files);

// `title`: empty for one of the labels.
std::string comparison_page(std::vector<RunFile> const&, std::vector<std::string> const& labels,
                            std::string const& title);

}  // namespace straytrace::session
