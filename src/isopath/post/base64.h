#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace isopath {

/// Base64 (RFC 4648, with padding) of the numbers as little-endian 32-bit words.
std::string base64_of(std::span<const float> values);
std::string base64_of(std::span<const std::uint32_t> values);

}  // namespace isopath
