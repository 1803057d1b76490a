#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "isopath/core/error.h"

namespace isopath {

/// Walks over the lines and words of a text that is already in memory; every mesh reader for text uses it.
/// Lines end with LF, CR LF or CR; words are separated by blanks; a comment character hides the rest of its line.
/// Errors name the line.
class TextScanner {
 public:
  /// `comment` = 0: the format has no comments.
  explicit TextScanner(std::string_view text, char comment = 0) : text_(text), comment_(comment) {}

  /// Goes to the next line that holds a word. False at the end of the text.
  bool next_line();
  /// The next word of the current line, empty at the line's end.
  std::string_view word();
  /// The next word, in whatever line it is; empty at the end of the text.
  std::string_view next_word();
  /// Leaves the rest of the current line unread.
  void skip_line() { cursor_ = line_end_; }
  /// The unread rest of the current line.
  std::string_view rest_of_line() const { return text_.substr(cursor_, line_end_ - cursor_); }

  /// The next word of the current line as a number; nan, inf and values out of the range of double are numbers too.
  /// `what` is named in the error when the word is missing or is no number.
  double number(std::string_view what) { return to_number(word(), what); }
  long long integer(std::string_view what) { return to_integer(word(), what); }
  double to_number(std::string_view word, std::string_view what) const;
  long long to_integer(std::string_view word, std::string_view what) const;

  /// Number of the current line, from 1.
  std::size_t line() const { return line_; }
  /// Offset of the first byte after the current line.
  std::size_t next_line_offset() const { return next_line_; }
  std::size_t bytes_left() const { return text_.size() - next_line_; }

  /// Throws Error(bad_input) about the current line.
  [[noreturn]] void fail(std::string summary, std::string_view value, std::string advice) const;

 private:
  std::string_view text_;
  char comment_;
  std::size_t cursor_ = 0;
  std::size_t line_end_ = 0;
  std::size_t next_line_ = 0;
  std::size_t line_ = 0;
};

/// The value as it may stand in an error message: printable, and short.
std::string shown(std::string_view value);

}  // namespace isopath
