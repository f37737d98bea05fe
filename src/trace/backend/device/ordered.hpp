// SPDX-License-Identifier: BSD-3-Clause
// Records put in order, and cut where their key changes. The library sorts on the host when it is compiled for it: the
// same source is tested there (tests/device).
#pragma once

#include <thrust/copy.h>
#include <thrust/device_vector.h>
#include <thrust/execution_policy.h>
#include <thrust/for_each.h>
#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>
#include <thrust/remove.h>
#include <thrust/scan.h>
#include <thrust/sequence.h>
#include <thrust/sort.h>
#include <thrust/transform.h>

#include <cstdint>

#include "base/host_device.hpp"

namespace straytrace::device {

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
void for_each_number(std::uint32_t count, F const& f) {
  auto const zero = thrust::make_counting_iterator(std::uint32_t{0});
  thrust::for_each(thrust::device, zero, zero + count, f);
}

template <class Record, class Before>
struct ByRecord {
  Record const* records;
  Before before;
  STRAY_HD bool operator()(std::uint32_t a, std::uint32_t b) const { return before(records[a], records[b]); }
};
// Numbers of the records in an order without ties, so that it does not matter how they came to stand where they do.
template <class Record, class Before>
Array<std::uint32_t> ordered(Array<Record> const& records, Before const& before) {
  Array<std::uint32_t> order(records.size());
  thrust::sequence(thrust::device, order.begin(), order.end());
  thrust::sort(thrust::device, order.begin(), order.end(), ByRecord<Record, Before>{data_of(records), before});
  return order;
}

template <class Record, class Same>
struct Begins {
  Record const* records;
  std::uint32_t const* order;
  Same same;
  STRAY_HD bool operator()(std::uint32_t i) const {
    return i == 0 || !same(records[order[i - 1]], records[order[i]]);
  }
};
// Where runs of the same key begin in an order, and its end.
template <class Record, class Same>
Array<std::uint32_t> runs(Array<Record> const& records, Array<std::uint32_t> const& order, Same const& same) {
  auto const zero = thrust::make_counting_iterator(std::uint32_t{0});
  auto const n = std::uint32_t(order.size());
  Array<std::uint32_t> starts(std::size_t(n) + 1);
  auto const end = thrust::copy_if(thrust::device, zero, zero + n, starts.begin(),
                                   Begins<Record, Same>{data_of(records), data_of(order), same});
  *end = n;
  starts.resize(std::size_t(end - starts.begin()) + 1);
  return starts;
}
template <class Record>
struct Run {  // of records in their order
  Record const* records;
  std::uint32_t const *order, *starts;
  STRAY_HD std::uint32_t begin(std::uint32_t run) const { return starts[run]; }
  STRAY_HD std::uint32_t end(std::uint32_t run) const { return starts[run + 1]; }
  STRAY_HD Record const& operator[](std::uint32_t i) const { return records[order[i]]; }
};
template <class Record>
Run<Record> run_of(Array<Record> const& records, Array<std::uint32_t> const& order,
                   Array<std::uint32_t> const& starts) {
  return {data_of(records), data_of(order), data_of(starts)};
}
inline std::uint32_t run_count(Array<std::uint32_t> const& starts) { return std::uint32_t(starts.size() - 1); }

// Members `first` of rows from their counts; returns the sum of all counts.
template <class Row>
struct CountOf {
  Row const* rows;
  std::uint32_t Row::*count;
  STRAY_HD std::uint32_t operator()(std::uint32_t i) const { return rows[i].*count; }
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
  auto const n = std::uint32_t(rows.size());
  if (n == 0) return 0;
  auto const zero = thrust::make_counting_iterator(std::uint32_t{0});
  Array<std::uint32_t> sums(n + std::size_t{1});
  auto const counts = thrust::make_transform_iterator(zero, CountOf<Row>{data_of(rows), count});
  thrust::inclusive_scan(thrust::device, counts, counts + n, sums.begin() + 1);
  for_each_number(n, SetFirst<Row>{data_of(rows), first, data_of(sums)});
  return sums[n];
}

}  // namespace straytrace::device
