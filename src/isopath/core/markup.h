#pragma once

#include <string>
#include <string_view>

namespace isopath {

/// Text as it has to be written in XML and HTML, between tags or inside a double-quoted attribute.
std::string markup_escaped(std::string_view text);

}  // namespace isopath
