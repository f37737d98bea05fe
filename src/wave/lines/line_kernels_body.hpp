// SPDX-License-Identifier: BSD-3-Clause
// The loops of line_kernels.cpp, included once for each instruction set, in a namespace of its own. STRAY_LANES:
// numbers of a vector.

#define STRAY_MEMBER inline __attribute__((always_inline))
#define STRAY_ALWAYS static STRAY_MEMBER

constexpr int lanes = STRAY_LANES;
typedef double Vector __attribute__((vector_size(8 * lanes)));
typedef double VectorInMemory __attribute__((vector_size(8 * lanes), may_alias, aligned(8)));
using Element = Pair<Vector>;  // the same element of as many lines

STRAY_ALWAYS VectorInMemory& vector_at(double* at) { return *reinterpret_cast<VectorInMemory*>(at); }
STRAY_ALWAYS VectorInMemory const& vector_at(double const* at) { return *reinterpret_cast<VectorInMemory const*>(at); }

// Elements lie as `lanes` real and `lanes` imaginary parts.
STRAY_ALWAYS Element loaded(double const* at) { return {vector_at(at), vector_at(at + lanes)}; }
STRAY_ALWAYS void store(double* at, Element const& x) {
  vector_at(at) = x.re;
  vector_at(at + lanes) = x.im;
}

constexpr int element_size = 2 * lanes;

template <int radix>
static void split(double* x, int points, double const* twiddle) {
  int const part = points / radix;
  for (int j = 0; j < part; ++j) {
    Element a[radix];
    for (int k = 0; k < radix; ++k) a[k] = loaded(x + (j + k * part) * element_size);
    transform<radix, -1>(a);
    store(x + j * element_size, a[0]);
    for (int q = 1; q < radix; ++q) {
      Element const turned = times(a[q], twiddle[0], -twiddle[1]);
      store(x + (j + q * part) * element_size, turned);
      twiddle += 2;
    }
  }
}

template <int radix>
static void join(double* x, int points, double const* twiddle) {
  int const part = points / radix;
  for (int j = 0; j < part; ++j) {
    Element a[radix];
    a[0] = loaded(x + j * element_size);
    for (int q = 1; q < radix; ++q) {
      a[q] = times(loaded(x + (j + q * part) * element_size), twiddle[0], twiddle[1]);
      twiddle += 2;
    }
    transform<radix, 1>(a);
    for (int k = 0; k < radix; ++k) store(x + (j + k * part) * element_size, a[k]);
  }
}

struct Step {
  void (*split)(double* x, int points, double const* twiddle);
  void (*join)(double* x, int points, double const* twiddle);
};
template <std::size_t... kind>
constexpr std::array<Step, sizeof...(kind)> steps_of(std::index_sequence<kind...>) {
  return {{{split<LinePlan::radices[kind]>, join<LinePlan::radices[kind]>}...}};
}
constexpr auto steps = steps_of(std::make_index_sequence<std::size(LinePlan::radices)>());

// Depth first, so that parts stay in the cache.
static void transform_forward(LinePlan const& plan, double* x, int points, int step = 0) {
  if (step == plan.steps) return;
  int const radix = LinePlan::radices[plan.kind[step]], part = points / radix;
  steps[std::size_t(plan.kind[step])].split(x, points, plan.twiddles[step]);
  if (part > 1)
    for (int q = 0; q < radix; ++q) transform_forward(plan, x + q * part * element_size, part, step + 1);
}
static void transform_inverse(LinePlan const& plan, double* x, int points, int step = 0) {
  if (step == plan.steps) return;
  int const radix = LinePlan::radices[plan.kind[step]], part = points / radix;
  if (part > 1)
    for (int q = 0; q < radix; ++q) transform_inverse(plan, x + q * part * element_size, part, step + 1);
  steps[std::size_t(plan.kind[step])].join(x, points, plan.twiddles[step]);
}

STRAY_ALWAYS void clear(double* x, int first, int last) {
  for (int i = first * element_size; i < last * element_size; i += lanes) vector_at(x + i) = Vector{};
}

// Rows of `lanes` numbers become columns.
STRAY_ALWAYS void transpose(Vector (&a)[lanes]) {
#if STRAY_LANES == 2
  Vector const b = a[0];
  a[0] = __builtin_shufflevector(b, a[1], 0, 2);
  a[1] = __builtin_shufflevector(b, a[1], 1, 3);
#elif STRAY_LANES == 4
  Vector b[4];
  for (int i = 0; i < 4; i += 2) {
    b[i] = __builtin_shufflevector(a[i], a[i + 1], 0, 4, 2, 6);
    b[i + 1] = __builtin_shufflevector(a[i], a[i + 1], 1, 5, 3, 7);
  }
  for (int i = 0; i < 2; ++i) {
    a[i] = __builtin_shufflevector(b[i], b[i + 2], 0, 1, 4, 5);
    a[i + 2] = __builtin_shufflevector(b[i], b[i + 2], 2, 3, 6, 7);
  }
#else
  Vector b[8], c[8];
  for (int i = 0; i < 8; i += 2) {
    b[i] = __builtin_shufflevector(a[i], a[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    b[i + 1] = __builtin_shufflevector(a[i], a[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int i = 0; i < 8; i += 4)
    for (int j = i; j < i + 2; ++j) {
      c[j] = __builtin_shufflevector(b[j], b[j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      c[j + 2] = __builtin_shufflevector(b[j], b[j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  for (int j = 0; j < 4; ++j) {
    a[j] = __builtin_shufflevector(c[j], c[j + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    a[j + 4] = __builtin_shufflevector(c[j], c[j + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
#endif
}

// Lines beyond the last are copies of it.
template <bool is_forward>
static void transform_lines(LinePlan const& plan, double* work, Lines const& lines) {
  int const N = plan.points;
  int const* const position = plan.position;
  for (int from = 0; from < lines.count; from += lanes) {
    double* line[lanes];
    for (int i = 0; i < lanes; ++i) line[i] = lines.line[from + i < lines.count ? from + i : lines.count - 1];
    for (int i = 0; i < N; ++i) {
      if (i == lines.given_first) i = lines.given_last;
      if (i >= N) break;
      int const p = is_forward ? i : position[i];
      clear(work, p, p + 1);
    }
    for (int i = lines.given_first; i < lines.given_last; ++i) {
      double* const to = work + (is_forward ? i : position[i]) * element_size;
      for (int k = 0; k < lanes; ++k) {
        to[k] = line[k][2 * i * lines.step];
        to[k + lanes] = line[k][2 * i * lines.step + 1];
      }
    }
    if constexpr (is_forward)
      transform_forward(plan, work, N);
    else
      transform_inverse(plan, work, N);
    for (int i = lines.wanted_first; i < lines.wanted_last; ++i) {
      double const* const at = work + (is_forward ? position[i] : i) * element_size;
      for (int k = 0; k < lanes; ++k) {
        line[k][2 * i * lines.step] = at[k] * lines.factor;
        line[k][2 * i * lines.step + 1] = at[k + lanes] * lines.factor;
      }
    }
  }
}

// What a leg is to `lanes` columns from m on; zero beyond Nyquist's frequency.
struct Columns {
  Vector x_squared;
  Element paraxial;
  double largest = 0, smallest = 1e300;  // of x_squared

  STRAY_MEMBER Columns(LegTables const& leg, int points, int m) {
    for (int k = 0; k < lanes; ++k, ++m) {
      int const column = 2 * (m < 0 ? m + points : m);
      double const x = m * leg.angle_step;
      bool const there = -points / 2 <= m && m < points / 2;
      x_squared[k] = x * x;
      paraxial.re[k] = there ? leg.scale * leg.paraxial[column] : 0;
      paraxial.im[k] = there ? leg.scale * leg.paraxial[column + 1] : 0;
      largest = x * x > largest ? x * x : largest;
      smallest = x * x < smallest ? x * x : smallest;
    }
  }
};

// At row frequency n; false: all zero.
STRAY_ALWAYS bool leg_factor(LegTables const& leg, int points, int n, Columns const& columns, Element& factor) {
  double const y = n * leg.angle_step, y_squared = y * y;
  if (columns.smallest + y_squared >= leg.cut_squared) return false;
  int const row = 2 * (n < 0 ? n + points : n);
  Vector const angle_squared = columns.x_squared + y_squared;
  factor = times(columns.paraxial, leg.paraxial[row], leg.paraxial[row + 1]);
  if (leg.quartic > 0) {
    Vector const phase = leg.quartic * angle_squared * angle_squared, re = 1 - phase * phase / 2, im = -phase;
    factor = times(factor, re, im);
  }
  if (columns.largest + y_squared <= leg.keep_squared) return true;
  Vector limit;
  for (int k = 0; k < lanes; ++k) {
    double const a = angle_squared[k];
    double at = (a - leg.keep_squared) * leg.taper_scale;
    at = at < 0 ? 0 : at > leg.taper_steps ? leg.taper_steps : at;
    int const i = int(at);
    double const tapered = leg.taper[i] + (at - i) * (leg.taper[i + 1] - leg.taper[i]);
    limit[k] = a <= leg.keep_squared ? 1 : a >= leg.cut_squared ? 0 : tapered;
  }
  factor = {factor.re * limit, factor.im * limit};
  return true;
}

static void multiply_by_leg(LinePlan const& plan, double* work, int first_column, LegTables const& tables) {
  int const N = plan.points;
  Columns const columns(tables, N, first_column);
  for (int n = -N / 2; n < N / 2; ++n) {
    double* const at = work + plan.position[n < 0 ? n + N : n] * element_size;
    Element factor;
    if (leg_factor(tables, N, n, columns, factor))
      store(at, times(loaded(at), factor.re, factor.im));
    else
      store(at, Element{});
  }
}

// The first and the last `half` elements of a row of a spectrum, at row frequency n.
static void leg_row(LegTables const& tables, int points, int n, int half, double* row) {
  for (int m = -half; m < half; m += lanes) {
    Columns const columns(tables, points, m);
    Element factor;
    bool const any = leg_factor(tables, points, n, columns, factor);
    for (int k = 0; k < lanes && m + k < half; ++k) {
      double* const at = row + 2 * std::ptrdiff_t(m + k < 0 ? m + k + points : m + k);
      Pair<double> const x = any ? times(Pair<double>{at[0], at[1]}, factor.re[k], factor.im[k]) : Pair<double>{};
      at[0] = x.re;
      at[1] = x.im;
    }
  }
}

static void leg(LinePlan const& plan, double* work, BlockedField const& source, int block, BlockedField const& target,
                int target_block, LegTables const& tables, RowRange given, RowRange wanted) {
  constexpr int row_size = 2 * block_lines;
  int const N = plan.points;
  for (int part = 0; part < block_lines; part += lanes) {
    double const* const from = source.block(block) + part - std::ptrdiff_t(source.first_row) * row_size;
    double* const to = target.block(target_block) + part - std::ptrdiff_t(target.first_row) * row_size;
    if (!source.spectrum) {
      clear(work, 0, given.first);
      clear(work, given.last, N);
    }
    for (int row = given.first; row < given.last; ++row)
      store(work + (source.spectrum ? plan.position[row] : row) * element_size,
            {vector_at(from + row * row_size), vector_at(from + row * row_size + block_lines)});
    if (!source.spectrum) transform_forward(plan, work, N);
    if (!target.spectrum) {
      multiply_by_leg(plan, work, source.first_column(block) + part, tables);
      transform_inverse(plan, work, N);
    }
    for (int row = wanted.first; row < wanted.last; ++row) {
      Element const x = loaded(work + (target.spectrum ? plan.position[row] : row) * element_size);
      vector_at(to + row * row_size) = x.re;
      vector_at(to + row * row_size + block_lines) = x.im;
    }
  }
}

// Between `lanes` rows of a block, which start `from`, and elements m of the lines. Columns beyond Nyquist's frequency
// are left out.
template <bool into_work>
STRAY_ALWAYS void exchange(LinePlan const& plan, double* work, double* from, int first_column) {
  constexpr int row_size = 2 * block_lines;
  int const N = plan.points;
  for (int part = 0; part < block_lines; part += lanes) {
    double* at[lanes];
    bool all = true;
    for (int k = 0; k < lanes; ++k) {
      int const m = first_column + part + k;
      bool const there = -N / 2 <= m && m < N / 2;
      at[k] = there ? work + plan.position[m < 0 ? m + N : m] * element_size : nullptr;
      all = all && there;
    }
    for (int half = 0; half < 2; ++half) {
      double* const rows = from + part + half * block_lines;
      Vector tile[lanes];
      if constexpr (into_work) {
        for (int k = 0; k < lanes; ++k) tile[k] = vector_at(rows + k * row_size);
        transpose(tile);
        for (int k = 0; k < lanes; ++k)
          if (all || at[k]) vector_at(at[k] + half * lanes) = tile[k];
      } else {
        for (int k = 0; k < lanes; ++k) tile[k] = all || at[k] ? vector_at(at[k] + half * lanes) : Vector{};
        transpose(tile);
        for (int k = 0; k < lanes; ++k) vector_at(rows + k * row_size) = tile[k];
      }
    }
  }
}

STRAY_ALWAYS void multiply_rows(int points, double* work, PlaneFactor const& factor, double const* (&rows)[lanes],
                                std::ptrdiff_t to_im) {
  int column = 0;
  for (; column + lanes <= points; column += lanes) {
    Vector re[lanes], im[lanes];
    for (int k = 0; k < lanes; ++k) re[k] = vector_at(rows[k] + column);
    transpose(re);
    if (factor.im) {
      for (int k = 0; k < lanes; ++k) im[k] = vector_at(rows[k] + to_im + column);
      transpose(im);
    }
    for (int k = 0; k < lanes; ++k) {
      double* const at = work + (column + k) * element_size;
      Element const x = loaded(at);
      store(at, factor.im ? times(x, re[k], im[k]) : Element{x.re * re[k], x.im * re[k]});
    }
  }
  for (; column < points; ++column)
    for (int k = 0; k < lanes; ++k) {
      double* const at = work + column * element_size + k;
      double const re = rows[k][column], im = factor.im ? rows[k][to_im + column] : 0;
      Pair<double> const x{at[0], at[lanes]};
      Pair<double> const y = factor.im ? times(x, re, im) : Pair<double>{x.re * re, x.im * re};
      at[0] = y.re;
      at[lanes] = y.im;
    }
}

// Real and imaginary parts side by side.
STRAY_ALWAYS void interleave(Vector const& re, Vector const& im, Vector& first, Vector& second) {
#if STRAY_LANES == 2
  first = __builtin_shufflevector(re, im, 0, 2);
  second = __builtin_shufflevector(re, im, 1, 3);
#elif STRAY_LANES == 4
  first = __builtin_shufflevector(re, im, 0, 4, 1, 5);
  second = __builtin_shufflevector(re, im, 2, 6, 3, 7);
#else
  first = __builtin_shufflevector(re, im, 0, 8, 1, 9, 2, 10, 3, 11);
  second = __builtin_shufflevector(re, im, 4, 12, 5, 13, 6, 14, 7, 15);
#endif
}

// The first `count` rows of `lanes` into a field, interleaved, from its row `row` on.
static void write_rows(double const* work, int points, int row, int count, double* field) {
  int column = 0;
  for (; column + lanes <= points; column += lanes) {
    Vector re[lanes], im[lanes];
    for (int k = 0; k < lanes; ++k) {
      Element const x = loaded(work + (column + k) * element_size);
      re[k] = x.re;
      im[k] = x.im;
    }
    transpose(re);
    transpose(im);
    for (int k = 0; k < count; ++k) {
      double* const to = field + 2 * (std::ptrdiff_t(row + k) * points + column);
      Vector first, second;
      interleave(re[k], im[k], first, second);
      vector_at(to) = first;
      vector_at(to + lanes) = second;
    }
  }
  for (; column < points; ++column)
    for (int k = 0; k < count; ++k) {
      double* const to = field + 2 * (std::ptrdiff_t(row + k) * points + column);
      to[0] = work[column * element_size + k];
      to[1] = work[column * element_size + k + lanes];
    }
}

static void plane(LinePlan const& plan, double* work, BlockedField const& field, int row, int last,
                  PlaneFactor const& factor, int given, int wanted, double* seen, RowRange passing) {
  constexpr int row_size = 2 * block_lines;
  int const N = plan.points;
  std::ptrdiff_t const to_im = factor.im ? factor.im - factor.re : 0;
  for (int from = row; from < row + block_lines && from < last; from += lanes) {
    std::ptrdiff_t const offset = std::ptrdiff_t(from - field.first_row) * row_size;
    int const half = (field.blocks / 2 - given) * block_lines;
    for (int m = half; m < N - half; ++m) clear(work, plan.position[m], plan.position[m] + 1);
    for (int b = given; b < field.blocks - given; ++b)
      exchange<true>(plan, work, field.block(b) + offset, field.first_column(b));
    transform_inverse(plan, work, N);
    if (seen) write_rows(work, N, from, last - from < lanes ? last - from : lanes, seen);
    if (from >= passing.last || from + lanes <= passing.first) continue;
    double const* rows[lanes];
    for (int k = 0; k < lanes; ++k) rows[k] = factor.re + std::ptrdiff_t(from + k < last ? from + k : last - 1) * N;
    multiply_rows(N, work, factor, rows, to_im);
    transform_forward(plan, work, N);
    for (int b = wanted; b < field.blocks - wanted; ++b)
      exchange<false>(plan, work, field.block(b) + offset, field.first_column(b));
  }
}

static void forward(LinePlan const& plan, double* work, Lines const& lines) {
  transform_lines<true>(plan, work, lines);
}
static void inverse(LinePlan const& plan, double* work, Lines const& lines) {
  transform_lines<false>(plan, work, lines);
}

static void weigh(SampleWeights const& weights, double v, double* value, double* slope) {
  for (int from = 0; from < SampleWeights::points; from += lanes) {
    Vector sum = vector_at(weights.coefficients[SampleWeights::terms - 1] + from), derivative{};
    for (int n = SampleWeights::terms - 2; n >= 0; --n) {
      derivative = derivative * v + sum;
      sum = sum * v + vector_at(weights.coefficients[n] + from);
    }
    vector_at(value + from) = sum;
    vector_at(slope + from) = derivative;
  }
}

static void sample(SampleWeights const& weights, double along, double across, double const* const* rows, double* sums) {
  constexpr int points = SampleWeights::points, together = 4;  // vectors, to fill the pipelines
  double value[points], slope[points], column_value[2 * points], column_slope[2 * points];
  weigh(weights, across, value, slope);
  for (int from = 0; from < 2 * points; from += together * lanes) {
    Vector sum[together] = {}, derivative[together] = {};
    for (int i = 0; i < points; ++i)
      for (int k = 0; k < together; ++k) {
        Vector const x = vector_at(rows[i] + from + k * lanes);
        sum[k] += value[i] * x;
        derivative[k] += slope[i] * x;
      }
    for (int k = 0; k < together; ++k) {
      vector_at(column_value + from + k * lanes) = sum[k];
      vector_at(column_slope + from + k * lanes) = derivative[k];
    }
  }
  weigh(weights, along, value, slope);
  for (int k = 0; k < 6; ++k) sums[k] = 0;
  for (int i = 0; i < points; ++i)
    for (int part = 0; part < 2; ++part) {
      sums[part] += value[i] * column_value[2 * i + part];
      sums[2 + part] += slope[i] * column_value[2 * i + part];
      sums[4 + part] += value[i] * column_slope[2 * i + part];
    }
}

#undef STRAY_ALWAYS
#undef STRAY_MEMBER
