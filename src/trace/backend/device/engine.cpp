// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <dlfcn.h>
#include <filesystem>

#include "base/errors.hpp"
#include "trace/backend/device/device_backend.hpp"

namespace straytrace {

std::unique_ptr<DeviceEngine> load_engine(std::string const& library) {
  // Never unloaded: objects of its classes may outlive whoever loaded it.
  void* const loaded = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!loaded) throw InputError(dlerror(), "build it again, or use --backend cpu");
  auto const make = reinterpret_cast<MakeDeviceEngine>(dlsym(loaded, "straytrace_device_engine"));
  if (!make)
    throw InputError(fmt::format("'{}' is no engine of straytrace", library), "build it again, or use --backend cpu");
  try {
    return std::unique_ptr<DeviceEngine>(make(device_abi));
  } catch (std::exception const& e) {
    throw InputError(e.what(), "use --backend cpu: it gives the same result");
  }
}

namespace {

std::string cuda_library() {
  std::string const name = "libstraytrace_cuda.so";
  std::error_code ignored;
  std::filesystem::path const program = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  for (auto const& place : {program / name, program / ".." / "lib" / "straytrace" / name})
    if (std::filesystem::exists(place, ignored)) return place.lexically_normal().string();
  return {};
}

}  // namespace

bool has_cuda_engine() { return !cuda_library().empty(); }

std::unique_ptr<DeviceEngine> cuda_engine() {
  std::string const library = cuda_library();
  if (library.empty())
    throw InputError(
        "this straytrace was built without CUDA",
        "build it where nvcc is found (docs/guide/gpu.md), or use --backend cpu: it gives the same result");
  return load_engine(library);
}

}  // namespace straytrace
