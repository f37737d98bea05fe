// SPDX-License-Identifier: BSD-3-Clause
// Loops over the rows and columns of a field for the instruction set of the processor; all give the same bits.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <string_view>
#include <vector>

namespace straytrace::wave {

// One-dimensional transform of N points in place, in steps of radix 2 to 8. The spectrum comes out, and goes in, in the
// order of its digits: frequency f at `position[f]`.
struct LinePlan {
  static constexpr int radices[] = {8, 4, 5, 3, 2};
  static constexpr int most_steps = std::numeric_limits<int>::digits;  // N is below 2^31
  int points = 0, steps = 0;
  int kind[most_steps];                // of each step, largest distance first: which of the radices
  double const* twiddles[most_steps];  // cos, sin of 2 pi j q/n for q = 1 to radix - 1 of each j below n/radix
  int const* position = nullptr;
};

constexpr int block_lines = 8;  // rows or columns at once

// A field with rows in space and columns in frequency, in blocks of 8 neighbouring columns: 8 real and 8 imaginary
// parts for each row of each block. Rows `first_row` on, columns -8 blocks/2 on; those beyond Nyquist's frequency hold
// nothing. Or the rows are frequencies too, all N in the order of Grid::frequency.
struct BlockedField {
  double* values = nullptr;
  int first_row = 0, rows = 0, blocks = 0;
  bool spectrum = false;
  double* block(int b) const { return values + std::ptrdiff_t(b) * rows * 2 * block_lines; }
  int first_column(int b) const { return (b - blocks / 2) * block_lines; }
};

struct RowRange {
  int first = 0, last = 0;
};

// Eq. W.3 and W.4 as tables: exp(i phase) = paraxial(n) paraxial(m) and the limit between keep and cut, by the angle
// squared, then 0.
struct LegTables {
  double const* paraxial = nullptr;  // cos, sin of each frequency
  double const* taper = nullptr;     // of angle^2 = keep^2 + i/taper_scale, i = 0 to taper_steps, and once more
  int taper_steps = 0;
  double keep_squared = 0, cut_squared = 0, taper_scale = 0, angle_step = 0, quartic = 0;
  double scale = 1;  // on top
};

// Numbers that multiply a field, by row and column; without `im` they are real.
struct PlaneFactor {
  double const* re = nullptr;
  double const* im = nullptr;
};

// Interleaved complex numbers: element i of line j is lines[j][2 i step].
struct Lines {
  double* line[block_lines];
  int count = 0;
  std::ptrdiff_t step = 1;
  int given_first = 0, given_last = 0;    // elements outside are zero
  int wanted_first = 0, wanted_last = 0;  // elements outside are left as they are
  double factor = 1;
};

// Weights by which the points of a row or a column about a place are added up for the field there: between two points,
// polynomials of v, from -1 at the lower one to 1 at the upper one, which is number points/2.
struct SampleWeights {
  static constexpr int points = 48, terms = 14;
  double coefficients[terms][points] = {};  // of v^n
};

struct LineKernels {
  char const* name;
  // `work`: 16 N numbers, aligned to 64 bytes, of the thread.
  void (*forward)(LinePlan const&, double* work, Lines const&);
  void (*inverse)(LinePlan const&, double* work, Lines const&);
  // A block of columns through a leg, from rows `given` into rows `wanted` of another field or the same. Into a
  // spectrum: only transforms.
  void (*leg)(LinePlan const&, double* work, BlockedField const& from, int block, BlockedField const& to,
              int target_block, LegTables const&, RowRange given, RowRange wanted);
  // A row of a spectrum times the factor of a leg, at row frequency n: its first and last `half` elements, interleaved.
  void (*leg_row)(LegTables const&, int points, int n, int half, double* row);
  // 8 rows from `row` on through a plane, of which those before `last` are wanted. Takes the columns of blocks `given`
  // to blocks - given, writes those from `wanted` on likewise. `seen`: a whole field, interleaved, into which the rows
  // are written as they arrive, or null. `passing`: only looked at where none of them is among these.
  void (*plane)(LinePlan const&, double* work, BlockedField const&, int row, int last, PlaneFactor const&, int given,
                int wanted, double* seen, RowRange passing);
  // The field at a place, of parts of 48 rows of 48 interleaved numbers: re, im of the value, of the derivative along
  // the rows and of that across them, per v.
  void (*sample)(SampleWeights const&, double along, double across, double const* const* rows, double* sums);
};

LineKernels const* find_line_kernels(std::string_view name);  // "portable", "avx2" or "avx512"; null: not here
extern LineKernels const* line_kernels;                       // fastest of this processor, or STRAYTRACE_ISA

// Tables of the one-dimensional transform of N points, and the memory of the threads that run it.

class LineTables {
 public:
  explicit LineTables(int points);  // InputError if it has a prime factor above 5
  LineTables(LineTables const&) = delete;
  LineTables& operator=(LineTables const&) = delete;

  LinePlan const& plan() const { return plan_; }
  // Calls use(work) with memory that no other thread has.
  template <class Use>
  void with_work(Use const& use) const {
    Work work = take();
    use(work.get());
    std::lock_guard const lock(mutex_);
    idle_.push_back(std::move(work));
  }

 private:
  struct Free {
    void operator()(double* p) const { ::operator delete[](p, std::align_val_t{64}); }
  };
  using Work = std::unique_ptr<double[], Free>;
  Work take() const;

  LinePlan plan_{};
  std::vector<std::vector<double>> twiddles_;
  std::vector<int> position_;
  mutable std::mutex mutex_;
  mutable std::vector<Work> idle_;
};

}  // namespace straytrace::wave
