// Words, numbers and lines of a text mesh file, with the line for messages.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace scree {

/// Reads a text that the caller keeps alive. Lines end with LF, CR LF or CR; numbers are read in double precision, whatever the
/// locale.
/// in   comment   begins a comment that lasts to the end of the line; '\0': the format has none
/// in   joint     at the end of a line joins the next one to it; '\0': the format has none
class TextReader {
 public:
  /// in   first_line   number of the text's first line in its file
  TextReader(std::string_view text, std::string path, char comment, char joint = '\0', std::int64_t first_line = 1)
      : text_(text), path_(std::move(path)), comment_(comment), joint_(joint), line_(first_line), line_of_word_(first_line) {}

  /// Whether no word follows.
  bool at_end();
  /// Whether the next word is the first of its line, or none follows.
  bool at_line_start();
  /// The next word.   Fails: InputError with `what` at the end of the file.
  std::string_view word(const char* what);
  /// The words that are left of the line in which the next word stands; empty at the end. Overwritten by the next call.
  const std::vector<std::string_view>& rest_of_line();
  double number(const char* what) { return number_of(word(what), what); }
  std::int64_t integer(const char* what) { return integer_of(word(what), what); }

  /// Fail: InputError that names the line of the last word.
  double number_of(std::string_view word, const char* what) const;
  std::int64_t integer_of(std::string_view word, const char* what) const;

  /// Line of the last word, from 1.
  std::int64_t line() const { return line_of_word_; }
  /// Bytes that have not been read.
  std::size_t left() const { return text_.size() - at_; }

  /// "rock.off, line 12"
  std::string place() const { return fmt::format("{}, line {}", path_, line_of_word_); }

 private:
  void skip_blanks();
  void next_line();
  std::string_view take_word();

  std::string_view text_;
  std::string path_;
  char comment_, joint_;
  std::size_t at_ = 0;
  std::int64_t line_, line_of_word_;
  bool is_line_start_ = true;
  std::vector<std::string_view> words_;
};

/// What a message shows of a word: its beginning, without control characters.
std::string shown_word(std::string_view word, std::size_t most = 24);

/// A text in UTF-16, by its first two bytes, with what is not ASCII made '?'; any other text without a UTF-8 mark at its start.
std::string plain_text(std::vector<char> bytes);

}  // namespace scree
