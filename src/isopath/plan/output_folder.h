#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace isopath {

/// A file of a result folder, as text or bytes.
struct OutputFile {
  std::string name;  ///< within the folder, without subfolders
  std::string content;
};

/// Writes all the files into a folder, or none: they are written to a temporary folder on the same disk first and then
/// moved into place. Missing folders are made; files of the folder that are not among `files` stay. When a file cannot
/// be moved into place, those already moved are taken back. Throws Error(bad_input) naming the path.
void write_output_folder(const std::filesystem::path& folder, std::span<const OutputFile> files);

}  // namespace isopath
