// SPDX-License-Identifier: BSD-3-Clause
// A mesh file read in a copy of the process; what it holds comes back as bytes.
#include <fmt/format.h>

#include <cstring>
#include <type_traits>

#include "base/apart.hpp"
#include "world/mesh_file.hpp"

namespace straytrace {
namespace {

// The library takes about 20 bytes for each of a file, our parts as much again.
std::size_t memory_for(std::size_t bytes) { return (std::size_t{1} << 30) + 100 * bytes; }

class Packer {
 public:
  template <class T>
  void add(std::vector<T> const& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    count(values.size());
    bytes_.append(reinterpret_cast<char const*>(values.data()), values.size() * sizeof(T));
  }
  void add(std::string const& text) { count(text.size()), bytes_ += text; }
  void count(std::uint64_t n) { bytes_.append(reinterpret_cast<char const*>(&n), sizeof n); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::string const& bytes) : bytes_(bytes) {}
  std::uint64_t count() {
    std::uint64_t n = 0;
    copy(&n, sizeof n);
    return n;
  }
  std::string text() {
    std::string all(count(), '\0');
    copy(all.data(), all.size());
    return all;
  }
  template <class T>
  std::vector<T> values() {
    std::vector<T> all(count());
    copy(all.data(), all.size() * sizeof(T));
    return all;
  }

 private:
  void copy(void* to, std::size_t size) {
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  std::string const& bytes_;
  std::size_t at_ = 0;
};

std::string packed(MeshFault const& fault, MeshFile const& file, std::vector<std::string> const& asked) {
  Packer out;
  out.add(fault.what);
  out.add(fault.suggestion);
  out.count(asked.size());
  for (std::string const& name : asked) out.add(name);
  out.add(std::vector<double>{file.stated_unit});
  out.count(file.left_out);
  out.count(file.parts.size());
  for (MeshPart const& p : file.parts) {
    for (std::string const* text : {&p.name, &p.material, &p.colour}) out.add(*text);
    out.add(p.vertices);
    out.add(p.triangles);
  }
  return out.take();
}

}  // namespace

MeshFault read_mesh_file(std::string const& bytes, CompanionFile const& companion, MeshFile& out) {
  auto const work = [&] {
    std::vector<std::string> asked;
    CompanionFile const noted = [&](std::string const& name) { return asked.push_back(name), companion(name); };
    MeshFile file;
    file.name = out.name;
    MeshFault const fault = import_mesh(bytes, companion ? noted : companion, file);
    return packed(fault, file, asked);
  };
  Apart const done = done_apart(work, memory_for(bytes.size()));
  if (!done.why.empty())
    return {fmt::format("not a readable mesh file: {}", done.why), "check that the file is complete; export it again"};
  Unpacker in(done.bytes);
  MeshFault fault;
  fault.what = in.text();
  fault.suggestion = in.text();
  for (std::uint64_t n = in.count(); n > 0; --n) (void)companion(in.text());  // what it asked for is noted here too
  out.stated_unit = in.values<double>().at(0);
  out.left_out = in.count();
  out.parts.resize(in.count());
  for (MeshPart& p : out.parts) {
    p.name = in.text(), p.material = in.text(), p.colour = in.text();
    p.vertices = in.values<MeshVertex>();
    p.triangles = in.values<MeshTriangle>();
  }
  return fault;
}

}  // namespace straytrace
