#include "isopath/mesh/text_scanner.h"

#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

namespace isopath {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

/// std::from_chars leaves the value alone when it does not fit a double: then it is zero or infinite.
double beyond_double(std::string_view digits) {
  const std::size_t exponent = digits.find_first_of("eE");
  const bool tiny = exponent == std::string_view::npos ? digits.find_first_of("123456789") > digits.find('.')
                                                       : digits.substr(exponent + 1).starts_with('-');
  const double magnitude = tiny ? 0.0 : std::numeric_limits<double>::infinity();
  return digits.starts_with('-') ? -magnitude : magnitude;
}

}  // namespace

std::string shown(std::string_view value) {
  constexpr std::size_t longest = 60;
  std::string out;
  for (const char c : value.substr(0, longest)) {
    if (c >= ' ' && c <= '~') {
      out += c;
    } else {
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
  }
  if (value.size() > longest) out += "...";
  return out;
}

bool TextScanner::next_line() {
  while (next_line_ < text_.size()) {
    cursor_ = next_line_;
    const char* begin = text_.data() + cursor_;
    const std::size_t left = text_.size() - cursor_;
    const void* newline = std::memchr(begin, '\n', left);
    std::size_t length =
        newline == nullptr ? left : static_cast<std::size_t>(static_cast<const char*>(newline) - begin);
    std::size_t ending = newline == nullptr ? 0 : 1;
    if (const void* found = std::memchr(begin, '\r', length)) {
      const auto at = static_cast<std::size_t>(static_cast<const char*>(found) - begin);
      ending = at + 1 == length && newline != nullptr ? 2 : 1;
      length = at;
    }
    next_line_ = cursor_ + length + ending;
    if (comment_ != 0) {
      if (const void* found = std::memchr(begin, comment_, length)) {
        length = static_cast<std::size_t>(static_cast<const char*>(found) - begin);
      }
    }
    line_end_ = cursor_ + length;
    ++line_;
    while (cursor_ < line_end_ && is_blank(text_[cursor_])) ++cursor_;
    if (cursor_ < line_end_) return true;
  }
  cursor_ = line_end_ = text_.size();
  return false;
}

std::string_view TextScanner::word() {
  while (cursor_ < line_end_ && is_blank(text_[cursor_])) ++cursor_;
  const std::size_t begin = cursor_;
  while (cursor_ < line_end_ && !is_blank(text_[cursor_])) ++cursor_;
  return text_.substr(begin, cursor_ - begin);
}

std::string_view TextScanner::next_word() {
  for (;;) {
    const std::string_view found = word();
    if (!found.empty() || !next_line()) return found;
  }
}

double TextScanner::to_number(std::string_view word, std::string_view what) const {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty()) fail(fmt::format("{} is missing", what), {}, "the file is cut short or damaged; export it again");
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size()) {
    fail(fmt::format("{} is not a number", what), word, "write a decimal number with a point, such as 12.5");
  }
  return error == std::errc::result_out_of_range ? beyond_double(digits) : value;
}

long long TextScanner::to_integer(std::string_view word, std::string_view what) const {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  long long value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty()) fail(fmt::format("{} is missing", what), {}, "the file is cut short or damaged; export it again");
  if (error != std::errc() || end != digits.data() + digits.size()) {
    fail(fmt::format("{} is not a whole number", what), word, "the line is damaged; export the file again");
  }
  return value;
}

void TextScanner::fail(std::string summary, std::string_view value, std::string advice) const {
  throw Error(ErrorCode::bad_input, std::move(summary),
              {.element = fmt::format("line {}", line_), .value = shown(value), .advice = std::move(advice)});
}

}  // namespace isopath
