// SPDX-License-Identifier: BSD-3-Clause
#include "session/backend.hpp"

#include <fmt/format.h>

#include <dlfcn.h>
#include <filesystem>
#include <optional>

#include "base/errors.hpp"
#include "mpi/transport.h"
#include "trace/backend/device/device_backend.hpp"

namespace straytrace::session {
namespace {

class Mpi final : public Transport {
 public:
  explicit Mpi(straytrace_transport const& mpi) : mpi_(mpi) {}

  int rank() const override { return mpi_.rank; }
  int size() const override { return mpi_.size; }
  void send(int to, std::string const& bytes) override { mpi_.send(to, bytes.data(), bytes.size()); }
  std::optional<Message> receive() override {
    Message message;
    long const size = mpi_.next(&message.from);
    if (size < 0) return {};
    message.bytes.resize(std::size_t(size));
    mpi_.receive(message.from, message.bytes.data(), message.bytes.size());
    return message;
  }
  void lost(int rank) override {
    lost_ = true;
    fmt::print(stderr, "warning: rank {} does not answer, or has failed; others do its work\n", rank);
  }
  void close(int exit_code) { mpi_.close(lost_, exit_code); }

 private:
  straytrace_transport mpi_;
  bool lost_ = false;
};

std::optional<Mpi> job;

[[noreturn]] void refuse_transport(std::string const& why) {
  throw InputError(fmt::format("--backend mpi: {}", why),
                   "build straytrace with MPI installed (scripts/setup --test installs libopenmpi-dev), or divide the "
                   "run: --slice 1/16, and straytrace merge");
}

}  // namespace

// The library stays loaded: MPI cannot be started twice. Its own plug-ins look for its symbols (RTLD_GLOBAL).
Transport& open_mpi() {
  std::error_code none;
  std::filesystem::path const program = std::filesystem::read_symlink("/proc/self/exe", none);
  std::string const file = (program.parent_path() / "straytrace-mpi.so").string();
  if (!std::filesystem::exists(file, none)) refuse_transport(fmt::format("there is no '{}'", file));
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (!library) refuse_transport(dlerror());
  auto const open = reinterpret_cast<decltype(&straytrace_transport_open)>(dlsym(library, "straytrace_transport_open"));
  straytrace_transport mpi = {};
  if (!open || open(straytrace_transport_version, &mpi) != straytrace_transport_version)
    refuse_transport(fmt::format("'{}' is from another version of straytrace", file));
  return job.emplace(mpi);
}

void close_mpi(int exit_code) {
  if (job) job->close(exit_code);
}

DirectSum phase_summer(std::string const& backend) {
  if (backend == "cpu") return {};
  if (backend != "cuda") throw InputError(fmt::format("'{}' cannot sum phases", backend), "write cpu or cuda");
  std::shared_ptr<DeviceEngine> const engine = cuda_engine();
  return [engine](PhaseTerms const& terms) {
    std::size_t const samples = terms.coordinate.empty() ? 0 : terms.coordinate.front().size();
    std::vector<double> position;
    for (auto const& one : terms.coordinate) position.insert(position.end(), one.begin(), one.end());
    return engine->phase_sum(
        {terms.amplitude, terms.turns, terms.phase_sensitivity, position, terms.coordinate.size(), samples});
  };
}

std::string devices_text() {
  if (!has_cuda_engine()) return "cuda: not built";
  try {
    DeviceFacts const facts = cuda_engine()->facts();
    return fmt::format("cuda: {}, {:.0f} GB", facts.name, double(facts.memory) / 1e9);
  } catch (InputError const&) {
    return "cuda: built; no device here";
  }
}

}  // namespace straytrace::session
