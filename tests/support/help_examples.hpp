// SPDX-License-Identifier: BSD-3-Clause
// The examples of --help, as words that a shell would pass.
#pragma once

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace straytrace::testing {

// Words of a line as a shell would split them, without wildcards; a redirection or a pipe ends it.
inline std::vector<std::string> split(std::string const& line) {
  std::vector<std::string> words;
  std::istringstream in(line);
  for (std::string word; in >> word && word != ">" && word != "|";) {
    if (char const quote = word.front(); quote == '"' || quote == '\'') {
      std::string rest;
      if (!word.ends_with(quote) || word.size() == 1) std::getline(in, rest, quote);
      word = word.substr(1) + rest;
      if (word.ends_with(quote)) word.pop_back();
    }
    words.push_back(word);
  }
  return words;
}

// The commands under 'Examples:' of a help text.
inline std::vector<std::vector<std::string>> examples_in(std::string const& help) {
  std::vector<std::vector<std::string>> found;
  std::istringstream in(help.substr(std::min(help.find("Examples:"), help.size())));
  for (std::string line; std::getline(in, line);)
    if (std::vector<std::string> words = split(line);
        words.size() > 1 && words[0] == "straytrace" && words[1] != "--help")
      found.emplace_back(words.begin() + 1, words.end());
  return found;
}

}  // namespace straytrace::testing
