// SPDX-License-Identifier: BSD-3-Clause
// Every command explains itself: a task, one sentence of purpose, two examples that parse, each option in a group.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/every_module.hpp"
#include "cli/options.hpp"
#include "support/help_examples.hpp"

namespace straytrace {
namespace {

using testing::examples_in;
using ::testing::HasSubstr;
using testing::split;

bool is_one_of(std::vector<std::string> const& all, std::string const& name) {
  return std::ranges::find(all, name) != all.end();
}

bool is_sentence(std::string const& text) {
  return !text.empty() && std::isupper(static_cast<unsigned char>(text[0])) && text.ends_with('.') &&
         text.find(". ") == text.npos && text.find('\n') == text.npos;
}

// Missing parts of the help of this command; empty: none.
std::string fault_of(CLI::App const& command, std::vector<std::string> const& groups) {
  if (!is_one_of(groups, command.get_group())) return "is in no group";
  if (!is_sentence(command.get_description())) return "its purpose is no sentence";
  for (CLI::Option const* option : command.get_options())
    if (option->nonpositional() && !is_one_of(option_groups(), option->get_group()))
      return option->get_name() + " is in no group";
  std::string const help = command.help();
  if (!help.starts_with(command.get_description() + "\n\nExamples:\n  "))
    return "does not begin with purpose, examples";
  return examples_in(help).size() < 2 ? "has fewer than two examples" : "";
}

struct Parsed {};  // thrown between the parse and the command

struct Program {
  CLI::App app{"Test the commands.", "straytrace"};
  int exit_code = 0;

  Program() {
    add_commands(app, exit_code);
    lay_out_help(app);
    app.parse_complete_callback([] { throw Parsed(); });
  }

  // Empty: these words are a command line; nothing runs.
  std::string error_text_of(std::vector<std::string> words) {
    std::ranges::reverse(words);
    try {
      app.parse(words);
    } catch (CLI::ParseError const& e) {
      return e.what();
    } catch (Parsed const&) {
      return "";
    }
    return "the command ran";
  }
};

std::vector<CLI::App*> commands_of(CLI::App& app) {
  std::vector<CLI::App*> all;
  for (CLI::App* command : app.get_subcommands(nullptr)) {
    all.push_back(command);
    for (CLI::App* below : command->get_subcommands(nullptr)) all.push_back(below);
  }
  return all;
}

std::vector<std::string> const command_groups{"Model", "Light", "Noise", "Data", "Results", "Cluster", "Look-up"};

TEST(Help, EveryCommandHasATaskAPurposeExamplesAndGroups) {
  Program program;
  CLI::App& app = program.app;
  std::vector<CLI::App*> const commands = commands_of(app);
  EXPECT_GE(commands.size(), 44u);
  for (CLI::App const* command : commands) {
    bool const top = command->get_parent() == &app;
    EXPECT_EQ(fault_of(*command, top ? command_groups : std::vector<std::string>{"Subcommands"}), "")
        << command->get_name();
  }
  for (std::string const& group : command_groups) EXPECT_THAT(app.help(), HasSubstr("\n" + group + ":\n  "));
}

TEST(Help, ExamplesParse) {
  std::filesystem::current_path(STRAY_SOURCE_DIR);
  Program program;
  for (CLI::App* command : commands_of(program.app))
    for (std::vector<std::string> const& words : examples_in(command->help()))
      EXPECT_EQ(program.error_text_of(words), "") << ::testing::PrintToString(words);
}

// Each check must reject the fault it is there for.
TEST(Help, FaultsAreFound) {
  CLI::App app;
  std::string const purpose = "Show the differences.",
                    footer = "Examples:\n  straytrace diff a b\n  straytrace diff c d";
  CLI::App& command = *app.add_subcommand("diff", purpose)->group("Results");
  command.footer(footer);
  lay_out_help(app);
  ASSERT_EQ(fault_of(command, command_groups), "");

  command.group("Else");
  EXPECT_EQ(fault_of(command, command_groups), "is in no group");
  command.group("Results");
  for (std::string const wrong : {"", "the differences.", "Show differences", "Show. All differences."}) {
    command.description(wrong);
    EXPECT_EQ(fault_of(command, command_groups), "its purpose is no sentence") << wrong;
  }
  command.description(purpose);
  command.footer("Examples:\n  straytrace diff a b");
  EXPECT_EQ(fault_of(command, command_groups), "has fewer than two examples");
  command.footer(footer);
  bool flag = false;
  command.add_flag("--new", flag, "of no group");
  EXPECT_EQ(fault_of(command, command_groups), "--new is in no group");

  Program program;
  EXPECT_THAT(program.error_text_of(split("run examples/virgo_arm.yaml")), HasSubstr("--out is required"));
  EXPECT_NE(program.error_text_of(split("check examples/virgo_arm.yaml --rim 3")), "");
  EXPECT_NE(program.error_text_of(split("paths run.h5 --by size")), "");
}

}  // namespace
}  // namespace straytrace
