// SPDX-License-Identifier: BSD-3-Clause
// The address of a live page: printed on stderr, and opened in the browser.
#pragma once

#include <string>

#include "base/namespaces.hpp"

namespace straytrace::session {

// Prints the address, also with --quiet. `open`: gives it to the browser of the system by a file that only this user
// can read, since arguments of programs are public; the file goes with the object.
class LiveAddress {
 public:
  LiveAddress(std::string const& address, bool open);
  ~LiveAddress();
  LiveAddress(LiveAddress const&) = delete;
  LiveAddress& operator=(LiveAddress const&) = delete;

 private:
  std::string file_;  // empty: none
};

}  // namespace straytrace::session
