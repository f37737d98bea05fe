// SPDX-License-Identifier: BSD-3-Clause
// Transfer functions between a carrier and a body: structures with resonances, suspensions, measured tables.
#pragma once

#include <memory>

#include "base/input/table.hpp"
#include "spectra/transfer_function.hpp"

namespace straytrace::motion {

// Shared by bodies that move alike; null: 1.
using Transfer = std::shared_ptr<TransferFunction const>;
// First `a`, then `b`.
Transfer chained(Transfer const& a, Transfer const& b);

// Whether a chain is valid from `low` to `high` Hz; a problem at `where` otherwise.
bool covers(Transfer const&, double low, double high, Node const& where);
// Factor on the amplitude of a tone, for exp(+2 pi i f t). 1 and a problem outside the range of the chain.
std::complex<double> at_tone(Transfer const&, double hz, Node const& where);

// `through` of a motion: one link or a list of them, from the carrier to the body. A link is {resonance: {frequency:,
// quality:}}, {mode: {...}} for the motion relative to its carrier, {pendulum: STAGES}, {zeros:, poles:, gain:} or
// {file: FILE, columns: [Hz, re, im]}, with `beyond: hold` as an option. Problems go to the document.
Transfer read_chain(Node const& through);

// Stages of a suspension, from its support to the last mass: {frequency: 0.6 Hz, quality: 10} or a list of them, one
// for each NORMAL MODE, or {masses: [...], lengths: [...], quality: 10} from the top down. The transfer function from
// the support to the last of a chain of point masses has no zeros: it is the product of one low pass for each normal
// mode.
TransferFunction read_stages(Node const& stages);

// Normal modes of a chain of pendulums, Hz, rising: masses [kg] and lengths [m] from the top down.
std::vector<double> pendulum_modes(std::vector<double> const& masses, std::vector<double> const& lengths);

}  // namespace straytrace::motion
