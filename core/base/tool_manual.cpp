#include "core/base/tool_manual.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/version.hpp"

namespace scree {

namespace {

/// Text as roff shall print it: no control lines, no escapes, and hyphens that can be copied into a shell.
std::string roff(const std::string& text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    line_start = c == '\n';
  }
  return out;
}

/// The words of an option that takes one of several: CLI11 keeps them in the type's name, "TEXT:{overlap,blocking}".
std::vector<std::string> words_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.rfind('}');
  if (open == std::string::npos || close == std::string::npos || close < open) return {};
  std::vector<std::string> words;
  for (const std::string& word : CLI::detail::split(type.substr(open + 1, close - open - 1), ',')) words.push_back(word);
  return words;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* sub) { return !sub->get_name().empty() && !sub->get_group().empty(); });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  return app.get_options([&](const CLI::Option* option) { return !option->get_group().empty() && option->get_positional() == positional; });
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

/// What stands for the value of an option: its words, or VALUE.
std::string placeholder(const CLI::Option& option) {
  std::string text = "VALUE";
  if (const std::vector<std::string> words = words_of(option); !words.empty()) {
    text.clear();
    for (const std::string& word : words) text += (text.empty() ? "" : "|") + word;
  }
  return text;
}

std::string synopsis(const std::string& name, const CLI::App& app) {
  std::string line = fmt::format("\\fB{}\\fR [\\fIOPTIONS\\fR]", roff(name));
  for (const CLI::Option* option : options_of(app, true)) {
    const std::string word = fmt::format("\\fI{}\\fR", roff(option->get_name(true)));
    line += option->get_required() ? " " + word : fmt::format(" [{}]", word);
    if (option->get_items_expected_max() > 1) line += " ...";
  }
  return line;
}

std::string options_text(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : options_of(app, true)) {
    text += fmt::format(".TP\n\\fI{}\\fR\n{}\n", roff(option->get_name(true)), roff(option->get_description()));
  }
  for (const CLI::Option* option : options_of(app, false)) {
    std::string names;
    for (const std::string& name : option->get_snames()) names += fmt::format("{}\\fB\\-{}\\fR", names.empty() ? "" : ", ", roff(name));
    for (const std::string& name : option->get_lnames()) names += fmt::format("{}\\fB\\-\\-{}\\fR", names.empty() ? "" : ", ", roff(name));
    if (takes_value(*option)) names += fmt::format(" \\fI{}\\fR", roff(placeholder(*option)));
    text += fmt::format(".TP\n{}\n{}\n", names, roff(option->get_description()));
  }
  return text;
}

}  // namespace

std::string manual_page(const CLI::App& app, const std::vector<std::pair<std::string, std::string>>& examples) {
  const std::string name = app.get_name();
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::string page = fmt::format(".TH {} 1 \"\" \"Scree {}\" \"Scree manual\"\n", roff(upper), kVersion);
  std::string purpose = app.get_description();
  if (!purpose.empty() && purpose.back() == '.') purpose.pop_back();
  page += fmt::format(".SH NAME\n{} \\- {}\n", roff(name), roff(purpose));

  page += ".SH SYNOPSIS\n";
  if (app.get_require_subcommand_min() == 0) page += synopsis(name, app) + "\n";
  bool first = app.get_require_subcommand_min() != 0;
  for (const CLI::App* sub : commands_of(app)) {
    page += (first ? "" : ".br\n") + synopsis(name + " " + sub->get_name(), *sub) + "\n";
    first = false;
  }
  if (!examples.empty()) page += ".SH EXAMPLES\n";
  for (const auto& [command, comment] : examples) page += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(command), roff(comment));
  if (const std::string text = options_text(app); !text.empty()) page += ".SH OPTIONS\n" + text;
  if (!commands_of(app).empty()) page += ".SH COMMANDS\n";
  for (const CLI::App* sub : commands_of(app)) {
    page += fmt::format(".SS {}\n{}\n{}", roff(sub->get_name()), roff(sub->get_description()), options_text(*sub));
  }
  page +=
      ".SH EXIT STATUS\n"
      ".TP\n0\ndone\n.TP\n1\na mistake of Scree itself: please report it\n.TP\n2\nthe command line or the case file is wrong\n"
      ".TP\n3\nan input cannot be used: a broken mesh, a truncated, damaged or newer file\n.TP\n4\nthe disk, the memory or MPI failed\n"
      ".TP\n5\nthe simulation became invalid; the message names body, contact and step\n.TP\n128+\\fIn\\fR\nstopped by signal \\fIn\\fR\n";
  page += ".SH SEE ALSO\n";
  std::string others;
  for (const char* tool : {"scree-mesher", "scree-decomposer", "scree-solver", "scree-post"}) {
    if (name != tool) others += fmt::format("{}\\fB{}\\fR(1)", others.empty() ? "" : ", ", roff(tool));
  }
  return page + others + "\n";
}

std::string bash_completion(const CLI::App& app) {
  const std::string name = app.get_name();
  std::string function = "_" + name;
  std::replace(function.begin(), function.end(), '-', '_');

  // One case per command: its options, and the words of those that take one of several.
  std::string cases, commands;
  const auto add = [&](const std::string& pattern, const CLI::App& one, const CLI::App* parent) {
    std::string options, values;
    const auto collect = [&](const CLI::App& from) {
      for (const CLI::Option* option : options_of(from, false)) {
        std::string pattern_of;
        for (const std::string& word : option->get_lnames()) {
          options += fmt::format("{}--{}", options.empty() ? "" : " ", word);
          pattern_of += fmt::format("{}--{}", pattern_of.empty() ? "" : "|", word);
        }
        for (const std::string& word : option->get_snames()) pattern_of += fmt::format("{}-{}", pattern_of.empty() ? "" : "|", word);
        std::string words;
        for (const std::string& word : words_of(*option)) words += (words.empty() ? "" : " ") + word;
        if (!words.empty()) values += fmt::format("        {}) words=\"{}\" ;;\n", pattern_of, words);
      }
    };
    collect(one);
    if (parent != nullptr && one.get_fallthrough()) collect(*parent);
    cases += fmt::format("    {})\n      options=\"{}\"\n", pattern, options);
    if (!values.empty()) cases += fmt::format("      case \"$previous\" in\n{}      esac\n", values);
    cases += "      ;;\n";
  };
  for (const CLI::App* sub : commands_of(app)) {
    commands += (commands.empty() ? "" : " ") + sub->get_name();
    add(sub->get_name(), *sub, &app);
  }
  add("*", app, nullptr);

  return fmt::format(R"(# bash completion of {name}; zsh: autoload -U bashcompinit && bashcompinit, then source this file
{function}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} command="" options="" words="" i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case " {commands} " in *" ${{COMP_WORDS[i]}} "*) command=${{COMP_WORDS[i]}}; break ;; esac
  done
  case "$command" in
{cases}  esac
  if [[ -n $words ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  elif [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$word"))
  else
    if [[ -z $command && $COMP_CWORD -eq 1 ]]; then COMPREPLY=($(compgen -W "{commands}" -- "$word")); fi
    local IFS=$'\n'   # names of files may hold spaces
    COMPREPLY+=($(compgen -f -- "$word"))
  fi
}}
complete -o filenames -F {function} {name}
)",
                     fmt::arg("name", name), fmt::arg("function", function), fmt::arg("commands", commands), fmt::arg("cases", cases));
}

}  // namespace scree
