#include "isopath/core/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "isopath/core/error.h"

namespace isopath {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& action, int error) {
  throw Error(ErrorCode::bad_input, action + ": " + std::strerror(error),
              {.file = path.string(), .advice = "check that the path exists and that you may use it"});
}

bool write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
}

std::error_code last_error() { return {errno, std::generic_category()}; }

/// Makes a folder and those above it that are missing; they disappear again.
class TrialFolders {
 public:
  TrialFolders(const std::filesystem::path& folder, std::error_code& error) {
    std::vector<std::filesystem::path> missing;
    std::error_code unknown;  // what cannot be looked at cannot be made either, and that error says more
    for (auto path = folder; !path.empty() && !std::filesystem::exists(path, unknown); path = path.parent_path()) {
      missing.push_back(path);
    }
    for (; !missing.empty() && !error; missing.pop_back()) {
      if (std::filesystem::create_directory(missing.back(), error)) made_.push_back(missing.back());
    }
  }
  TrialFolders(const TrialFolders&) = delete;
  TrialFolders& operator=(const TrialFolders&) = delete;
  ~TrialFolders() {
    std::error_code ignored;
    for (; !made_.empty(); made_.pop_back()) std::filesystem::remove(made_.back(), ignored);
  }

 private:
  std::vector<std::filesystem::path> made_;
};

/// The permissions an ordinary new file gets.
mode_t default_mode() {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return 0666 & ~mask;
}

/// Devices and pipes such as /dev/stdout: renaming a file over them would put an end to them.
bool is_special(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::is_other(path, unknown);
}

void write_special(const std::filesystem::path& path, std::string_view content) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) fail(path, "cannot open", errno);
  const int error = write_all(descriptor, content) ? 0 : errno;
  ::close(descriptor);
  if (error != 0) fail(path, "cannot write", error);
}

}  // namespace

void write_file_atomically(const std::filesystem::path& path, std::string_view content) {
  if (is_special(path)) return write_special(path, content);
  if (path.has_parent_path()) {
    std::error_code error;
    std::filesystem::create_directories(path.parent_path(), error);
    if (error) fail(path, "cannot make its folder", error.value());
  }
  std::string temporary = path.string() + ".XXXXXX";
  const int descriptor = ::mkstemp(temporary.data());
  if (descriptor < 0) fail(path, "cannot write", errno);
  int error = 0;  // the first that occurs
  const auto note = [&](bool good) {
    if (!good && error == 0) error = errno;
  };
  note(write_all(descriptor, content) && ::fchmod(descriptor, default_mode()) == 0);
  note(::close(descriptor) == 0);
  if (error == 0) note(::rename(temporary.c_str(), path.c_str()) == 0);
  if (error != 0) {
    ::unlink(temporary.c_str());
    fail(path, "cannot write", error);
  }
}

std::error_code obstacle_to_writing(const std::filesystem::path& path) {
  if (is_special(path)) return ::access(path.c_str(), W_OK) == 0 ? std::error_code() : last_error();
  std::error_code error;
  const TrialFolders folders(path.parent_path(), error);
  if (error) return error;
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) return std::make_error_code(std::errc::is_a_directory);
  std::string temporary = path.string() + ".XXXXXX";
  const int descriptor = ::mkstemp(temporary.data());
  if (descriptor < 0) return last_error();
  ::close(descriptor);
  ::unlink(temporary.c_str());
  return {};
}

void check_writable(const std::filesystem::path& path) {
  if (const std::error_code error = obstacle_to_writing(path)) fail(path, "cannot write", error.value());
}

std::string read_whole_file(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(path, "cannot open", errno);
  std::string content;
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode))
    content.reserve(static_cast<std::size_t>(status.st_size) + 1);
  constexpr std::size_t block = 1 << 20;
  std::size_t size = 0;
  for (;;) {
    content.resize(size + block);
    const ssize_t got = ::read(descriptor, content.data() + size, block);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      const int error = errno;
      ::close(descriptor);
      fail(path, "cannot read", error);
    }
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  ::close(descriptor);
  content.resize(size);
  return content;
}

}  // namespace isopath
