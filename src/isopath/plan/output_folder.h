#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "isopath/core/progress.h"

namespace isopath {

/// A file of a result folder, as text or bytes.
struct OutputFile {
  std::string name;  ///< within the folder, without subfolders
  std::string content;
};

/// Writes all the files into a folder, or none: they are written to a temporary folder on the same disk first and then
/// moved into place. Missing folders are made; what else the folder holds stays, and a folder with the name of
/// one of the files is an error. When a file cannot
/// be moved into place, those already moved are taken back. Throws Error(bad_input) naming the path, and
/// Error(cancelled) on request as long as nothing was moved.
void write_output_folder(const std::filesystem::path& folder, std::span<const OutputFile> files,
                         Progress& progress = Progress::none());

/// Throws Error(bad_input) when `write_output_folder` would fail for a reason that can be seen beforehand: the folder
/// is a file, lies below one, or cannot be made or written to, which is tried. Leaves nothing behind.
void check_output_folder(const std::filesystem::path& folder);

}  // namespace isopath
