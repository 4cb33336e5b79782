#include "decomposer/case/case_settings.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "core/base/error.hpp"
#include "decomposer/case/parse_toml.hpp"

namespace scree {

namespace {

/// The table that holds a value, so that a value of any type can be copied into another table.
toml::table parsed_value(const std::string& text, const std::string& setting) {
  try {
    return parse_toml("value = " + text, "--set " + setting);
  } catch (const toml::parse_error&) {
    toml::table holder;  // no TOML value: a text whose quotes were left to the shell
    holder.insert("value", text);
    return holder;
  }
}

std::vector<std::string> split_key(const std::string& key) {
  std::vector<std::string> names(1);
  for (const char c : key) {
    if (c == '.')
      names.emplace_back();
    else
      names.back() += c;
  }
  return names;
}

/// One setting on its way down to its key.
class Setter {
 public:
  Setter(std::string setting, std::vector<std::string> names, toml::table value)
      : setting_(std::move(setting)), names_(std::move(names)), value_(std::move(value)) {}

  void set(toml::table& table, std::size_t depth) const {
    const std::string& name = names_[depth];
    if (depth + 1 == names_.size()) {
      table.insert_or_assign(name, *value_.get("value"));
      return;
    }
    if (!table.contains(name)) table.insert(name, toml::table{});
    toml::node* next = table.get(name);
    if (toml::table* below = next->as_table())
      set(*below, depth + 1);
    else if (toml::array* list = next->as_array())
      set_in_list(*list, depth + 1);
    else
      throw error(path_to(depth) + " is neither a table nor a list; nothing can be set in it");
  }

 private:
  void set_in_list(toml::array& list, std::size_t depth) const {
    const std::string& name = names_[depth];
    for (const std::size_t index : indices(list, depth)) {
      toml::node* element = list.get(index);
      if (depth + 1 == names_.size())
        list.replace(list.cbegin() + static_cast<std::ptrdiff_t>(index), *value_.get("value"));
      else if (toml::table* below = element->as_table())
        set(*below, depth + 1);
      else if (toml::array* inner = element->as_array())
        set_in_list(*inner, depth + 1);
      else
        throw error(path_to(depth - 1) + "." + name + " is neither a table nor a list; nothing can be set in it");
    }
  }

  std::vector<std::size_t> indices(const toml::array& list, std::size_t depth) const {
    std::vector<std::size_t> all(list.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    const std::string& name = names_[depth];
    if (name == "*") return all;
    std::size_t index = 0;
    const auto [end, code] = std::from_chars(name.data(), name.data() + name.size(), index);
    if (code != std::errc{} || end != name.data() + name.size()) {
      throw error(fmt::format("{} is a list: after it comes a number from 0, or * for all of it, not '{}'", path_to(depth - 1), name));
    }
    if (index >= list.size()) {
      throw error(fmt::format("there is no {}.{}; the case has {} of them, counted from 0", path_to(depth - 1), index, list.size()));
    }
    return {index};
  }

  std::string path_to(std::size_t depth) const {
    std::string path;
    for (std::size_t d = 0; d <= depth; ++d) path += (d == 0 ? "" : ".") + names_[d];
    return path;
  }

  UsageError error(const std::string& text) const { return UsageError("--set {}: {}", setting_, text); }

  std::string setting_;
  std::vector<std::string> names_;
  toml::table value_;
};

}  // namespace

void apply_settings(toml::table& file, const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    const std::string key = setting.substr(0, equals);
    const std::vector<std::string> names = split_key(key);
    if (equals == std::string::npos || std::any_of(names.begin(), names.end(), [](const std::string& n) { return n.empty(); })) {
      throw UsageError("--set {}: expected KEY=VALUE, for instance pairs.0.friction=0.4 or contact.margin=\"2 mm\"", setting);
    }
    if (names.size() > kMaxKeyParts) throw UsageError("--set: a key of {} parts; expected at most {}", names.size(), kMaxKeyParts);
    Setter(setting, names, parsed_value(setting.substr(equals + 1), setting)).set(file, 0);
  }
}

std::string text_with_settings(const toml::table& file, const std::string& path, const std::vector<std::string>& settings) {
  std::ostringstream text;
  text << "# " << path << " with\n";
  for (std::string setting : settings) {
    std::replace(setting.begin(), setting.end(), '\n', ' ');  // it stays one comment
    text << "#   --set " << setting << "\n";
  }
  text << file << "\n";
  return text.str();
}

}  // namespace scree
