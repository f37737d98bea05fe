// SPDX-License-Identifier: BSD-3-Clause
// SHA-256 of contents, to recognise them.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "base/namespaces.hpp"

namespace straytrace {

class Sha256 {
 public:
  Sha256();
  void add(std::string_view bytes);
  // With the length in front, so that two different lists of texts never give the same bytes.
  void add_counted(std::string_view bytes);
  std::string hex();  // 64 hexadecimal digits; call once, last

 private:
  std::shared_ptr<void> context_;
};

std::string sha256(std::string_view bytes);

}  // namespace straytrace
