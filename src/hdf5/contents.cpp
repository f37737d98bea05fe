// SPDX-License-Identifier: BSD-3-Clause
#include "hdf5/contents.hpp"

#include <fmt/format.h>

#include "base/apart.hpp"
#include "base/message.hpp"
#include "base/pack.hpp"
#include "hdf5/walk.hpp"

namespace straytrace::hdf5 {
namespace {

constexpr std::size_t gigabyte = std::size_t{1} << 30;

// In a copy of the process, which ends what it returns with how it went.
template <class Work>
std::string apart(Work const& work, std::size_t memory, std::size_t image_size) {
  auto const told = [&] {
    try {
      return work() + '\0';
    } catch (InputError const& e) {
      return std::string(e.what()) + '\1';
    }
  };
  Apart done = done_apart(told, {memory, 10 + image_size / 500000});
  if (!done.why.empty()) throw InputError("the HDF5 library cannot read the file: " + done.why);
  if (done.bytes.empty()) broken_file("nothing could be read");
  char const how = done.bytes.back();
  done.bytes.pop_back();
  if (how != '\0') throw InputError(done.bytes);
  return std::move(done.bytes);
}

}  // namespace

std::uint64_t Values::count() const {
  std::uint64_t all = 1;
  for (std::uint64_t n : shape)
    if (__builtin_mul_overflow(all, n, &all)) return ~std::uint64_t{0};
  return all;
}

Contents contents_of(std::string const& image, Wanted const& wanted) {
  auto const work = [&] { return packed(walked(image, wanted)); };
  return unpacked(apart(work, 2 * gigabyte + 100 * image.size(), image.size()));
}

Contents own_contents(std::string const& image) { return walked(image, {}); }

std::vector<double> slab(std::string const& image, std::string const& path, std::uint64_t offset, std::uint64_t count) {
  auto const work = [&] {
    Packer out;
    out.add(slab_here(image, path, offset, count));
    return out.take();
  };
  std::size_t const size = image.size() + count * sizeof(double);
  return Unpacker(apart(work, gigabyte + 6 * size, size)).values<double>();
}

}  // namespace straytrace::hdf5
