#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace isopath {

/// Writes a file whole or not at all: into a temporary file beside it, flushed, then renamed over it.
/// Missing parent folders are made. Throws Error(bad_input) naming the path when it cannot be written.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Reads a whole file. Throws Error(bad_input) naming the path when it is missing, unreadable or a folder.
std::string read_whole_file(const std::filesystem::path& path);

}  // namespace isopath
