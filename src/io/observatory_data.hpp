// SPDX-License-Identifier: BSD-3-Clause
// Data of the observatories, which python/straytrace/observatory reads: frame files (.gwf), lists of them (.ffl of
// Virgo, .lcf and .cache of LAL), NDS2 servers (nds2://HOST:PORT), and files of segments.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/namespaces.hpp"

namespace straytrace::io {

// By the name alone, so that a stored model needs no file.
bool is_observatory_data(std::string_view source);

struct ObservatoryRequest {
  std::string source, channel;       // an empty channel: the only one
  double from = -1e300, to = 1e300;  // GPS, s; infinite ends: all that there is
  bool gaps = false;                 // samples that are missing or flagged in the frames are NaN, not an error
};

struct ObservatoryData {
  std::string bytes;        // HDF5 as gwpy writes it, or text; samples from before `from` to behind `to`
  std::string warnings;     // a line each
  std::string why, remedy;  // of a failure; empty: success
};
ObservatoryData observatory_record(ObservatoryRequest const&);
// Two columns of GPS times from LIGO_LW (.xml), HDF5 of gwpy or JSON of DQSegDB; an empty flag: the only one.
ObservatoryData observatory_segments(std::string const& file, std::string const& flag);

// "V1.ffl::V1:Hrec@1000000000..1000000064": the name under which a run file keeps the samples.
std::string kept_name(ObservatoryRequest const&);
// Empty for names of other files.
std::optional<ObservatoryRequest> request_of_name(std::string const& name);

}  // namespace straytrace::io
