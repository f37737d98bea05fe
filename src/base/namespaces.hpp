// SPDX-License-Identifier: BSD-3-Clause
// Each module has a namespace of its own, except `base`, whose names are in `straytrace`. The directives let a module
// write the names of the modules it may include without qualification; tools/lint/check_includes.py reads them as the
// list of the modules that each may include, and docs/develop/architecture.md explains it.
#pragma once

namespace straytrace {

namespace io {}
namespace geometry {}
namespace optics {}
namespace beams {
using namespace geometry;
using namespace optics;
}  // namespace beams
namespace spectra {
using namespace io;
}
namespace analysis {
using namespace io;
using namespace spectra;
}  // namespace analysis
namespace motion {
using namespace io;
using namespace spectra;
}  // namespace motion
namespace scene {
using namespace io;
}
namespace world {
using namespace io;
using namespace geometry;
using namespace optics;
using namespace beams;
using namespace scene;
}  // namespace world
namespace wave {
using namespace io;
using namespace geometry;
using namespace optics;
using namespace beams;
using namespace spectra;
using namespace scene;
using namespace world;
}  // namespace wave
namespace trace {
using namespace geometry;
using namespace optics;
using namespace beams;
using namespace world;
using namespace wave;
}  // namespace trace
namespace ifo {
using namespace beams;
using namespace spectra;
}  // namespace ifo
namespace noise {
using namespace beams;
using namespace spectra;
using namespace motion;
using namespace trace;
using namespace ifo;
}  // namespace noise
namespace results {
using namespace io;
using namespace spectra;
using namespace motion;
using namespace beams;
using namespace scene;
using namespace world;
using namespace trace;
using namespace ifo;
using namespace noise;
}  // namespace results
namespace report {
using namespace io;
using namespace geometry;
using namespace beams;
using namespace motion;
using namespace scene;
using namespace world;
using namespace trace;
using namespace noise;
using namespace results;
}  // namespace report
namespace session {
using namespace io;
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
}  // namespace session
namespace cli {
using namespace io;
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
}  // namespace cli
namespace api {
using namespace scene;
using namespace trace;
using namespace noise;
using namespace results;
using namespace session;
}  // namespace api

}  // namespace straytrace
