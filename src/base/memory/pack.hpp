// SPDX-License-Identifier: BSD-3-Clause
// Values as bytes, between two copies of this program.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/errors.hpp"

namespace straytrace {

class Packer {
 public:
  template <class T>
  void value(T const& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<char const*>(&v), sizeof v);
  }
  void count(std::uint64_t n) { value(n); }
  void add(std::string_view text) { count(text.size()), bytes_ += text; }
  template <class T>
  void add(std::vector<T> const& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    count(values.size());
    bytes_.append(reinterpret_cast<char const*>(values.data()), values.size() * sizeof(T));
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Takes what Packer added, in its order. Throws InputError where the bytes end before: a library that a file has
// broken may have written them. `bytes` must outlive it.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : left_(bytes) {}

  template <class T>
  T value() {
    T v;
    copy(&v, sizeof v);
    return v;
  }
  std::uint64_t count() { return value<std::uint64_t>(); }
  std::string text() { return std::string(next(count(), 1)); }
  template <class T>
  std::vector<T> values() {
    std::string_view const bytes = next(count(), sizeof(T));
    std::vector<T> all(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(all.data(), bytes.data(), bytes.size());
    return all;
  }

 private:
  std::string_view next(std::uint64_t many, std::size_t size) {
    if (many > left_.size() / size) throw InputError("what a library has read is cut short");
    std::string_view const bytes = left_.substr(0, many * size);
    left_.remove_prefix(bytes.size());
    return bytes;
  }
  void copy(void* to, std::size_t size) { std::memcpy(to, next(size, 1).data(), size); }
  std::string_view left_;
};

}  // namespace straytrace
