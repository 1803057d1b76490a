#include "isopath/plan/output_folder.h"

#include <stdlib.h>  // mkdtemp

#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"

namespace isopath {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what, const std::string& reason) {
  throw Error(ErrorCode::bad_input, what + ": " + reason,
              {.file = path.string(),
               .advice = "check that the folder exists, that you may write to it, and that the disk is not full"});
}

/// A folder that disappears with all it holds unless it was moved away.
class TemporaryFolder {
 public:
  /// Made in `parent`; errors name `wanted`, the folder the person asked for.
  TemporaryFolder(const fs::path& parent, const fs::path& wanted) {
    std::string pattern = (parent / ".isopath.XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) fail(wanted, "cannot write into the folder", std::strerror(errno));
    path_ = pattern;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void write_files(const fs::path& folder, std::span<const OutputFile> files, Progress& progress) {
  fs::create_directory(folder);
  for (const OutputFile& file : files) {
    progress.checkpoint();
    write_file_atomically(folder / file.name, file.content);
  }
  progress.checkpoint();
}

/// Without the slash that a person may have put at its end.
fs::path without_slash(const fs::path& folder) { return folder.has_filename() ? folder : folder.parent_path(); }

fs::path parent_of(const fs::path& folder) { return folder.has_parent_path() ? folder.parent_path() : fs::path("."); }

/// Renames that can be taken back, last first.
class Moves {
 public:
  void move(const fs::path& from, const fs::path& to) {
    fs::rename(from, to);
    done_.push_back({from, to});
  }
  void take_back() noexcept {
    for (; !done_.empty(); done_.pop_back()) {
      std::error_code ignored;
      fs::rename(done_.back().to, done_.back().from, ignored);
    }
  }

 private:
  struct Move {
    fs::path from;
    fs::path to;
  };
  std::vector<Move> done_;
};

void move_into_place(const fs::path& fresh, const fs::path& replaced, const fs::path& folder,
                     std::span<const OutputFile> files) {
  for (const OutputFile& file : files) {
    if (fs::is_directory(fs::symlink_status(folder / file.name)))
      fail(folder / file.name, "cannot write", "a folder is in its place");
  }
  fs::create_directory(replaced);
  Moves moves;
  for (const OutputFile& file : files) {
    const fs::path target = folder / file.name;
    try {
      if (fs::exists(fs::symlink_status(target))) moves.move(target, replaced / file.name);
      moves.move(fresh / file.name, target);
    } catch (const fs::filesystem_error& error) {
      moves.take_back();
      fail(target, "cannot write", error.code().message());
    }
  }
}

}  // namespace

void write_output_folder(const fs::path& folder, std::span<const OutputFile> files, Progress& progress) {
  check_output_folder(folder);
  const fs::path wanted = without_slash(folder);
  const fs::path parent = parent_of(wanted);
  std::error_code error;
  const bool exists = fs::exists(wanted, error);
  if (!exists) fs::create_directories(parent, error);
  if (error) fail(wanted, "cannot make the folder", error.message());

  // Inside a folder that is there, the temporary one is on its disk for certain, even on a mount point.
  const TemporaryFolder temporary(exists ? wanted : parent, wanted);
  const fs::path fresh = temporary.path() / "new";
  try {
    write_files(fresh, files, progress);
  } catch (const Error& inner) {
    if (inner.code() == ErrorCode::cancelled) throw;
    fail(wanted, inner.summary(), inner.where().file);
  }
  if (exists) return move_into_place(fresh, temporary.path() / "old", wanted, files);
  fs::rename(fresh, wanted, error);
  if (error) fail(wanted, "cannot make the folder", error.message());
}

void check_output_folder(const fs::path& folder) {
  const fs::path wanted = without_slash(folder);
  fs::path nearest = wanted;
  std::error_code error;
  while (!fs::exists(nearest, error) && nearest != parent_of(nearest)) nearest = parent_of(nearest);
  if (!fs::is_directory(nearest, error)) {
    if (nearest == wanted) fail(wanted, "cannot write into the folder", "it is a file");
    fail(wanted, "cannot make the folder", nearest.string() + " is not a folder");
  }
  if (const std::error_code obstacle = obstacle_to_writing(wanted / "summary.json"))
    fail(wanted, nearest == wanted ? "cannot write into the folder" : "cannot make the folder", obstacle.message());
}

}  // namespace isopath
