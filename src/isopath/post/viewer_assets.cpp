#include "isopath/post/viewer_assets.h"

#include <cstddef>

// Laid into the library by the assembler (cmake/IsopathViewer.cmake).
extern "C" {
extern const char isopath_viewer_page[];
extern const char isopath_viewer_page_end[];
extern const char isopath_viewer_style[];
extern const char isopath_viewer_style_end[];
extern const char isopath_viewer_script[];
extern const char isopath_viewer_script_end[];
}

namespace isopath {
namespace {

std::string_view between(const char* begin, const char* end) { return {begin, static_cast<std::size_t>(end - begin)}; }

}  // namespace

std::string_view viewer_page() { return between(isopath_viewer_page, isopath_viewer_page_end); }
std::string_view viewer_style() { return between(isopath_viewer_style, isopath_viewer_style_end); }
std::string_view viewer_script() { return between(isopath_viewer_script, isopath_viewer_script_end); }

}  // namespace isopath
