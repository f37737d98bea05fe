// SPDX-License-Identifier: BSD-3-Clause
// The picture of a scene that follows its files (straytrace view --live).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "base/errors.hpp"
#include "io/loopback_server.hpp"
#include "scene/scene.hpp"
#include "session/interrupt.hpp"

namespace straytrace::session {

// Serves the last good picture, and above it what is wrong with the scene since.
class LiveView {
 public:
  LiveView(std::string title, std::uint16_t port);  // 0: a free one
  std::string address() const { return server_->address("live"); }

  void show(std::string picture, std::string const& warnings);  // a page of view_page()
  void show_problems(std::string const& text);

 private:
  HttpReply answer(HttpRequest const&) const;

  std::string const page_;
  mutable std::mutex mutex_;  // of all below
  std::string picture_, problems_, warnings_;
  std::size_t pictures_ = 0, changes_ = 0;
  std::unique_ptr<LoopbackServer> server_;  // last: it answers from all the above
};

// The files of a scene on disk.
class SceneFiles {
 public:
  explicit SceneFiles(std::string main_file);

  void follow(FileTexts const&);                 // all that the scene consists of
  void follow(std::vector<std::string> const&);  // more, by name
  // Waits until one of them has changed and nothing changes any more; false: a signal came.
  bool wait_for_change(InterruptGuard const&);

 private:
  using Stamp = std::pair<std::filesystem::file_time_type, std::uintmax_t>;
  void add(std::string const& name);
  std::map<std::filesystem::path, Stamp> stamps() const;

  std::filesystem::path main_;
  std::map<std::filesystem::path, Stamp> seen_;
};

}  // namespace straytrace::session
