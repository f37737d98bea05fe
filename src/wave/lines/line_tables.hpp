// SPDX-License-Identifier: BSD-3-Clause
// Tables of the one-dimensional transform of N points, and the memory of the threads that run it.
#pragma once

#include <memory>
#include <mutex>
#include <new>
#include <vector>

#include "wave/lines/line_kernels.hpp"

namespace straytrace::wave {

class LineTables {
 public:
  explicit LineTables(int points);  // InputError if it has a prime factor above 5
  LineTables(LineTables const&) = delete;
  LineTables& operator=(LineTables const&) = delete;

  LinePlan const& plan() const { return plan_; }
  // Calls use(work) with memory that no other thread has.
  template <class Use>
  void with_work(Use const& use) const {
    Work work = take();
    use(work.get());
    std::lock_guard const lock(mutex_);
    idle_.push_back(std::move(work));
  }

 private:
  struct Free {
    void operator()(double* p) const { ::operator delete[](p, std::align_val_t{64}); }
  };
  using Work = std::unique_ptr<double[], Free>;
  Work take() const;

  LinePlan plan_{};
  std::vector<std::vector<double>> twiddles_;
  std::vector<int> position_;
  mutable std::mutex mutex_;
  mutable std::vector<Work> idle_;
};

}  // namespace straytrace::wave
