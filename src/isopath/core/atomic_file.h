#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace isopath {

/// Writes a file whole or not at all: into a temporary file beside it, flushed, then renamed over it.
/// Devices and pipes are written to as they are. Missing parent folders are made. Throws Error(bad_input) naming the
/// path when it cannot be written.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Why `write_file_atomically` could not write this file now; no error where it could. Tries it: makes the missing
/// folders and an empty file beside the path, and takes them away again.
std::error_code obstacle_to_writing(const std::filesystem::path& path);
/// Throws what `write_file_atomically` would: for the time before long work whose result goes there.
void check_writable(const std::filesystem::path& path);

/// Reads a whole file. Throws Error(bad_input) naming the path when it is missing, unreadable or a folder.
std::string read_whole_file(const std::filesystem::path& path);

}  // namespace isopath
