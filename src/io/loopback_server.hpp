// SPDX-License-Identifier: BSD-3-Clause
// Pages for a browser on this machine, of a program that runs.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "base/namespaces.hpp"

namespace straytrace::io {

struct HttpRequest {
  bool post = false;       // otherwise GET
  std::string path, body;  // path: below the token, "state.json"
};
struct HttpReply {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8", body;
};

// Listens on 127.0.0.1 alone. A request counts only with the random token of the address, with the `Host` of the
// address (against DNS rebinding) and, to change something, without another `Origin`; all others get 403. Requests and
// connections are limited in size, number and time, and no other origin may read a reply.
class LoopbackServer {
 public:
  using Handler = std::function<HttpReply(HttpRequest const&)>;  // called by the thread of the server

  // `port` 0: a free one. Throws InputError, with the `remedy`, when it cannot be had.
  LoopbackServer(std::uint16_t port, Handler, std::string const& remedy);
  ~LoopbackServer();
  LoopbackServer(LoopbackServer const&) = delete;
  LoopbackServer& operator=(LoopbackServer const&) = delete;

  std::string address(std::string const& path) const;  // "http://127.0.0.1:4711/TOKEN/path"

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
};

}  // namespace straytrace::io
