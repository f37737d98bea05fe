// SPDX-License-Identifier: BSD-3-Clause
#include "scene/unsaved.hpp"

#include <map>

namespace straytrace {
namespace {

std::map<std::filesystem::path, std::string> texts;

std::filesystem::path key(std::filesystem::path const& file) {
  return std::filesystem::absolute(file).lexically_normal();
}

}  // namespace

void set_unsaved(std::filesystem::path const& file, std::string text) { texts[key(file)] = std::move(text); }

std::optional<std::string> unsaved_text(std::filesystem::path const& file) {
  if (texts.empty()) return {};
  auto const hit = texts.find(key(file));
  return hit == texts.end() ? std::nullopt : std::optional(hit->second);
}

}  // namespace straytrace
