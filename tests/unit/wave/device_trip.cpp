// SPDX-License-Identifier: BSD-3-Clause
// Round trips on a device against those of the host: on the device whose library STRAYTRACE_TEST_WAVES names
// (tests/device/run.sh), otherwise with the work of a device done by the host.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "unit/wave/uneven_cavity.hpp"
#include "wave/device/trip_body.hpp"

namespace straytrace {
namespace {

using ::testing::AnyOf;
using testing::distance_of;
using ::testing::HasSubstr;
using testing::uneven_cavity;
using wave::Complex;
using wave::WaveDevice;

// What a machine has free, and the error that its copies end with.
std::size_t free_memory = std::size_t(-1);
std::string failure;

// With the transforms of the program. `sign`: -1 takes the conjugate of every leg, a wrong sign in eq. W.3.
template <int sign>
class HostMachine {
 public:
  class Memory {
   public:
    Memory() = default;
    explicit Memory(std::size_t count) : numbers_(new double[count]) {}
    double* get() const { return numbers_.get(); }

   private:
    std::unique_ptr<double[]> numbers_;
  };

  explicit HostMachine(int points) : transform_(points), work_(Grid{points, 1}) {}
  std::size_t work_bytes() const { return 16 * work_.values.size(); }
  std::size_t free_bytes() const { return free_memory; }
  void begin() {}
  void put(double* to, double const* from, std::size_t count) { std::memcpy(to, from, count * sizeof *to); }
  void get(double* to, double const* from, std::size_t count) {
    if (!failure.empty()) throw std::runtime_error(failure);
    std::memcpy(to, from, count * sizeof *to);
  }
  void transform(double* values, bool forward) {
    int const points = work_.grid.points;
    auto* const complex = reinterpret_cast<Complex*>(values);
    std::copy_n(complex, work_.values.size(), work_.values.begin());
    if (forward)
      transform_.forward(work_, points, points);
    else
      transform_.inverse(work_, points, points);
    for (std::size_t i = 0; i < work_.values.size(); ++i)
      complex[i] = work_.values[i] * (forward ? 1.0 : double(work_.values.size()));
  }
  template <class Work>
  void each(std::size_t count, Work const& work) {
    for (std::size_t i = count; i-- > 0;) work(std::uint32_t(i));  // no order is promised
  }
  void each(std::size_t count, wave::device::LegWork const& leg) {
    for (std::size_t i = count; i-- > 0;) {
      leg.spectrum[i].im *= sign;
      leg(std::uint32_t(i));
      leg.spectrum[i].im *= sign;
    }
  }

 private:
  Transform transform_;
  Field work_;
};

template <int sign>
class HostDevice final : public WaveDevice {
 public:
  std::string name() const override { return "the host as a device"; }
  std::unique_ptr<wave::DeviceTrip> trip(Grid const& grid, std::vector<wave::LegAndPlane> legs) override {
    return std::make_unique<wave::device::TripBody<HostMachine<sign>>>(grid, std::move(legs));
  }
};

std::shared_ptr<WaveDevice> tested_device() {
  if (char const* const library = std::getenv("STRAYTRACE_TEST_WAVES")) return wave::load_waves(library);
  return std::make_shared<HostDevice<1>>();
}
std::shared_ptr<WaveDevice> wrong_device() { return std::make_shared<HostDevice<-1>>(); }

std::array<std::vector<double>, 2> heights_for(Grid const& grid) {
  std::array<std::vector<double>, 2> heights;
  for (std::size_t mirror : {0, 1})
    for (std::size_t i = 0; i < grid.size(); ++i) heights[mirror].push_back(1e-9 * double((7 * i + mirror) % 11));
  return heights;
}

// The fields at all planes, and the spectrum that comes back as the last.
std::vector<Field> round_trip(CavityWaves const& waves, Field field) {
  std::vector<Field> all;
  waves.round_trip(field, [&](Arrival const& arrival) { all.push_back(arrival.field); });
  all.push_back(std::move(field));
  return all;
}

// eq. W.3 and W.4 element by element with the bits of the rows of the host.
TEST(DeviceTrip, LegsHaveTheBitsOfTheHost) {
  for (int const points : {90, 128, 250}) {
    Grid const grid{points, 0.4};
    wave::Leg const leg(1000, 0.1, 1064e-9, grid);
    Field field(grid);
    std::ranges::fill(field.values, Complex(1, 0));
    leg.apply(field);
    wave::LegTables const tables = leg.tables();
    ASSERT_GT(tables.quartic, points > 200 ? 0 : -1) << "the term of fourth order is not tested";
    std::size_t different = 0, tapered = 0;
    for (int row = 0; row < points; ++row)
      for (int column = 0; column < points; ++column) {
        int const n = wave::device::frequency_number(row, points), m = wave::device::frequency_number(column, points);
        wave::device::Value const factor = wave::device::leg_factor(tables, points, n, m);
        different += Complex(factor.re, factor.im) != field(row, column);
        double const size = std::abs(field(row, column));
        tapered += size > 1e-6 && size < 0.999;
      }
    EXPECT_EQ(different, 0u) << points;
    EXPECT_GT(tapered, 10u) << points;
  }
}

TEST(DeviceTrip, HasTheFieldsOfTheHost) {
  for (int const points : {90, 128, 250}) {
    WaveCavity const cavity = uneven_cavity(points);
    CavityWaves host(cavity), device(cavity, {1, tested_device()}), wrong(cavity, {1, wrong_device()});
    for (bool const rough : {false, true}) {
      if (rough)
        for (CavityWaves* const waves : {&host, &device, &wrong}) waves->set_heights(heights_for(cavity.grid));
      Field const start = host.hermite_gauss(1, 0);
      std::vector<Field> const expected = round_trip(host, start), found = round_trip(device, start);
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_LT(distance_of(found[i], expected[i]), 1e-12) << points << ", stop " << i;
      EXPECT_GT(distance_of(round_trip(wrong, start)[0], expected[0]), 1e-3) << "a wrong sign of W.3 is not noticed";
      Field unseen = start;
      device.round_trip(unseen);
      EXPECT_EQ(distance_of(unseen, found.back()), 0) << "who looks changes the field";
    }
  }
}

TEST(DeviceTrip, HasTheEigenvalueOfTheHost) {
  WaveCavity const cavity = uneven_cavity(128);
  CavityWaves const host(cavity), device(cavity, {1, tested_device()});
  WaveMode const expected = host.mode(host.hermite_gauss()), found = device.mode(device.hermite_gauss());
  EXPECT_LT(std::abs(found.eigenvalue - expected.eigenvalue), 1e-11);
  EXPECT_EQ(found.round_trips, expected.round_trips);
  EXPECT_LT(distance_of(found.spectrum, expected.spectrum), 1e-10);
  // Control: legs with the wrong sign make a cavity of convex mirrors, which holds no such mode.
  CavityWaves const wrong(cavity, {1, wrong_device()});
  try {
    EXPECT_GT(std::abs(wrong.mode(host.hermite_gauss()).eigenvalue - expected.eigenvalue), 1e-3);
  } catch (NumericalError const&) {
  }
}

template <class Error, class Work>
std::string error_of(Work const& work) {
  try {
    work();
  } catch (Error const& e) {
    return e.what();
  }
  return "no error";
}

TEST(DeviceTrip, RefusesWhatDoesNotFitAndTellsWhatFails) {
  auto const device = std::make_shared<HostDevice<1>>();
  WaveCavity const cavity = uneven_cavity(128);
  free_memory = 1000;
  std::string const refused = error_of<InputError>([&] { CavityWaves(cavity, {1, device}); });
  free_memory = std::size_t(-1);
  // 16 N^2 of the field and as many of the transforms, 3 masks of 8 N^2, 2 mirrors of 16 N^2, and the tables of legs.
  EXPECT_THAT(refused,
              HasSubstr("128 points per side needs 0.00 GB of memory of the device, of which 0.00 GB are free"));
  EXPECT_THAT(refused, HasSubstr("--backend cpu"));
  CavityWaves const waves(cavity, {1, device});
  Field field = waves.hermite_gauss();
  failure = "the cable is cut";
  std::string const failed = error_of<NumericalError>([&] { waves.round_trip(field); });
  failure.clear();
  EXPECT_THAT(failed, HasSubstr("wave: the cable is cut; use --backend cpu"));
  // Errors of those who look stay as they are.
  EXPECT_EQ(
      error_of<NumericalError>([&] { waves.round_trip(field, [](Arrival const&) { throw NumericalError("seen"); }); }),
      "seen");
}

// Where nvcc and cuFFT are found, the build has made a library that can be loaded.
TEST(DeviceTrip, CudaIsThereOrSaysWhyNot) {
  EXPECT_THAT(error_of<InputError>([] { wave::cuda_waves(); }),
              AnyOf(HasSubstr("no error"), HasSubstr("no GPU with a driver"), HasSubstr("built without cuFFT")));
}

}  // namespace
}  // namespace straytrace
