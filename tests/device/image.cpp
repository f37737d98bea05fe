// SPDX-License-Identifier: BSD-3-Clause
// A world that is moved to a device takes everything with it.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

#include "base/process/child_process.hpp"
#include "device/blocks.hpp"
#include "trace/backend/device/world_image.hpp"

namespace straytrace::testing::image {
namespace {

// Memory of this process.
class Mapped {
 public:
  Mapped() {
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
      unsigned long long low = 0, high = 0;
      bool const is_range = std::sscanf(line.c_str(), "%llx-%llx", &low, &high) == 2;
      if (is_range) ranges_.push_back({low, high});
    }
  }
  bool holds(std::uint64_t address) const {
    for (auto const& [low, high] : ranges_)
      if (address >= low && address < high) return true;
    return false;
  }

 private:
  std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges_;
};

// Words of an image that are addresses of this process. No number of these scenes looks like one: as a double it would
// be below 1e-300, as two integers one of them would be above twenty thousand. Beside a small integer, bytes that a
// structure leaves unused may hold half of an address, so words that end like one are none.
std::size_t left_behind(std::vector<std::byte> const& image, Mapped const& mapped) {
  std::size_t found = 0;
  for (std::size_t at = 0; at + sizeof(std::uint64_t) <= image.size(); at += sizeof(std::uint64_t)) {
    std::uint64_t word;
    std::memcpy(&word, image.data() + at, sizeof word);
    found += mapped.holds(word) && std::uint32_t(word) > 1'000'000;
  }
  return found;
}

// Puts one address of this process into an image, one of two of which at most one ends like a small integer.
void plant_address(std::vector<std::byte>& image) {
  static std::array<std::byte, 4'000'000> target;
  auto address = reinterpret_cast<std::uint64_t>(target.data());
  if (std::uint32_t(address) <= 1'000'000) address += 2'000'000;
  std::memcpy(image.data(), &address, sizeof address);
}

class Image : public ::testing::TestWithParam<char const*> {};

TEST_P(Image, HoldsNoAddressOfTheWorldItWasMadeOf) {
  if (sanitized) GTEST_SKIP() << "addresses of the sanitizers' heap end like small integers";
  World const world = example(GetParam());
  WorldView const view = world.view();
  WorldImage const image(view);
  Mapped const mapped;
  std::vector<std::byte> placed = image.placed_at(reinterpret_cast<void const*>(std::uintptr_t{1} << 60));
  EXPECT_GT(placed.size(), sizeof view + view.surfaces.size * sizeof(Surface));
  EXPECT_EQ(left_behind(placed, mapped), 0u);
  plant_address(placed);  // control
  EXPECT_EQ(left_behind(placed, mapped), 1u);
}
TEST(ImageOfAnArm, HoldsTheLightBelowTheCrossover) {
  World const world = arm_in_halo();
  WorldView view = world.view();
  WorldImage const with(view);
  std::size_t const cells = view.halo.cells.size * sizeof(HaloCell);
  view.halo.cells = {};
  EXPECT_GE(with.size(), WorldImage(view).size() + cells);
  if (sanitized) return;
  EXPECT_EQ(left_behind(with.placed_at(reinterpret_cast<void const*>(std::uintptr_t{1} << 60)), Mapped()), 0u);
}
INSTANTIATE_TEST_SUITE_P(Device, Image,
                         ::testing::Values("bench", "cad_bench", "virgo_arm", "benches/michelson",
                                           "benches/output_isolator", "benches/rb1_telescope"));

}  // namespace
}  // namespace straytrace::testing::image
