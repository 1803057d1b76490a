#include "isopath/plan/output_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"

namespace isopath {
namespace {

namespace fs = std::filesystem;

class OutputFolder : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) / ("isopath_out_" + std::to_string(::getpid()) +
                                            testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  static std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  fs::path root_;
  const std::vector<OutputFile> files_ = {{"a.csv", "1\n"}, {"b.json", "{}"}};
};

using Names = std::vector<std::string>;

TEST_F(OutputFolder, MakesMissingFoldersAndLeavesNothingElse) {
  write_output_folder(root_ / "x/y/", files_);
  EXPECT_EQ(names_in(root_ / "x/y"), (Names{"a.csv", "b.json"}));
  EXPECT_EQ(names_in(root_ / "x"), (Names{"y"}));
  EXPECT_EQ(read_whole_file(root_ / "x/y/a.csv"), "1\n");
}

TEST_F(OutputFolder, KeepsForeignFilesAndReplacesItsOwn) {
  write_file_atomically(root_ / "notes.txt", "mine");
  write_file_atomically(root_ / "a.csv", "old");
  write_output_folder(root_, files_);
  EXPECT_EQ(names_in(root_), (Names{"a.csv", "b.json", "notes.txt"}));
  EXPECT_EQ(read_whole_file(root_ / "a.csv"), "1\n");
  EXPECT_EQ(read_whole_file(root_ / "notes.txt"), "mine");
}

TEST_F(OutputFolder, ThrowsAndChangesNothingWhenAFileCannotBeWritten) {
  write_file_atomically(root_ / "a.csv", "old");
  const std::vector<OutputFile> files = {{"a.csv", "new"}, {std::string(300, 'n'), ""}};
  EXPECT_THROW(write_output_folder(root_, files), Error);
  EXPECT_EQ(names_in(root_), (Names{"a.csv"}));
  EXPECT_EQ(read_whole_file(root_ / "a.csv"), "old");
}

TEST_F(OutputFolder, NamesTheFolderWhenItIsAFile) {
  write_file_atomically(root_ / "file", "");
  try {
    write_output_folder(root_ / "file", files_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_input);
    EXPECT_EQ(error.where().file, (root_ / "file").string());
  }
  EXPECT_THROW(write_output_folder(root_ / "file/below", files_), Error);
}

}  // namespace
}  // namespace isopath
