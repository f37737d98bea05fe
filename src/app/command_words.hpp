// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace straytrace {

// What is wrong with a command line and what to write instead, "what\n  remedy". `named`: the commands so far, each
// with a space behind it.
std::string in_our_words(CLI::App const& command, CLI::App const& app, CLI::ParseError const&,
                         std::string const& named);

}  // namespace straytrace
