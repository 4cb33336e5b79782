// Sections of a case as functions that visit their keys (core/storage/keys.hpp): the same function reads a section with its errors, and
// describes it for the schema and CASE.md. After its entries, a section checks what no single key can, where it is read:
//
//   k.tables({"bodies"}, [&](CaseKeys& k) {
//     CaseBody b;
//     k.vector({"position", kRequired, "of the centre of mass"}, b.position, Dimension::length);
//     if (const CaseTable* t = k.table()) { ... throw t->error("position", "..."); c.bodies.push_back(b); }
//   });
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/storage/keys.hpp"
#include "decomposer/case/case_table.hpp"

namespace scree {

class CaseKeys : public KeyVisitor {
 public:
  using Section = std::function<void(CaseKeys&)>;

  /// The table that is read; null where the language is described, so that nothing may be checked or kept.
  virtual const CaseTable* table() const = 0;
  /// Keys that the table has and that were not visited.
  virtual std::vector<std::string> left_over() const = 0;
  /// One of these keys must be there, and one only. Returns which; "" where the language is described.
  virtual std::string one_of(const std::vector<const char*>& keys) = 0;

  virtual void integer(const Key& key, std::int64_t& value, std::int64_t smallest) = 0;
  /// A path; relative ones start from the folder of the case.
  virtual void path(const Key& key, std::string& value) = 0;
  virtual void texts(const Key& key, std::vector<std::string>& values) = 0;
  /// A word that stands for itself, beside other types of value.
  virtual void only_word(const Key& key, const char* word) = 0;
  /// Some of these words.   in/out  chosen   one for each
  virtual void some_of(const Key& key, std::vector<bool>& chosen, const std::vector<std::string>& words, const char* kind) = 0;
  /// Index of a name.   in   kind   what is named, for messages
  virtual void reference(const Key& key, std::int32_t& index, const std::vector<std::string>& names, const char* kind) = 0;
  /// A unit quaternion [w, x, y, z].
  virtual void orientation(const Key& key, Quat& value) = 0;
  /// [[x, y, z], [x, y, z]], lower below upper
  virtual void corners(const Key& key, Vec3& lower, Vec3& upper) = 0;
  /// { NAME = number, ... }, at least one
  virtual void named_numbers(const Key& key, std::vector<std::pair<std::string, double>>& values, Range range) = 0;
  /// { NAME = "TEXT", ... }, at least one
  virtual void named_texts(const Key& key, std::vector<std::pair<std::string, std::string>>& values) = 0;

  /// [key], visited when it is there.
  virtual void section(const Key& key, const Section& keys) = 0;
  /// [[key]], each
  virtual void sections(const Key& key, const Section& keys) = 0;
  /// key = [{ ... }, ...], where section() describes what each of them says
  virtual void section_list(const Key& key, const Section& keys) = 0;
  /// [key.NAME], each in alphabetical order
  virtual void named_sections(const Key& key, const std::function<void(CaseKeys&, const std::string& name)>& keys) = 0;
};

/// One entry as it is described. A key whose value may be of several types has as many, one after the other.
struct KeyDescription {
  std::string table;    ///< "pairs[]", "materials.*", "walls[].shape"; "" for the whole file
  std::string key;      ///< "" for a choice
  std::string type;     ///< number, text, word, vector, table ...; one_of: a choice, of which `words` are the keys
  Dimension dimension;  ///< of numbers and vectors
  Range range;          ///< of numbers
  std::vector<std::string> words;
  std::string otherwise, meaning;
};

/// All that a section says, and the sections in it.
std::vector<KeyDescription> describe_keys(const CaseKeys::Section& keys);

/// Reads the whole file.   in   folder   that relative paths start from, "" for the present one
/// Throws UsageError for an unknown key, a missing one, a wrong type, unit or range.
void read_keys(const toml::table& file, const std::string& name, const std::string& folder, const CaseKeys::Section& keys);

}  // namespace scree
