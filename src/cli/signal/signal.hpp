// SPDX-License-Identifier: BSD-3-Clause
// Parts of straytrace signal. Inside the room.
#pragma once

#include "cli/data_options.hpp"

namespace straytrace::cli {

// Each adds commands below `signal`; the chosen one runs after parsing and sets `exit_code`.
void add_signal_spectra(CLI::App& signal, int& exit_code);  // psd, coherence, transfer
void add_signal_records(CLI::App& signal, int& exit_code);  // displacement, whiten, convert
void add_signal_rms(CLI::App& signal, int& exit_code);
void add_signal_maps(CLI::App& signal, int& exit_code);  // spectrogram, q

// Rows of a sheet at about `count` places, even in the logarithm where the axis is logarithmic, for people.
std::string some_rows(CurveSheet const&, std::size_t count);
std::string note_lines(std::vector<std::string> const& notes);

// Lines of a sheet within a band, both ends included.
void keep_band(CurveSheet&, FrequencyBand);

}  // namespace straytrace::cli
