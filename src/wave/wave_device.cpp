// SPDX-License-Identifier: BSD-3-Clause
#include "wave/wave_device.hpp"

#include <algorithm>

#include "base/errors.hpp"
#include "base/process/child_process.hpp"
#include "base/process/threads.hpp"

namespace straytrace::wave {

HostTrip::HostTrip(LineTables const& tables, Grid const& grid, std::vector<LegAndPlane> legs, int threads)
    : tables_(tables), grid_(grid), legs_(std::move(legs)), threads_(unsigned(std::max(0, threads))) {
  for (LegAndPlane& p : legs_) {
    p.leg.scale = 1 / (double(grid.points) * grid.points);  // of the transforms there and back
    blocks_ = std::max(blocks_, blocks_of(p));
    rows_ = std::max(rows_, p.rows);
  }
}

void HostTrip::take(Field const& spectrum, BlockedField const& blocked) const {
  int const N = grid_.points;
  for_rows(0, N, int(threads_), [&](int row) {
    for (int b = 0; b < blocked.blocks; ++b)
      for (int k = 0, m = blocked.first_column(b); k < block_lines; ++k, ++m) {
        bool const there = -N / 2 <= m && m < N / 2;
        Complex const z = there ? spectrum(row, m < 0 ? m + N : m) : Complex{};
        double* const at = blocked.block(b) + std::ptrdiff_t(row) * 2 * block_lines + k;
        at[0] = z.real();
        at[block_lines] = z.imag();
      }
  });
}

void HostTrip::put(BlockedField const& blocked, Field& spectrum) const {
  int const N = grid_.points, half = legs_.front().columns / 2;
  for_rows(0, N, int(threads_), [&](int row) {
    std::fill_n(&spectrum(row, 0), N, Complex{});
    for (int b = 0; b < blocked.blocks; ++b)
      for (int k = 0, m = blocked.first_column(b); k < block_lines; ++k, ++m) {
        if (m < -half || m >= half) continue;
        double const* const at = blocked.block(b) + std::ptrdiff_t(row) * 2 * block_lines + k;
        spectrum(row, m < 0 ? m + N : m) = {at[0], at[block_lines]};
      }
  });
}

void HostTrip::columns(ThreadTeam& team, LegAndPlane const& here, BlockedField const& from, BlockedField const& to,
                       RowRange given, RowRange wanted) const {
  int const count = blocks_of(here), unused_from = (from.blocks - count) / 2, unused_to = (to.blocks - count) / 2;
  team.run(std::size_t(count), [&](std::size_t i) {
    tables_.with_work([&](double* work) {
      line_kernels->leg(tables_.plan(), work, from, unused_from + int(i), to, unused_to + int(i), here.leg, given,
                        wanted);
    });
  });
}

void HostTrip::rows(ThreadTeam& team, LegAndPlane const& here, LegAndPlane const& next, BlockedField const& field,
                    Field* seen) const {
  RowRange const passing = rows_of(here, grid_.points), range = seen ? RowRange{0, grid_.points} : passing;
  double* const out = seen ? reinterpret_cast<double*>(seen->values.data()) : nullptr;
  int const given = (field.blocks - blocks_of(here)) / 2, wanted = (field.blocks - blocks_of(next)) / 2;
  team.run(std::size_t((range.last - range.first + block_lines - 1) / block_lines), [&](std::size_t i) {
    tables_.with_work([&](double* work) {
      line_kernels->plane(tables_.plan(), work, field, range.first + int(i) * block_lines, range.last, here.plane,
                          given, wanted, out, passing);
    });
  });
}

void HostTrip::run(Field& spectrum, Watch const& watch) const {
  int const N = grid_.points;
  BlockedField frequencies{nullptr, 0, N, blocks_of(legs_.front()), true};
  // The last group of rows of a plane may reach beyond it.
  int const kept = watch.seen ? N : rows_;
  BlockedField field{nullptr, N / 2 - kept / 2, kept + block_lines, blocks_, false};
  Field arriving(watch.seen ? grid_ : Grid{});
  std::vector<double> first(size_of(frequencies)), second(size_of(field));
  frequencies.values = first.data();
  field.values = second.data();
  take(spectrum, frequencies);
  ThreadTeam team(threads_);
  RowRange const all{0, N};
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    LegAndPlane const& here = legs_[i];
    bool const seen = watch.at(i);
    RowRange const wanted = seen ? all : rows_of(here, N);
    if (i == 0)
      columns(team, here, frequencies, field, all, wanted);
    else
      columns(team, here, field, field, rows_of(legs_[i - 1], N), wanted);
    rows(team, here, legs_[(i + 1) % legs_.size()], field, seen ? &arriving : nullptr);
    if (seen) watch.seen(i, arriving);
  }
  columns(team, legs_.front(), field, frequencies, rows_of(legs_.back(), N), all);
  put(frequencies, spectrum);
}

namespace {

constexpr char const* on_host = "use --backend cpu, whose fields agree to rounding";

}  // namespace

std::unique_ptr<DeviceTrip> prepared(WaveDevice& device, Grid const& grid, std::vector<LegAndPlane> legs) {
  try {
    return device.trip(grid, std::move(legs));
  } catch (std::runtime_error const& e) {
    throw InputError("wave: " + device.name() + ": " + e.what(),
                     std::string("choose fewer 'points' of 'grid', or ") + on_host);
  }
}

void run(DeviceTrip& trip, Field& spectrum, Watch const& watch) {
  try {
    trip.run(spectrum, watch);
  } catch (NumericalError const&) {  // of those who look
    throw;
  } catch (std::runtime_error const& e) {
    throw NumericalError(std::string("wave: ") + e.what() + "; " + on_host);
  }
}

std::shared_ptr<WaveDevice> load_waves(std::string const& library) {
  auto const make = reinterpret_cast<MakeWaveDevice>(
      library_symbol(library, "straytrace_wave_device", std::string("build it again, or ") + on_host));
  try {
    return std::shared_ptr<WaveDevice>(make(wave_device_abi));
  } catch (std::exception const& e) {
    throw InputError(e.what(), on_host);
  }
}

std::shared_ptr<WaveDevice> cuda_waves() {
  std::string const library = installed_library("libstraytrace_cufft.so");
  if (library.empty())
    throw InputError("this straytrace was built without cuFFT, which computes fields on a GPU",
                     std::string("build it where nvcc and cuFFT are found (docs/guide/gpu.md), or ") + on_host);
  return load_waves(library);
}

}  // namespace straytrace::wave
