// SPDX-License-Identifier: BSD-3-Clause
// For tests, benchmarks and fuzzers: their namespaces, which are in `straytrace`, see the names of every module. No
// file of src/ includes it.
#pragma once

#include "base/namespaces.hpp"

namespace straytrace {

using namespace io;
using namespace geometry;
using namespace optics;
using namespace beams;
using namespace spectra;
using namespace analysis;
using namespace motion;
using namespace scene;
using namespace world;
using namespace wave;
using namespace trace;
using namespace ifo;
using namespace noise;
using namespace results;
using namespace report;
using namespace session;
using namespace cli;

}  // namespace straytrace
