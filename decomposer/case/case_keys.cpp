#include "decomposer/case/case_keys.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace scree {

namespace {

// A quaternion typed by hand has few digits; a wrong one is off by far more.
constexpr double kTypedQuaternionTolerance = 1e-3;

/// Notes what the entries say.
class Describer : public CaseKeys {
 public:
  /// in   deep   also the sections below
  Describer(std::vector<KeyDescription>& all, std::string table, bool deep) : all_(all), table_(std::move(table)), deep_(deep) {}

  const CaseTable* table() const override { return nullptr; }
  std::vector<std::string> left_over() const override { return {}; }
  bool when(bool) override { return true; }
  std::string one_of(const std::vector<const char*>& keys) override {
    all_.push_back({table_, "", "one_of", Dimension::none, Range::any, {keys.begin(), keys.end()}, "", ""});
    return "";
  }
  void number(const Key& key, double& value, Dimension dimension, Range range) override {
    add(key, "number", fmt::format("{:g}", value), dimension, range);
  }
  void count(const Key& key, std::uint64_t& value) override {
    add(key, "integer", fmt::format("{}", value), Dimension::none, Range::not_negative);
  }
  void integer(const Key& key, std::int64_t& value, std::int64_t smallest) override {
    add(key, "integer", fmt::format("{}", value), Dimension::none,
        smallest > 0    ? Range::positive
        : smallest == 0 ? Range::not_negative
                        : Range::any);
  }
  void boolean(const Key& key, bool& value) override { add(key, "boolean", value ? "true" : "false"); }
  void text(const Key& key, std::string& value) override { add(key, "text", value); }
  void path(const Key& key, std::string&) override { add(key, "path", ""); }
  void vector(const Key& key, Vec3& v, Dimension dimension) override {
    add(key, "vector", fmt::format("[{:g}, {:g}, {:g}]", v.x, v.y, v.z), dimension);
  }
  void direction(const Key& key, Vec3&) override { add(key, "direction", ""); }
  void velocity(const Key& key, double&, Vec3&) override { add(key, "vector", "", Dimension::velocity); }
  void numbers(const Key& key, std::vector<double>&, Dimension dimension) override { add(key, "numbers", "", dimension); }
  void vectors(const Key& key, std::vector<Vec3>&, Dimension dimension) override { add(key, "vectors", "", dimension); }
  void texts(const Key& key, std::vector<std::string>&) override { add(key, "texts", ""); }
  void axes(const Key& key, std::array<bool, 3>&) override { add(key, "texts", "none", Dimension::none, Range::any, {"x", "y", "z"}); }
  void some_of(const Key& key, std::vector<bool>&, const std::vector<std::string>& words, const char*) override {
    add(key, "texts", "none", Dimension::none, Range::any, words);
  }
  void only_word(const Key& key, const char* word) override { add(key, "word", word, Dimension::none, Range::any, {word}); }
  void reference(const Key& key, std::int32_t&, const std::vector<std::string>&, const char*) override { add(key, "name", ""); }
  void orientation(const Key& key, Quat&) override { add(key, "quaternion", "[1, 0, 0, 0]"); }
  void corners(const Key& key, Vec3&, Vec3&) override { add(key, "corners", "", Dimension::length); }
  void named_numbers(const Key& key, std::vector<std::pair<std::string, double>>&, Range range) override {
    add(key, "named_numbers", "", Dimension::none, range);
  }
  void named_texts(const Key& key, std::vector<std::pair<std::string, std::string>>&) override { add(key, "named_texts", ""); }
  void section(const Key& key, const Section& keys) override { descend(key, "table", "", keys); }
  void sections(const Key& key, const Section& keys) override { descend(key, "tables", "[]", keys); }
  void section_list(const Key& key, const Section&) override { add(key, "table_list", ""); }
  void named_sections(const Key& key, const std::function<void(CaseKeys&, const std::string&)>& keys) override {
    descend(key, "named_tables", ".*", [&](CaseKeys& k) { keys(k, ""); });
  }

 protected:
  void choose(const Key& key, std::size_t& index, const std::vector<std::string>& words) override {
    add(key, "word", words[index], Dimension::none, Range::any, words);
  }

 private:
  void add(const Key& key, const char* type, const std::string& value, Dimension dimension = Dimension::none, Range range = Range::any,
           std::vector<std::string> words = {}) {
    const bool has_value = *key.otherwise == '\0' && !key.needed && !value.empty();
    const std::string otherwise = has_value ? "`" + value + "`" : key.otherwise;
    all_.push_back({table_, key.name, type, dimension, range, std::move(words), otherwise, key.meaning});
  }
  void descend(const Key& key, const char* type, const char* suffix, const Section& keys) {
    add(key, type, "");
    if (!deep_) return;
    Describer below(all_, (table_.empty() ? "" : table_ + ".") + key.name + suffix, true);
    keys(below);
  }

  std::vector<KeyDescription>& all_;
  std::string table_;
  bool deep_;
};

/// Names of the keys that may stand in a section.
std::vector<std::string> names_of(const CaseKeys::Section& keys) {
  std::vector<KeyDescription> all;
  Describer describer(all, "", false);
  keys(describer);
  std::vector<std::string> names;
  for (const KeyDescription& d : all) {
    if (!d.key.empty() && std::find(names.begin(), names.end(), d.key) == names.end()) names.push_back(d.key);
  }
  return names;
}

class Reader : public CaseKeys {
 public:
  Reader(CaseTable table, const std::string& folder) : t_(std::move(table)), folder_(folder) {}

  const CaseTable* table() const override { return &t_; }
  std::vector<std::string> left_over() const override {
    std::vector<std::string> names = t_.keys();
    std::erase_if(names, [&](const std::string& name) { return std::find(visited_.begin(), visited_.end(), name) != visited_.end(); });
    return names;
  }
  std::string one_of(const std::vector<const char*>& keys) override { return t_.only_one_of(keys); }
  void number(const Key& key, double& value, Dimension dimension, Range range) override {
    if (visit(key)) value = t_.number(key.name, dimension, range);
  }
  void count(const Key& key, std::uint64_t& value) override {
    if (visit(key)) value = static_cast<std::uint64_t>(t_.integer(key.name, 0));
  }
  void integer(const Key& key, std::int64_t& value, std::int64_t smallest) override {
    if (visit(key)) value = t_.integer(key.name, smallest);
  }
  void boolean(const Key& key, bool& value) override {
    if (visit(key)) value = t_.boolean(key.name);
  }
  void text(const Key& key, std::string& value) override {
    if (visit(key)) value = t_.text(key.name);
  }
  void path(const Key& key, std::string& value) override {
    if (!visit(key)) return;
    value = t_.path(key.name);
    const std::filesystem::path path(value);
    if (!path.is_absolute() && !folder_.empty()) value = (std::filesystem::path(folder_) / path).lexically_normal().string();
  }
  void vector(const Key& key, Vec3& value, Dimension dimension) override {
    if (visit(key)) value = t_.vector(key.name, dimension);
  }
  void direction(const Key& key, Vec3& value) override {
    if (visit(key)) value = t_.direction(key.name);
  }
  void velocity(const Key& key, double& speed, Vec3& direction) override {
    if (!visit(key)) return;
    const Vec3 velocity = t_.vector(key.name, Dimension::velocity);
    speed = length(velocity);
    if (speed > 0) direction = normalised(velocity);
  }
  void numbers(const Key& key, std::vector<double>& values, Dimension dimension) override {
    if (visit(key)) values = t_.numbers(key.name, dimension);
  }
  void vectors(const Key& key, std::vector<Vec3>& values, Dimension dimension) override {
    if (visit(key)) values = t_.vectors(key.name, dimension);
  }
  void texts(const Key& key, std::vector<std::string>& values) override {
    if (visit(key)) values = t_.texts(key.name);
  }
  void axes(const Key& key, std::array<bool, 3>& value) override {
    if (!visit(key)) return;
    for (const std::string& axis : t_.texts(key.name)) {
      if (axis != "x" && axis != "y" && axis != "z") throw t_.error(key.name, "\"" + axis + "\": expected \"x\", \"y\" or \"z\"");
      value[static_cast<std::size_t>(axis[0] - 'x')] = true;
    }
  }
  void some_of(const Key& key, std::vector<bool>& chosen, const std::vector<std::string>& words, const char* kind) override {
    if (!visit(key)) return;
    for (const std::string& word : t_.texts(key.name)) chosen[static_cast<std::size_t>(t_.find_name(key.name, word, words, kind))] = true;
  }
  void only_word(const Key& key, const char* word) override {
    if (visit(key)) t_.word(key.name, {word});
  }
  void reference(const Key& key, std::int32_t& index, const std::vector<std::string>& names, const char* kind) override {
    if (visit(key)) index = t_.reference(key.name, names, kind);
  }
  void orientation(const Key& key, Quat& value) override {
    if (!visit(key)) return;
    const std::vector<double> q = t_.numbers(key.name, Dimension::none);
    if (q.size() != 4) throw t_.error(key.name, "expected a unit quaternion [w, x, y, z]");
    value = {q[0], q[1], q[2], q[3]};
    if (!(std::abs(norm(value) - 1) < kTypedQuaternionTolerance)) {
      throw t_.error(key.name, fmt::format("has norm {:.6g}; expected a unit quaternion [w, x, y, z]", norm(value)));
    }
    value = normalised(value);
  }
  void corners(const Key& key, Vec3& lower, Vec3& upper) override {
    if (visit(key)) std::tie(lower, upper) = t_.corners(key.name);
  }
  void named_numbers(const Key& key, std::vector<std::pair<std::string, double>>& values, Range range) override {
    if (visit(key)) values = t_.named_numbers(key.name, range);
  }
  void named_texts(const Key& key, std::vector<std::pair<std::string, std::string>>& values) override {
    if (visit(key)) values = t_.named_texts(key.name);
  }
  void section(const Key& key, const Section& keys) override {
    if (!visit(key)) return;
    Reader below(t_.table(key.name, names_of(keys)), folder_);
    keys(below);
  }
  void sections(const Key& key, const Section& keys) override {
    if (!visit(key)) return;
    for (CaseTable& table : t_.tables(key.name, names_of(keys))) {
      Reader below(std::move(table), folder_);
      keys(below);
    }
  }
  void section_list(const Key& key, const Section& keys) override { sections(key, keys); }
  void named_sections(const Key& key, const std::function<void(CaseKeys&, const std::string&)>& keys) override {
    if (!visit(key)) return;
    for (auto& [name, table] : t_.named_tables(key.name, names_of([&](CaseKeys& k) { keys(k, ""); }))) {
      Reader below(std::move(table), folder_);
      keys(below, name);
    }
  }

 protected:
  void choose(const Key& key, std::size_t& index, const std::vector<std::string>& words) override {
    if (visit(key)) index = t_.word(key.name, words);
  }

 private:
  /// Whether to read it: it is there, or it must be and the table is to say that it is missing.
  bool visit(const Key& key) {
    visited_.emplace_back(key.name);
    return key.needed || key.otherwise == kRequired || t_.has(key.name);
  }

  CaseTable t_;
  const std::string& folder_;
  std::vector<std::string> visited_;
};

}  // namespace

std::vector<KeyDescription> describe_keys(const CaseKeys::Section& keys) {
  std::vector<KeyDescription> all;
  Describer describer(all, "", true);
  keys(describer);
  return all;
}

void read_keys(const toml::table& file, const std::string& name, const std::string& folder, const CaseKeys::Section& keys) {
  Reader reader(CaseTable(file, name, "", names_of(keys)), folder);
  keys(reader);
}

}  // namespace scree
