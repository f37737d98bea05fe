// SPDX-License-Identifier: BSD-3-Clause
// Sorts records and splits them where their common key changes. The library sorts on the host when it is
// compiled for it: the same source is tested there (tests/device).
#pragma once

#if !defined(__NVCC__)
#define THRUST_DEVICE_SYSTEM THRUST_DEVICE_SYSTEM_CPP  // the "device" of the library is the host
#endif

#include <thrust/copy.h>
#include <thrust/device_vector.h>
#include <thrust/execution_policy.h>
#include <thrust/for_each.h>
#include <thrust/iterator/counting_iterator.h>
#include <thrust/scan.h>
#include <thrust/sort.h>

#include <cstdint>

#include "base/math/functions.hpp"

namespace straytrace::trace::device {

template <class T>
using Array = thrust::device_vector<T>;
template <class T>
T const* data_of(Array<T> const& a) {
  return thrust::raw_pointer_cast(a.data());
}
template <class T>
T* data_of(Array<T>& a) {
  return thrust::raw_pointer_cast(a.data());
}

template <class F>
void for_each_number(std::size_t count, F const& f) {
  auto const zero = thrust::make_counting_iterator(std::uint32_t{0});
  thrust::for_each(thrust::device, zero, zero + std::uint32_t(count), f);
}

// Records on the device, of which some may be unused.
template <class T>
struct Records {
  T const* data = nullptr;
  std::size_t size = 0;
};
template <class T>
Records<T> records_of(Array<T> const& a) {
  return {data_of(a), a.size()};
}

// Keys define an order without ties, so the initial order of the records does not matter.
struct SortKey {
  static constexpr int most_words = 5;
  std::uint64_t word[most_words] = {};
  STRAY_HD bool shares(int count, SortKey const& other) const {
    for (int i = 0; i < count; ++i)
      if (word[i] != other.word[i]) return false;
    return true;
  }
};
constexpr std::uint64_t nothing = ~std::uint64_t{0};  // first word of unused records
STRAY_HD std::uint64_t pair_of(std::uint32_t high, std::uint32_t low) { return std::uint64_t(high) << 32 | low; }
// A word that falls while the number, not negative, rises.
STRAY_HD std::uint64_t falling(double x) { return ~bits_of(x); }

template <class KeyOf>
struct IsUsed {
  KeyOf key_of;
  STRAY_HD bool operator()(std::uint32_t i) const { return key_of(i).word[0] != nothing; }
};
template <class KeyOf>
struct WriteWord {
  KeyOf key_of;
  std::uint32_t const* order;
  std::uint64_t* words;
  int word;
  STRAY_HD void operator()(std::uint32_t i) const { words[i] = key_of(order[i]).word[word]; }
};
// Numbers of the records that are used, in the order of their keys. key_of(i) gives the `KeyOf::words` words of record
// number i. Word by word, from the last: the library sorts single words by their digits, many times faster than it
// compares keys.
template <class KeyOf>
Array<std::uint32_t> ordered(std::size_t count, KeyOf const& key_of) {
  auto const zero = thrust::make_counting_iterator(std::uint32_t{0});
  Array<std::uint32_t> order(count);
  auto const end =
      thrust::copy_if(thrust::device, zero, zero + std::uint32_t(count), order.begin(), IsUsed<KeyOf>{key_of});
  order.resize(std::size_t(end - order.begin()));
  Array<std::uint64_t> words(order.size());
  for (int word = KeyOf::words; word-- > 0;) {
    for_each_number(order.size(), WriteWord<KeyOf>{key_of, data_of(order), data_of(words), word});
    thrust::stable_sort_by_key(thrust::device, words.begin(), words.end(), order.begin());
  }
  return order;
}

template <class KeyOf>
struct Begins {
  KeyOf key_of;
  std::uint32_t const* order;
  int words;
  STRAY_HD bool operator()(std::uint32_t i) const {
    return i == 0 || !key_of(order[i]).shares(words, key_of(order[i - 1]));
  }
};
// Where runs of records with the same first words begin, and the end of the last.
template <class KeyOf>
Array<std::uint32_t> runs(Array<std::uint32_t> const& order, KeyOf const& key_of, int words) {
  auto const zero = thrust::make_counting_iterator(std::uint32_t{0});
  auto const n = std::uint32_t(order.size());
  Array<std::uint32_t> starts(std::size_t(n) + 1);
  auto const end =
      thrust::copy_if(thrust::device, zero, zero + n, starts.begin(), Begins<KeyOf>{key_of, data_of(order), words});
  *end = n;
  starts.resize(std::size_t(end - starts.begin()) + 1);
  return starts;
}
inline std::size_t run_count(Array<std::uint32_t> const& starts) { return starts.size() - 1; }

struct Run {
  std::uint32_t const* order;
  std::uint32_t const* starts;
  STRAY_HD std::uint32_t begin(std::uint32_t run) const { return starts[run]; }
  STRAY_HD std::uint32_t end(std::uint32_t run) const { return starts[run + 1]; }
  STRAY_HD std::uint32_t record(std::uint32_t i) const { return order[i]; }
};
inline Run run_of(Array<std::uint32_t> const& order, Array<std::uint32_t> const& starts) {
  return {data_of(order), data_of(starts)};
}

template <class Record>
struct RecordRun : Run {
  Record const* records;
  STRAY_HD Record const& operator[](std::uint32_t i) const { return records[record(i)]; }
};
template <class Record>
RecordRun<Record> run_of(Records<Record> const& records, Array<std::uint32_t> const& order,
                         Array<std::uint32_t> const& starts) {
  return {run_of(order, starts), records.data};
}

// Members `first` of rows from their counts; returns the sum of all counts.
template <class Row>
struct CopyCount {
  Row const* rows;
  std::uint32_t Row::*count;
  std::uint32_t* counts;
  STRAY_HD void operator()(std::uint32_t i) const { counts[i + 1] = rows[i].*count; }
};
template <class Row>
struct SetFirst {
  Row* rows;
  std::uint32_t Row::*first;
  std::uint32_t const* sums;
  STRAY_HD void operator()(std::uint32_t i) const { rows[i].*first = sums[i]; }
};
template <class Row>
std::uint32_t lay_out(Array<Row>& rows, std::uint32_t Row::*first, std::uint32_t Row::*count) {
  Array<std::uint32_t> sums(rows.size() + 1, 0);
  for_each_number(rows.size(), CopyCount<Row>{data_of(rows), count, data_of(sums)});
  thrust::inclusive_scan(thrust::device, sums.begin(), sums.end(), sums.begin());
  for_each_number(rows.size(), SetFirst<Row>{data_of(rows), first, data_of(sums)});
  return sums.back();
}

}  // namespace straytrace::trace::device
