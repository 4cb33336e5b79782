#include "mesher/io/text_reader.hpp"

#include <charconv>
#include <cstdlib>

namespace scree {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0'; }
bool is_line_end(char c) { return c == '\n' || c == '\r'; }

}  // namespace

std::string shown_word(std::string_view word, std::size_t most) {
  std::string text(word.substr(0, most));
  for (char& c : text) {
    if (c < 32 || c > 126) c = '?';
  }
  return word.size() > most ? text + "..." : text;
}

void TextReader::next_line() {
  if (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++at_;
  ++at_;
  ++line_;
  is_line_start_ = true;
}

void TextReader::skip_blanks() {
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (is_line_end(c)) {
      next_line();
    } else if (comment_ != '\0' && c == comment_) {
      while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
    } else if (joint_ != '\0' && c == joint_ && at_ + 1 < text_.size() && is_line_end(text_[at_ + 1])) {
      const bool was_start = is_line_start_;
      ++at_;
      next_line();
      is_line_start_ = was_start;
    } else if (is_blank(c)) {
      ++at_;
    } else {
      return;
    }
  }
  is_line_start_ = true;
}

bool TextReader::at_end() {
  skip_blanks();
  return at_ == text_.size();
}

bool TextReader::at_line_start() {
  skip_blanks();
  return is_line_start_;
}

std::string_view TextReader::take_word() {
  const std::size_t start = at_;
  const auto ends = [&](char c) {
    return is_blank(c) || is_line_end(c) || (comment_ != '\0' && c == comment_) ||
           (joint_ != '\0' && c == joint_ && at_ + 1 < text_.size() && is_line_end(text_[at_ + 1]));
  };
  while (at_ < text_.size() && !ends(text_[at_])) ++at_;
  line_of_word_ = line_;
  is_line_start_ = false;
  return text_.substr(start, at_ - start);
}

std::string_view TextReader::word(const char* what) {
  if (at_end()) {
    throw InputError("{}: the file ends at line {} where {} is expected; it is truncated or damaged: export the model again", path_, line_,
                     what);
  }
  return take_word();
}

const std::vector<std::string_view>& TextReader::rest_of_line() {
  words_.clear();
  while (!at_end() && (words_.empty() || !is_line_start_)) words_.push_back(take_word());
  return words_;
}

double TextReader::number_of(std::string_view word, const char* what) const {
  std::string_view digits = word;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (fault == std::errc::result_out_of_range) return std::strtod(std::string(digits).c_str(), nullptr);  // 0 or infinite
  if (fault != std::errc{} || end != digits.data() + digits.size())
    throw InputError("{}: '{}' is no number; expected {}", place(), shown_word(word), what);
  return value;
}

std::int64_t TextReader::integer_of(std::string_view word, const char* what) const {
  std::string_view digits = word;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (fault != std::errc{} || end != digits.data() + digits.size())
    throw InputError("{}: '{}' is not a whole number; expected {}", place(), shown_word(word), what);
  return value;
}

std::string plain_text(std::vector<char> bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  if (bytes.size() >= 3 && byte(0) == 0xef && byte(1) == 0xbb && byte(2) == 0xbf) return {bytes.begin() + 3, bytes.end()};
  if (bytes.size() < 2 || (byte(0) ^ byte(1)) != (0xff ^ 0xfe) || (byte(0) != 0xff && byte(0) != 0xfe)) return {bytes.begin(), bytes.end()};
  const std::size_t low = byte(0) == 0xff ? 0 : 1;  // of two bytes
  std::string text;
  for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
    const bool is_ascii = byte(i + 1 - low) == 0 && byte(i + low) < 128;
    text += is_ascii ? bytes[i + low] : '?';
  }
  return text;
}

}  // namespace scree
