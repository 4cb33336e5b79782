// Words for the values of an enum: one table beside the enum, which readers, writers, messages, schema and pages share.
#pragma once

#include <algorithm>
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
  const auto& words = kWordsOf<E>;
  const auto found = std::find_if(words.begin(), words.end(), [&](const Word<E>& w) { return w.value == value; });
  SCREE_ASSERT(found != words.end(), "value {} has no word", static_cast<long long>(value));
  return found->word;
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
