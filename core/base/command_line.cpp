#include "core/base/command_line.hpp"

#include <algorithm>
#include <cstdio>

#include "core/base/error.hpp"
#include "core/base/nearest_name.hpp"
#include "core/base/tool_manual.hpp"
#include "core/base/version.hpp"

namespace scree {

namespace {

// Puts the examples between the purpose and the list of options: most readers need nothing else.
class ExamplesFirst : public CLI::Formatter {
 public:
  using Examples = std::vector<std::pair<std::string, std::string>>;
  explicit ExamplesFirst(Examples examples) : examples_(std::move(examples)) { column_width(34); }
  const Examples& examples() const { return examples_; }
  std::string make_description(const CLI::App* app) const override {
    std::string text = CLI::Formatter::make_description(app);
    if (app->get_parent() != nullptr || examples_.empty()) return text;
    std::size_t widest = 0;
    for (const auto& [command, comment] : examples_) widest = std::max(widest, command.size());
    text += "\nExamples:\n";
    for (const auto& [command, comment] : examples_) text += fmt::format("  {:<{}}   # {}\n", command, widest, comment);
    return text + "\n";
  }

 private:
  Examples examples_;
};

// What the build asks of a tool to make its manual page and its completion. Not in --help: no user needs them.
bool print_manual(const CLI::App& app, int argc, char** argv) {
  if (argc != 2) return false;
  const std::string word = argv[1];
  std::string text;
  if (word == "--print-manual-page") {
    const auto* formatter = dynamic_cast<const ExamplesFirst*>(app.get_formatter().get());
    text = manual_page(app, formatter != nullptr ? formatter->examples() : ExamplesFirst::Examples{});
  } else if (word == "--print-completion") {
    text = bash_completion(app);
  }
  std::fputs(text.c_str(), stdout);
  return !text.empty();
}

void collect_names(const CLI::App& app, bool options, std::vector<std::string>& names) {
  if (options) {
    for (const CLI::Option* option : app.get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
      for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    for (const CLI::App* sub : app.get_subcommands()) collect_names(*sub, true, names);  // those in use
  } else {
    for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) names.push_back(sub->get_name());
  }
}

std::string full_name(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* sub : app.get_subcommands()) name += " " + full_name(*sub);
  return name;
}

[[noreturn]] void explain(const CLI::App& app, const CLI::ParseError& error) {
  const std::string help = fmt::format("see {} --help", full_name(app));
  const std::vector<std::string> unknown = app.remaining(true);
  if (!unknown.empty()) {
    // the first word that was not understood is the likely cause even when another rule failed first
    const std::string& word = unknown.front();
    const bool is_option = word.size() > 1 && word.front() == '-';
    std::vector<std::string> names;
    collect_names(app, is_option, names);
    const std::string near = nearest_name(word.substr(0, word.find('=')), names);
    const bool may_be_command = !is_option && !names.empty() && app.get_subcommands().empty();
    throw UsageError("{} '{}'{}; {}", is_option ? "unknown option" : (may_be_command ? "unknown command" : "unexpected argument"), word,
                     near.empty() ? "" : fmt::format(", did you mean '{}'?", near), help);
  }
  throw UsageError("{}; {}", error.what(), help);
}

}  // namespace

std::unique_ptr<CLI::App> make_command_line(const std::string& tool, const std::string& purpose,
                                            const std::vector<std::pair<std::string, std::string>>& examples,
                                            const std::string& libraries) {
  auto app = std::make_unique<CLI::App>(purpose, tool);
  app->formatter(std::make_shared<ExamplesFirst>(examples));
  app->set_help_flag("-h,--help", "Print this help and exit");
  app->set_version_flag(
      "--version", [tool, libraries] { return version_text(tool, libraries); },
      "Print the version of the tool and of its libraries, and exit");
  return app;
}

bool parse_command_line(CLI::App& app, int argc, char** argv) {
  if (print_manual(app, argc, argv)) return false;
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {  // --help, --version: prints to stdout
    app.exit(done);
    return false;
  } catch (const CLI::ParseError& error) {
    explain(app, error);
  }
  return true;
}

CLI::Option* add_quantity(CLI::App& line, const std::string& names, double& value, Dimension dimension, const std::string& help) {
  const std::string option = names.substr(names.find("--"));
  return line.add_option_function<std::string>(
      names, [&value, dimension, option](const std::string& text) { value = parse_quantity(text, dimension, option); }, help);
}

CLI::Option* add_quantities(CLI::App& line, const std::string& names, std::vector<double>& values, int count, Dimension dimension,
                            const std::string& help) {
  const std::string option = names.substr(names.find("--"));
  return line
      .add_option_function<std::vector<std::string>>(
          names,
          [&values, dimension, option](const std::vector<std::string>& texts) {
            values.clear();
            for (const std::string& text : texts) values.push_back(parse_quantity(text, dimension, option));
          },
          help)
      ->expected(count);
}

std::vector<std::string> command_words(int argc, char** argv) { return {argv, argv + argc}; }

}  // namespace scree
