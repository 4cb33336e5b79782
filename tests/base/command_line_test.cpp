#include "core/base/command_line.hpp"
#include "core/base/expect_ending.hpp"
#include "core/base/nearest_name.hpp"

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/base/version.hpp"

namespace scree {
namespace {

// A tool with one command and one option, called with words.
struct Tool {
  std::unique_ptr<CLI::App> app =
      make_command_line("scree-test", "Tests the command line.", {{"scree-test weigh rock.stl", "how heavy is it?"}}, "gmsh 4.8.4");
  double scale = 1.0;
  std::string file;
  CLI::App* weigh = app->add_subcommand("weigh", "Weigh a rock");
  Tool() {
    app->require_subcommand(1);
    weigh->add_option("file", file, "The rock")->required();
    weigh->add_option("--scale", scale, "Factor");
  }
  bool call(std::vector<std::string> words) {
    words.insert(words.begin(), "scree-test");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    return parse_command_line(*app, static_cast<int>(argv.size()), argv.data());
  }
  std::string complaint(const std::vector<std::string>& words) {
    try {
      call(words);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  }
};

TEST(command_line, reads_commands_and_options) {
  Tool tool;
  EXPECT_TRUE(tool.call({"weigh", "rock.stl", "--scale", "2.5"}));
  EXPECT_EQ(tool.file, "rock.stl");
  EXPECT_EQ(tool.scale, 2.5);
}

TEST(command_line, prints_help_with_examples_before_the_options) {
  Tool tool;
  testing::internal::CaptureStdout();
  EXPECT_FALSE(tool.call({"--help"}));
  const std::string help = testing::internal::GetCapturedStdout();
  const auto example = help.find("scree-test weigh rock.stl   # how heavy is it?");
  ASSERT_NE(example, std::string::npos) << help;
  EXPECT_LT(example, help.find("--help")) << help;
  EXPECT_NE(help.find("Tests the command line."), std::string::npos);
}

TEST(command_line, prints_the_version_with_everything_the_build_knows) {
  Tool tool;
  testing::internal::CaptureStdout();
  EXPECT_FALSE(tool.call({"--version"}));
  const std::string text = testing::internal::GetCapturedStdout();
  for (const char* part : {"scree-test ", kVersion, kGitHash, kCompiler, "SIMD:", "MPI:", "HDF5:", "gmsh 4.8.4"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in\n" << text;
  }
}

TEST(command_line, names_the_nearest_option_or_command_for_a_misspelt_one) {
  EXPECT_EQ(Tool().complaint({"weigh", "rock.stl", "--scael", "2"}),
            "unknown option '--scael', did you mean '--scale'?; see scree-test weigh --help");
  EXPECT_EQ(Tool().complaint({"wiegh", "rock.stl"}), "unknown command 'wiegh', did you mean 'weigh'?; see scree-test --help");
  EXPECT_EQ(Tool().complaint({"weigh", "rock.stl", "stone.stl"}), "unexpected argument 'stone.stl'; see scree-test weigh --help");
}

TEST(command_line, refuses_what_is_missing_or_of_the_wrong_type) {
  EXPECT_NE(Tool().complaint({"weigh"}).find("file is required"), std::string::npos) << Tool().complaint({"weigh"});
  EXPECT_NE(Tool().complaint({}).find("subcommand is required"), std::string::npos) << Tool().complaint({});
  EXPECT_NE(Tool().complaint({"weigh", "rock.stl", "--scale", "big"}).find("--scale"), std::string::npos);
}

TEST(command_line, takes_a_quantity_with_a_unit_and_a_bare_number_in_si) {
  Tool tool;
  double length = 0;
  std::vector<double> point;
  add_quantity(*tool.weigh, "-l,--length", length, Dimension::length, "How long");
  add_quantities(*tool.weigh, "--at", point, 3, Dimension::length, "Where");
  EXPECT_TRUE(tool.call({"weigh", "rock.stl", "--length", "2 mm", "--at", "-1", "2 cm", "-3mm"}));
  EXPECT_EQ(length, 0.002);
  EXPECT_EQ(point, (std::vector<double>{-1, 0.02, -0.003}));
  EXPECT_TRUE(tool.call({"weigh", "rock.stl", "-l", "0.25"}));
  EXPECT_EQ(length, 0.25);
  EXPECT_NE(tool.complaint({"weigh", "rock.stl", "--length", "2 s"}).find("--length = \"2 s\": a time"), std::string::npos);
  EXPECT_NE(tool.complaint({"weigh", "rock.stl", "--at", "1", "2"}), "accepted");
}

TEST(command_line, says_which_name_to_write_where_an_ending_is_missing) {
  const auto complaint = [](const std::string& path) {
    try {
      expect_ending("-o", path, "a scene", {".scene.h5"});
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(complaint("runs/box.scene.h5"), "accepted");
  for (const char* path : {"runs/box", "runs/box.h5", "runs/box.scene", "runs/box.shape.h5"}) {
    EXPECT_EQ(complaint(path), fmt::format("-o {}: a scene is called NAME.scene.h5; write -o runs/box.scene.h5", path));
  }
  EXPECT_NE(complaint(".scene.h5"), "accepted");
}

TEST(nearest_name, forgives_a_third_of_a_word_and_no_more) {
  const std::vector<std::string> keys{"density", "friction", "restitution", "rolling_friction"};
  EXPECT_EQ(nearest_name("desnity", keys), "density");
  EXPECT_EQ(nearest_name("frction", keys), "friction");
  EXPECT_EQ(nearest_name("restitutoin", keys), "restitution");
  EXPECT_EQ(nearest_name("colour", keys), "");
  EXPECT_EQ(nearest_name("", keys), "");
  EXPECT_EQ(nearest_name("density", {}), "");
}

}  // namespace
}  // namespace scree
