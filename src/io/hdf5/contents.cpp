// SPDX-License-Identifier: BSD-3-Clause
#include "io/hdf5/contents.hpp"

#include "base/errors.hpp"
#include "base/process/child_process.hpp"
#include "io/hdf5/load_contents.hpp"

namespace straytrace::io::hdf5 {
namespace {

constexpr std::size_t gigabyte = std::size_t{1} << 30;

// In a copy of the process, whose last byte is the outcome.
template <class Work>
std::string apart(Work const& work, std::size_t memory, std::size_t image_size) {
  auto const told = [&] {
    try {
      return work() + '\0';
    } catch (InputError const& e) {
      return e.reason() + '\1';
    }
  };
  SandboxResult done = run_sandboxed(told, {memory, 10 + image_size / 500000});
  if (!done.why.empty()) throw InputError("the HDF5 library cannot read the file: " + done.why, copy_again);
  if (done.bytes.empty()) broken_file("nothing could be read");
  char const how = done.bytes.back();
  done.bytes.pop_back();
  if (how != '\0') throw InputError(done.bytes, copy_again);
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
  auto const work = [&] { return packed(load_contents(image, wanted)); };
  return unpacked(apart(work, 2 * gigabyte + 100 * image.size(), image.size()));
}

Contents own_contents(std::string const& image, Wanted const& wanted) { return load_contents(image, wanted); }

std::vector<double> slab(std::string const& image, std::string const& path, std::uint64_t offset, std::uint64_t count) {
  auto const work = [&] {
    Packer out;
    out.add(slab_here(image, path, offset, count));
    return out.take();
  };
  std::size_t const size = image.size() + count * sizeof(double);
  return Unpacker(apart(work, gigabyte + 6 * size, size)).values<double>();
}

}  // namespace straytrace::io::hdf5

namespace straytrace::io::hdf5 {
namespace {

void add(Packer& out, Values const& v) {
  out.value(v.kind), out.value(v.state), out.value(std::uint8_t{v.is_signed});
  out.value(v.size), out.add(v.shape), out.add(v.bytes);
}

std::uint8_t below(Unpacker& in, unsigned limit) {
  auto const code = in.value<std::uint8_t>();
  if (code >= limit) throw InputError("what HDF5 has read has no meaning", copy_again);
  return code;
}

bool is_sound(Values const& v) {
  if (v.state != State::whole) return v.bytes.empty();
  bool size = true;
  if (v.kind == Kind::text) size = v.size > 0;
  if (v.kind == Kind::real) size = v.size == 4 || v.size == 8;
  if (v.kind == Kind::integer) size = v.size == 1 || v.size == 2 || v.size == 4 || v.size == 8;
  std::uint64_t bytes = 0;
  return size && !__builtin_mul_overflow(v.count(), v.size, &bytes) && v.bytes.size() == bytes;
}

Values values_of(Unpacker& in) {
  Values v;
  v.kind = Kind(below(in, 4)), v.state = State(below(in, 5)), v.is_signed = below(in, 2) != 0;
  v.size = in.count(), v.shape = in.values<std::uint64_t>(), v.bytes = in.text();
  if (!is_sound(v)) throw InputError("what HDF5 has read has no meaning", copy_again);
  return v;
}

}  // namespace

std::string packed(Contents const& contents) {
  Packer out;
  out.count(contents.size());
  for (auto const& [path, object] : contents) {
    out.add(path), out.value(std::uint8_t{object.is_group});
    add(out, object.values);
    out.count(object.attributes.size());
    for (auto const& [name, values] : object.attributes) out.add(name), add(out, values);
  }
  return out.take();
}

Contents unpacked(std::string_view bytes) {
  Unpacker in(bytes);
  Contents contents;
  for (std::uint64_t n = in.count(); n > 0; --n) {
    Object& object = contents[in.text()];
    object.is_group = below(in, 2) != 0;
    object.values = values_of(in);
    for (std::uint64_t k = in.count(); k > 0; --k) {
      std::string const name = in.text();
      object.attributes[name] = values_of(in);
    }
  }
  return contents;
}

}  // namespace straytrace::io::hdf5
