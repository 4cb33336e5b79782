#include "post/run/provenance_chain.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

#include "core/base/provenance.hpp"
#include "core/base/utf8.hpp"
#include "core/storage/written_by_program.hpp"

namespace scree {

namespace {

std::string word(const nlohmann::json& record, const char* key) {
  return record.is_object() && record.contains(key) && record[key].is_string() ? record[key].get<std::string>() : std::string();
}

const nlohmann::json& inputs_of(const nlohmann::json& record) {
  static const nlohmann::json none = nlohmann::json::array();
  return record.is_object() && record.contains("inputs") && record["inputs"].is_array() ? record["inputs"] : none;
}

void add(const nlohmann::json& record, int depth, const std::string& file, const std::string& sha256, std::vector<ChainEntry>& chain) {
  ChainEntry entry;
  entry.depth = depth;
  entry.file = file;
  entry.sha256 = sha256;
  entry.tool = word(record, "tool");
  entry.version = word(record, "tool_version");
  entry.git = word(record, "git").substr(0, 12);
  if (!entry.git.empty() && record.value("git_dirty", false)) entry.git += " + changes";
  entry.utc = word(record, "utc");
  entry.configuration = word(record, "configuration");
  if (record.is_object() && record.contains("command")) entry.command = shell_line(record["command"]);
  chain.push_back(entry);
  for (const nlohmann::json& input : inputs_of(record)) {
    add(input.is_object() && input.contains("history") ? input["history"] : nlohmann::json(), depth + 1, word(input, "path"),
        word(input, "sha256"), chain);
  }
}

/// $'...' of bash: what is no printable text as \x and two digits.
std::string ansi_quoted(const std::string& text) {
  std::string quoted = "$'";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c < 0x20 || c >= 0x7F)
      quoted += fmt::format("\\x{:02x}", c);
    else if (c == '\'' || c == '\\')
      quoted += std::string("\\") + text[i];
    else
      quoted += text[i];
  }
  return quoted + "'";
}

/// A run that was continued is repeated from its start: the end is the same, and the checkpoint may be gone.
nlohmann::json without_restart(const nlohmann::json& words) {
  nlohmann::json kept = nlohmann::json::array();
  bool skip_next = false;
  for (const nlohmann::json& w : words) {
    const std::string text = w.is_string() ? w.get<std::string>() : "";
    if (!skip_next && text != "--restart" && !text.starts_with("--restart=")) kept.push_back(w);
    skip_next = text == "--restart";
  }
  return kept;
}

void collect(const nlohmann::json& record, std::vector<std::string>& commands) {
  for (const nlohmann::json& input : inputs_of(record)) {
    if (input.is_object() && input.contains("history")) collect(input["history"], commands);
  }
  if (!record.is_object() || !record.contains("command")) return;
  if (is_written_by_program(record)) return;  // its command is no line for a shell
  const bool is_run = word(record, "tool") == "scree-solver";
  std::string line = shell_line(is_run ? without_restart(record["command"]) : record["command"]);
  if (line.empty()) return;
  if (is_run) {
    line = fmt::format("OMP_NUM_THREADS={} mpirun -n {} {}", record.value("threads", 1), record.value("ranks", 1), line);
  }
  if (std::find(commands.begin(), commands.end(), line) == commands.end()) commands.push_back(line);
}

}  // namespace

std::vector<ChainEntry> chain_of(const nlohmann::json& record) {
  std::vector<ChainEntry> chain;
  add(record, 0, "", "", chain);
  return chain;
}

std::vector<ChainFile> check_files(const nlohmann::json& record, const std::string& run_folder) {
  namespace fs = std::filesystem;
  const fs::path beside = fs::absolute(run_folder).parent_path();
  std::vector<ChainFile> files;
  for (const ChainEntry& entry : chain_of(record)) {
    if (entry.depth == 0 || entry.file.empty()) continue;
    if (std::any_of(files.begin(), files.end(), [&](const ChainFile& f) { return f.file == entry.file && f.sha256 == entry.sha256; }))
      continue;
    ChainFile file{entry.file, entry.sha256, "", ChainFile::State::missing};
    const fs::path name(bytes_from_utf8(entry.file));
    for (const fs::path& path : {name, beside / name, beside / name.filename()}) {
      std::error_code error;
      if (!fs::is_regular_file(path, error)) continue;
      const bool same = !entry.sha256.empty() && sha256_of_file(path.string()) == entry.sha256;
      if (file.found.empty() || same) file.found = path.string();
      file.state = same ? ChainFile::State::same : ChainFile::State::changed;
      if (same) break;
    }
    files.push_back(file);
  }
  return files;
}

std::vector<std::string> commands_of(const nlohmann::json& record) {
  std::vector<std::string> commands;
  collect(record, commands);
  return commands;
}

bool has_program(const nlohmann::json& record) {
  if (is_written_by_program(record)) return true;
  const nlohmann::json& inputs = inputs_of(record);
  return std::any_of(inputs.begin(), inputs.end(), [](const nlohmann::json& input) {
    return input.is_object() && input.contains("history") && has_program(input["history"]);
  });
}

std::string shell_line(const nlohmann::json& words) {
  std::string line;
  if (!words.is_array()) return line;
  for (const nlohmann::json& w : words) {
    if (!w.is_string()) continue;
    std::string text = bytes_from_utf8(w.get<std::string>());
    if (line.empty()) text = std::filesystem::path(text).filename().string();  // the tool, wherever it was installed
    const bool plain = !text.empty() && text.find_first_not_of(
                                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                            "_-+=./:,@%") == std::string::npos;
    const bool shown_as_it_is =
        printable(text) == text && std::none_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; });
    if (!plain && !shown_as_it_is) {
      text = ansi_quoted(text);
    } else if (!plain) {
      std::string quoted = "'";
      for (char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
      text = quoted + "'";
    }
    line += (line.empty() ? "" : " ") + text;
  }
  return line;
}

}  // namespace scree
