// Strict reading of a TOML table: an unknown key, a wrong type, a wrong dimension or a value out of range is an
// error that says where it is, what was found, what was expected and what to write.
#pragma once

#include <toml++/toml.h>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/geometry/vec3.hpp"
#include "core/storage/keys.hpp"

namespace scree {

/// One table of a case file. Borrows the parsed file, which must outlive it.
class CaseTable {
 public:
  /// in   file   name of the case as given, for messages     in   path   "materials.rock"; "" for the whole file
  /// in   keys   all keys that may occur; none: names of the user's choice.   Throws UsageError for any other, naming the nearest.
  CaseTable(const toml::table& table, std::string file, std::string path, const std::vector<std::string>& keys);

  bool has(const std::string& key) const { return table_->contains(key); }
  /// Keys that the table holds, in alphabetical order.
  std::vector<std::string> keys() const;
  bool is_table(const std::string& key) const { return has(key) && node(key).is_table(); }
  bool is_boolean(const std::string& key) const { return has(key) && node(key).is_boolean(); }
  bool is_text(const std::string& key) const { return has(key) && node(key).is_string(); }
  bool is_list(const std::string& key) const { return has(key) && node(key).is_array(); }
  /// "case.toml:14: materials.rock.friction"; the table's own place when the key is absent or "".
  std::string where(const std::string& key = "") const;
  /// An error about a key: "WHERE = VALUE: TEXT".
  UsageError error(const std::string& key, const std::string& text) const;

  double number(const std::string& key, Dimension dimension, Range range = Range::any) const;
  std::int64_t integer(const std::string& key, std::int64_t smallest) const;
  bool boolean(const std::string& key) const;
  /// A name or a title, of one line (see fault_of_name).
  std::string text(const std::string& key) const;
  /// Any text that a file can be called.
  std::string path(const std::string& key) const;
  Vec3 vector(const std::string& key, Dimension dimension) const;
  /// Scaled to length 1; throws when it is zero.
  Vec3 direction(const std::string& key) const;
  std::vector<double> numbers(const std::string& key, Dimension dimension) const;
  std::vector<Vec3> vectors(const std::string& key, Dimension dimension) const;
  std::vector<std::string> texts(const std::string& key) const;
  /// Opposite corners [[x, y, z], [x, y, z]], lower below upper in each coordinate.
  std::pair<Vec3, Vec3> corners(const std::string& key) const;
  /// Index of the word that is there.
  std::size_t word(const std::string& key, const std::vector<std::string>& words) const;
  /// Index of a name in a list, for references to shapes and materials.
  std::int32_t reference(const std::string& key, const std::vector<std::string>& names, const std::string& kind) const;
  std::int32_t find_name(const std::string& key, const std::string& name, const std::vector<std::string>& names,
                         const std::string& kind) const;

  CaseTable table(const std::string& key, const std::vector<std::string>& keys) const;
  /// [[key]] tables, none when the key is absent.
  std::vector<CaseTable> tables(const std::string& key, const std::vector<std::string>& keys) const;
  /// [key.NAME] tables with their names, in alphabetical order.
  std::vector<std::pair<std::string, CaseTable>> named_tables(const std::string& key, const std::vector<std::string>& keys) const;
  /// Keys that the table holds, in alphabetical order, with the values as numbers without unit: { fels = 0.7 }.
  std::vector<std::pair<std::string, double>> named_numbers(const std::string& key, Range range) const;
  /// The same with texts: { stone = "wet stone" }.
  std::vector<std::pair<std::string, std::string>> named_texts(const std::string& key) const;
  /// The one of these keys that the table holds; throws when there is none or more than one.
  std::string only_one_of(const std::vector<const char*>& keys) const;

 private:
  const toml::node& node(const std::string& key) const;
  /// Throws UsageError for a key that is not there.
  void require(const std::string& key, std::string_view expected) const;
  const toml::array& array(const std::string& key, std::size_t size, const std::string& expected) const;
  double number_of(const toml::node& value, const std::string& key, Dimension dimension) const;
  Vec3 vector_of(const toml::node& value, const std::string& key, Dimension dimension) const;
  std::string text_of(const toml::node& value, const std::string& key) const;
  void check_range(const std::string& key, double value, Range range) const;
  /// Throws UsageError for a name of the user's choice, a key of this table, that cannot be one.
  void check_name(const std::string& name) const;
  UsageError wrong_type(const std::string& key, const std::string& expected) const;

  const toml::table* table_;
  std::string file_, path_;
};

}  // namespace scree
