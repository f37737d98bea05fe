// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/sha256.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>

#include "base/errors.hpp"

namespace straytrace {
namespace {

void check(int ok) {
  if (ok != 1) throw NumericalError("sha256 is not available in this OpenSSL");
}

EVP_MD_CTX* digest(std::shared_ptr<void> const& context) { return static_cast<EVP_MD_CTX*>(context.get()); }

}  // namespace

Sha256::Sha256() : context_(EVP_MD_CTX_new(), [](void* c) { EVP_MD_CTX_free(static_cast<EVP_MD_CTX*>(c)); }) {
  check(EVP_DigestInit_ex(digest(context_), EVP_sha256(), nullptr));
}

void Sha256::add(std::string_view bytes) { check(EVP_DigestUpdate(digest(context_), bytes.data(), bytes.size())); }

void Sha256::add_counted(std::string_view bytes) {
  add(fmt::format("{}:", bytes.size()));
  add(bytes);
}

std::string Sha256::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes = {};
  unsigned length = 0;
  check(EVP_DigestFinal_ex(digest(context_), bytes.data(), &length));
  std::string text;
  for (unsigned i = 0; i < length; ++i) text += fmt::format("{:02x}", bytes[i]);
  return text;
}

std::string sha256(std::string_view bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.hex();
}

}  // namespace straytrace
