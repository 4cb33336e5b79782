// Words for the values of an enum: one table beside the enum, which readers, writers, messages, schema and pages share.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace scree {

template <class E>
struct Word {
  E value;
  const char* word;
};

/// The words of an enum, in the order in which messages list them: to be specialised beside the enum, with every value once.
///   template <> inline constexpr auto kWordsOf<Drag> = std::to_array<Word<Drag>>({{Drag::stokes, "stokes"}, ...});
template <class E>
inline constexpr std::array<Word<E>, 0> kWordsOf{};

template <class E>
const char* word_of(E value) {
  for (const Word<E>& w : kWordsOf<E>) {
    if (w.value == value) return w.word;
  }
  SCREE_ASSERT(false, "value {} has no word", static_cast<long long>(value));
  return "?";
}

/// The value that a word stands for; none for an unknown word.
template <class E>
std::optional<E> value_of(std::string_view word) {
  for (const Word<E>& w : kWordsOf<E>) {
    if (word == w.word) return w.value;
  }
  return {};
}

/// "fixed, quantised"
template <class E>
std::string list_of_words() {
  std::string list;
  for (const Word<E>& w : kWordsOf<E>) list += (list.empty() ? "" : ", ") + std::string(w.word);
  return list;
}

}  // namespace scree
