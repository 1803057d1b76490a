#include "isopath/post/base64.h"

#include <bit>
#include <cstddef>
#include <string_view>
#include <vector>

namespace isopath {
namespace {

constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string encode(std::span<const std::uint8_t> bytes) {
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  char* out = text.data();
  std::size_t i = 0;
  const auto put = [&](std::uint32_t group, int letters) {
    for (int k = 0; k < letters; ++k) out[k] = alphabet[group >> (18 - 6 * k) & 63];
    out += 4;
  };
  for (; i + 3 <= bytes.size(); i += 3)
    put(std::uint32_t{bytes[i]} << 16 | std::uint32_t{bytes[i + 1]} << 8 | bytes[i + 2], 4);
  if (bytes.size() - i == 1) put(std::uint32_t{bytes[i]} << 16, 2);
  if (bytes.size() - i == 2) put(std::uint32_t{bytes[i]} << 16 | std::uint32_t{bytes[i + 1]} << 8, 3);
  return text;
}

/// The bytes of four-byte words, the lowest first on any machine.
template <typename Word>
std::vector<std::uint8_t> bytes_of(std::span<const Word> words) {
  std::vector<std::uint8_t> bytes(4 * words.size());
  std::uint8_t* out = bytes.data();
  for (const Word value : words) {
    const auto word = std::bit_cast<std::uint32_t>(value);
    for (int k = 0; k < 4; ++k) out[k] = static_cast<std::uint8_t>(word >> (8 * k));
    out += 4;
  }
  return bytes;
}

}  // namespace

std::string base64_of(std::span<const float> values) { return encode(bytes_of(values)); }
std::string base64_of(std::span<const std::uint32_t> values) { return encode(bytes_of(values)); }

}  // namespace isopath
