// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "app/explain.hpp"
#include "base/embedded.hpp"

namespace straytrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr double alike = 0.6;  // share of the words of the message that stand in what was asked
constexpr std::size_t most = 3, fewest_words = 3;
constexpr double near_best = 0.15;

// Words of letters, in lower case; names and numbers of the user count for nothing.
std::set<std::string> words_of(std::string const& text) {
  std::set<std::string> words;
  std::string word;
  bool quoted = false;
  for (char const c : text + " ") {
    if (c == '"') quoted = !quoted;
    if (!quoted && std::isalpha(static_cast<unsigned char>(c))) {
      word += char(std::tolower(static_cast<unsigned char>(c)));
      continue;
    }
    if (word.size() > 1) words.insert(word);
    word.clear();
  }
  return words;
}

// How well the words of a message cover what was asked, and the other way round.
double likeness(std::set<std::string> const& message, std::set<std::string> const& asked) {
  if (message.size() < fewest_words || asked.empty()) return 0;
  auto const common = double(std::count_if(message.begin(), message.end(), [&](auto& w) { return asked.contains(w); }));
  return 0.5 * common / double(message.size()) + 0.5 * common / double(asked.size());
}

}  // namespace

std::optional<Explanation> explain_message(std::string const& text) {
  std::set<std::string> const asked = words_of(text);
  if (asked.size() < 2) return {};
  Json const all = Json::parse(embedded_file("schema/messages.json"));
  std::vector<std::pair<double, Json const*>> found;
  for (Json const& m : all)
    if (double const like = likeness(words_of(m.at("what")), asked); like >= alike) found.emplace_back(like, &m);
  if (found.empty()) return {};
  std::stable_sort(found.begin(), found.end(), [](auto const& a, auto const& b) { return a.first > b.first; });
  double const best = found.front().first;
  std::erase_if(found, [&](auto const& f) { return f.first < best - near_best; });
  found.resize(std::min(most, found.size()));
  Explanation a;
  a.json = Json::array();
  for (auto const& [like, m] : found) {
    a.json.push_back(*m);
    a.text += fmt::format("{}: {}\n", m->at("severity").get<std::string>(), m->at("what").get<std::string>());
    a.text += fmt::format("  remedy   {}\n  about    {}\n", m->at("remedy").get<std::string>(),
                          m->at("about").get<std::string>());
  }
  return a;
}

}  // namespace straytrace
