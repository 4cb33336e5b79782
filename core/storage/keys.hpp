// Keys of the case language. One entry for each key states its name, type, unit, range, default and meaning, and names the member that
// it fills; whoever visits the entries reads a case, reads or writes a scene file, or describes the language (schema, CASE.md):
//
//   void time_keys(KeyVisitor& k, Settings& s) {
//     k.number({"duration", kRequired, "of the simulation"}, s.duration, Dimension::time, Range::not_negative);
//
// A new key of the case that the solver reads is one such entry (scene_keys.cpp) and the member. Keys that only the decomposer needs are
// beside it, in decomposer/case.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/units.hpp"
#include "core/base/words.hpp"
#include "core/geometry/vec3.hpp"

namespace scree {

/// Range that a number must lie in.
enum class Range { any, positive, not_negative, unit_interval, fraction };

/// As a default: there is none, the key must be there.
inline constexpr const char* kRequired = "required";

/// What a scene file keeps of a key.
struct InFile {
  const char* name = nullptr;  ///< where it is not that of the case
  /// Every file of version 1 has it, so that one without it is damaged. Without this, a file that lacks the key was written before there
  /// was one, and means the default.
  bool always = false;
};
inline constexpr InFile kAlways{nullptr, true};

/// What an entry states beside the value itself. Texts are those of CASE.md, with its marks.
struct Key {
  const char* name;
  const char* otherwise = "";  ///< what holds when it is absent: a text, kRequired, or "" for the value that the member has
  const char* meaning = "";
  InFile in_file = {};
  bool needed = false;  ///< must be there in this case, though not in every one
};

class KeyVisitor {
 public:
  virtual ~KeyVisitor() = default;

  /// `value` holds the default before the visit, [SI].
  virtual void number(const Key& key, double& value, Dimension dimension, Range range) = 0;
  virtual void count(const Key& key, std::uint64_t& value) = 0;
  virtual void boolean(const Key& key, bool& value) = 0;
  virtual void text(const Key& key, std::string& value) = 0;
  virtual void vector(const Key& key, Vec3& value, Dimension dimension) = 0;
  /// A vector that is not zero; its length means nothing. `value` is unit.
  virtual void direction(const Key& key, Vec3& value) = 0;
  /// A vector [m/s], kept as its length and its direction (unit; unchanged when the length is 0).
  virtual void velocity(const Key& key, double& speed, Vec3& direction) = 0;
  virtual void numbers(const Key& key, std::vector<double>& values, Dimension dimension) = 0;
  virtual void vectors(const Key& key, std::vector<Vec3>& values, Dimension dimension) = 0;
  /// Some of the axes x, y, z.
  virtual void axes(const Key& key, std::array<bool, 3>& value) = 0;
  /// One of the words of an enum.
  template <class E>
  void word(const Key& key, E& value) {
    std::vector<std::string> words;
    std::size_t index = 0;
    for (const Word<E>& w : kWordsOf<E>) {
      if (w.value == value) index = words.size();
      words.emplace_back(w.word);
    }
    choose(key, index, words);
    value = kWordsOf<E>[index].value;
  }

  /// Whether keys that are there under a condition only are visited now: where the language is described, all are.
  virtual bool when(bool condition) { return condition; }

 protected:
  /// in/out  index   into the words
  virtual void choose(const Key& key, std::size_t& index, const std::vector<std::string>& words) = 0;
};

}  // namespace scree
