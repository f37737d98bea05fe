// SPDX-License-Identifier: BSD-3-Clause
// The Fourier transform of fields against its definition and Eigen's, without the parts that are zero, and on several
// threads.
#include "wave/transform.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "base/every_module.hpp"
#include "base/math/rng.hpp"
#include "spectra/fourier.hpp"
#include "wave/lines/line_kernels.hpp"

namespace straytrace {
namespace {

using wave::Complex;

// Random numbers in the rows about the middle, zero elsewhere.
Field noise_of_rows(int points, int rows) {
  Field field({points, 1.0});
  for (int row = points / 2 - rows / 2; row < points / 2 + rows / 2; ++row) {
    Rng rng(17, std::uint64_t(row), 0, Stream::source);
    for (int column = 0; column < points; ++column) field(row, column) = {rng.uniform() - 0.5, rng.uniform() - 0.5};
  }
  return field;
}

Complex sum_by_definition(Field const& f, int n, int m) {
  int const points = f.grid.points;
  std::complex<long double> sum = 0;
  for (int row = 0; row < points; ++row)
    for (int column = 0; column < points; ++column) {
      long double const turns = static_cast<long double>((n * row + m * column) % points) / points;
      sum += std::complex<long double>(f(row, column)) * std::polar(1.0L, -2 * std::numbers::pi_v<long double> * turns);
    }
  return {double(sum.real()), double(sum.imag())};
}

double largest_modulus(Field const& f) {
  double most = 0;
  for (Complex const& value : f.values) most = std::max(most, std::abs(value));
  return most;
}

double largest_difference(Field const& a, Field const& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) most = std::max(most, std::abs(a.values[i] - b.values[i]));
  return most;
}

bool same_field_bits(Field const& a, Field const& b) {
  return std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(Complex)) == 0;
}

TEST(FieldTransform, IsTheSumOfItsDefinition) {
  for (int const points : {2, 8, 18, 24, 30, 32}) {
    Field const field = noise_of_rows(points, points);
    Field spectrum = field;
    Transform(points).forward(spectrum, points, points);
    double const scale = largest_modulus(spectrum);
    double mirrored = 0;  // distance from the transform with the other sign
    for (int n = 0; n < points; ++n)
      for (int m = 0; m < points; ++m) {
        EXPECT_LT(std::abs(spectrum(n, m) - sum_by_definition(field, n, m)), 1e-14 * scale)
            << points << ": " << n << ", " << m;
        mirrored =
            std::max(mirrored, std::abs(spectrum((points - n) % points, (points - m) % points) - spectrum(n, m)));
      }
    if (points == 2) continue;  // where both signs are one
    EXPECT_GT(mirrored, 0.1 * scale) << "the field cannot tell the signs of the exponent apart";
  }
}

// Rows, then columns, with the transform of Eigen.
Field spectrum_by_eigen(Field field) {
  int const points = field.grid.points;
  spectra::Fourier fourier;
  spectra::Complexes line(static_cast<std::size_t>(points)), lines;
  for (bool const along_rows : {true, false})
    for (int j = 0; j < points; ++j) {
      auto const at = [&](int i) -> Complex& { return along_rows ? field(j, i) : field(i, j); };
      for (int i = 0; i < points; ++i) line[std::size_t(i)] = at(i);
      fourier.forward(line, lines);
      for (int i = 0; i < points; ++i) at(i) = lines[std::size_t(i)];
    }
  return field;
}

// Even, without prime factors above 5: those of a grid.
std::vector<int> grid_sizes(int most) {
  std::vector<int> sizes;
  for (int points = 2; points <= most; points += 2)
    if (spectra::has_fast_transform(std::size_t(points))) sizes.push_back(points);
  return sizes;
}

TEST(FieldTransform, IsThatOfEigen) {
  wave::LineKernels const* const chosen = wave::line_kernels;
  std::vector<int> sizes = grid_sizes(200);
  sizes.insert(sizes.end(), {432, 486, 500, 512, 640, 750});
  ASSERT_EQ(sizes.size(), 40u);
  for (int const points : sizes) {
    Field const field = noise_of_rows(points, points), expected = spectrum_by_eigen(field);
    double const scale = largest_modulus(expected);
    for (char const* const name : {"portable", "avx2", "avx512"}) {
      wave::line_kernels = wave::find_line_kernels(name);
      if (!wave::line_kernels) continue;  // not this processor
      Transform const transform(points);
      Field spectrum = field, back = expected;
      transform.forward(spectrum, points, points);
      transform.inverse(back, points, points);
      EXPECT_LT(largest_difference(spectrum, expected), 3e-15 * scale) << points << ", " << name;
      EXPECT_LT(largest_difference(back, field), 3e-15) << points << ", " << name;
    }
  }
  wave::line_kernels = chosen;
}

TEST(FieldTransform, OmitsOnlyWhatIsNotWanted) {
  for (auto const& [points, rows, columns] :
       {std::tuple(32, 10, 14), {32, 2, 32}, {96, 50, 34}, {100, 38, 6}, {512, 214, 358}}) {
    Transform const transform(points);
    Field pruned = noise_of_rows(points, rows), whole = pruned;
    transform.forward(whole, points, points);
    transform.forward(pruned, rows, columns);
    double dropped = 0;
    for (int n = 0; n < points; ++n)
      for (int m = columns / 2; m < points - columns / 2; ++m)
        dropped = std::max(dropped, std::abs(std::exchange(whole(n, m), 0)));
    EXPECT_TRUE(same_field_bits(pruned, whole)) << points;
    EXPECT_EQ(dropped > 0.1 * largest_modulus(whole), columns < points);

    Field back = pruned;
    transform.inverse(whole, points, points);
    transform.inverse(back, columns, rows);
    for (int row = 0; row < points; ++row)
      if (row < points / 2 - rows / 2 || row >= points / 2 + rows / 2)
        for (int column = 0; column < points; ++column) whole(row, column) = 0;
    EXPECT_TRUE(same_field_bits(back, whole)) << points;
  }
}

TEST(FieldTransform, IgnoresWhatIsSaidToBeZero) {
  int const points = 64, rows = 20, columns = 24;
  Transform const transform(points);
  Field clean = noise_of_rows(points, rows), dirty = noise_of_rows(points, points);
  transform.forward(clean, rows, columns);
  transform.forward(dirty, rows, columns);
  EXPECT_TRUE(same_field_bits(clean, dirty));
  for (int n = 0; n < points; ++n) dirty(n, points / 2) = 1;
  transform.inverse(clean, columns, rows);
  transform.inverse(dirty, columns, rows);
  EXPECT_TRUE(same_field_bits(clean, dirty));
}

TEST(FieldTransform, InverseUndoesForward) {
  for (int const points : {16, 90, 256, 1024}) {
    Transform const transform(points);
    Field const field = noise_of_rows(points, points);
    Field there_and_back = field;
    transform.forward(there_and_back, points, points);
    transform.inverse(there_and_back, points, points);
    EXPECT_LT(largest_difference(there_and_back, field), 1e-14) << points;
    there_and_back = field;
    transform.forward(there_and_back, points, points);
    transform.inverse(there_and_back, points - 2, points);
    EXPECT_GT(largest_difference(there_and_back, field), 1e-3) << "a missing frequency is not noticed";
  }
}

TEST(FieldTransform, SameBitsOnAnyNumberOfThreads) {
  for (int const points : {96, 250, 512}) {
    int const rows = 2 * (points / 5) + 2, columns = 2 * (points / 3);
    Field const field = noise_of_rows(points, rows);
    Field one = field, one_back = field;
    Transform const single(points);
    single.forward(one, rows, columns);
    one_back = one;
    single.inverse(one_back, columns, rows);
    for (int const threads : {2, 5}) {
      Transform const transform(points, threads);
      Field many = field;
      transform.forward(many, rows, columns);
      EXPECT_TRUE(same_field_bits(many, one)) << points << ", " << threads << " threads";
      transform.inverse(many, columns, rows);
      EXPECT_TRUE(same_field_bits(many, one_back)) << points << ", " << threads << " threads";
    }
    Field other = one;
    other.values[7] *= 1 + 1e-15;
    EXPECT_FALSE(same_field_bits(other, one));
  }
}

// Whatever the processor, its C library and the compiler: elementary functions of the program, and no contraction.
TEST(FieldTransform, SameBitsOnAnyProcessor) {
  wave::LineKernels const* const chosen = wave::line_kernels;
  for (char const* const name : {"portable", "avx2", "avx512"}) {
    wave::line_kernels = wave::find_line_kernels(name);
    if (!wave::line_kernels) continue;  // not this processor
    Field field = noise_of_rows(90, 90);
    Transform(90).forward(field, 90, 90);
    std::uint64_t hash = 0;
    for (Complex const& value : field.values)
      for (double const part : {value.real(), value.imag()}) hash = 1000003 * hash + std::bit_cast<std::uint64_t>(part);
    EXPECT_EQ(hash, 15662969188330105597u) << name;
  }
  wave::line_kernels = chosen;
}

}  // namespace
}  // namespace straytrace
