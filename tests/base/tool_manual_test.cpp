#include "core/base/tool_manual.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>

#include "core/base/command_line.hpp"

namespace scree {
namespace {

struct Tool {
  std::unique_ptr<CLI::App> app = make_command_line("scree-test", "Tests the manual.", {});
  std::string file, colour = "red", hidden;
  double scale = 1;
  CLI::App* weigh = app->add_subcommand("weigh", "Weigh a rock");
  Tool() {
    app->require_subcommand(1);
    weigh->add_option("FILE", file, "The rock\n.not a command of roff")->required();
    weigh->add_option("-s,--scale", scale, "Factor");
    weigh->add_option("--colour", colour, "Of the rock")->check(CLI::IsMember({"red", "blue"}));
  }
};

/// What a program prints that reads a text from its standard input.
std::string output_of(const std::string& command) {
  std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) text += static_cast<char>(c);
  return text;
}

/// What bash offers after some words, with the completion of the tool loaded.
std::string offered(const std::string& words) {
  const Tool tool;
  const std::string script =
      bash_completion(*tool.app) + "COMP_WORDS=(" + words + "); COMP_CWORD=$((${#COMP_WORDS[@]}-1)); _scree_test; echo ${COMPREPLY[*]}";
  std::string quoted;
  for (const char c : script) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return output_of("cd / && bash -c '" + quoted + "'");
}

TEST(tool_manual, the_page_holds_every_command_option_and_word) {
  const Tool tool;
  const std::string page = manual_page(*tool.app, {{"scree-test weigh a.stl", "how heavy?"}});
  for (const char* text :
       {".TH SCREE\\-TEST 1", "scree\\-test \\- Tests the manual\n", ".SS weigh", "\\fB\\-s\\fR, \\fB\\-\\-scale\\fR \\fIVALUE\\fR",
        "\\fIred|blue\\fR", "scree\\-test weigh a.stl", ".SH EXIT STATUS"}) {
    EXPECT_NE(page.find(text), std::string::npos) << text << "\n" << page;
  }
}

TEST(tool_manual, a_line_of_the_description_is_never_a_command_of_roff) {
  const Tool tool;
  EXPECT_NE(manual_page(*tool.app, {}).find("\n\\&.not a command"), std::string::npos);
}

TEST(tool_manual, bash_completes_commands_options_and_the_words_of_an_option) {
  EXPECT_EQ(offered("scree-test we"), "weigh\n");
  EXPECT_EQ(offered("scree-test weigh --sc"), "--scale\n");
  EXPECT_EQ(offered("scree-test weigh --colour ''"), "red blue\n");
  EXPECT_EQ(offered("scree-test weigh --colour b"), "blue\n");
  EXPECT_EQ(offered("scree-test weigh us"), "usr\n");  // a folder of every machine, seen from the root
}

}  // namespace
}  // namespace scree
