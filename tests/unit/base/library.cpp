// SPDX-License-Identifier: BSD-3-Clause
// Libraries that are loaded on request: what is not there, cannot be loaded or is another one is an error with a
// remedy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "base/process/child_process.hpp"

namespace straytrace::library_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refusal(std::string const& library, std::string const& symbol) {
  try {
    library_symbol(library, symbol, "build it again");
  } catch (InputError const& e) {
    return e.what();
  }
  return "loaded";
}

TEST(Library, ErrorsHaveTheRemedy) {
  EXPECT_EQ(installed_library("libstraytrace_of_nothing.so"), "");
  EXPECT_THAT(refusal("/nowhere/libnothing.so", "cos"), AllOf(HasSubstr("/nowhere/libnothing.so"), HasSubstr("again")));
  EXPECT_THAT(refusal(STRAY_SOURCE_DIR "/README.md", "cos"),
              AllOf(HasSubstr("README.md"), HasSubstr("build it again")));
  EXPECT_THAT(refusal("libm.so.6", "straytrace_wave_device"),
              AllOf(HasSubstr("'libm.so.6' is not an engine of straytrace"), HasSubstr("build it again")));
  EXPECT_EQ(refusal("libm.so.6", "cos"), "loaded");  // control
}

}  // namespace
}  // namespace straytrace::library_test
