#pragma once

#include <string_view>

namespace isopath {

/// The viewer as built from web/: the page with its places to fill, the style sheet and the script.
std::string_view viewer_page();
std::string_view viewer_style();
std::string_view viewer_script();

}  // namespace isopath
