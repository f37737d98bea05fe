// SPDX-License-Identifier: BSD-3-Clause
#include "session/live/live_address.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string_view>
#include <thread>
#include <unistd.h>
#include <vector>

#include "base/process/child_process.hpp"

namespace straytrace::session {
namespace {

// A new file of this user alone; empty: none could be made.
std::string private_file(std::string const& text) {
  std::error_code none;
  std::string name = (std::filesystem::temp_directory_path(none) / "straytrace-XXXXXX.html").string();
  int const descriptor = ::mkstemps(name.data(), int(std::strlen(".html")));
  if (descriptor < 0) return "";
  bool const written = ::write(descriptor, text.data(), text.size()) == ssize_t(text.size());
  ::close(descriptor);
  return written ? name : "";
}

std::vector<std::string> variables_of_this() {
  std::vector<std::string> all;
  for (char** variable = environ; *variable; ++variable) all.emplace_back(*variable);
  return all;
}

}  // namespace

LiveAddress::LiveAddress(std::string const& address, bool open) {
  std::cerr << fmt::format("live page: {}\nThis address is a key: keep it to yourself. Ctrl-C here ends it.\n",
                           address);
  if (!open) return;
  file_ = private_file(fmt::format(
      "<!doctype html><meta http-equiv=\"refresh\" content=\"0; url={}\"><title>straytrace</title>\n", address));
  // Some systems wait here until the browser is closed.
  std::thread([file = file_] {
    FinishedChild const child = run_child({"xdg-open", file}, variables_of_this());
    if (child.start_error != 0 || child.status != 0)
      std::cerr << fmt::format("warning: no browser was opened: {}; open the address yourself\n",
                               child.start_error != 0 ? std::strerror(child.start_error) : "xdg-open failed");
  }).detach();
}

LiveAddress::~LiveAddress() {
  if (!file_.empty()) ::unlink(file_.c_str());
}

}  // namespace straytrace::session
