// SPDX-License-Identifier: BSD-3-Clause
// A backend whose histories run on a device. Blocks requested by several host threads at the same time run
// together, so it needs many callers.
#pragma once

#include "trace/backend/backend.hpp"
#include "trace/backend/device/engine.hpp"

namespace straytrace::trace {

// The engine in a shared library. Throws InputError when the library cannot be loaded or finds no device.
std::unique_ptr<DeviceEngine> load_engine(std::string const& library);
// The CUDA engine, from the folder of the program or from ../lib/straytrace. Throws InputError when it was not built or
// finds no device.
std::unique_ptr<DeviceEngine> cuda_engine();
bool has_cuda_engine();  // whether it was built

struct DeviceSettings {
  std::uint32_t room = 0;                                 // see BatchOrder
  std::function<void(BatchCounts const&)> after_batch{};  // called by one thread at a time
};
std::unique_ptr<Backend> device_backend(std::string name, std::unique_ptr<DeviceEngine>, DeviceSettings = {});

// Sums of block number `position` of a batch, equal to those of the host.
class BatchBlocks {
 public:
  BatchBlocks(World const&, BatchSums);
  BlockSums block(std::uint32_t position, std::uint64_t number) const;

 private:
  template <class Row>
  struct Range {
    Row const *first, *last;
    Row const* begin() const { return first; }
    Row const* end() const { return last; }
  };
  template <class Row>
  static Range<Row> of_block(std::vector<Row> const& rows, std::uint32_t position);
  void put_totals(std::uint32_t position, int replica, BlockSums&) const;
  void put_maps(std::uint32_t position, BlockSums&) const;

  World const& world_;
  BatchSums sums_;
};

}  // namespace straytrace::trace
