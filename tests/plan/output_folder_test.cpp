#include "isopath/plan/output_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/plan/plan_outputs.h"

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

TEST_F(OutputFolder, KeepsAFolderThatIsInTheWayOfAFile) {
  write_file_atomically(root_ / "a.csv", "old");
  write_file_atomically(root_ / "b.json/notes.txt", "mine");
  EXPECT_THROW(write_output_folder(root_, files_), Error);
  EXPECT_EQ(names_in(root_), (Names{"a.csv", "b.json"}));
  EXPECT_EQ(read_whole_file(root_ / "a.csv"), "old");
  EXPECT_EQ(read_whole_file(root_ / "b.json/notes.txt"), "mine");
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

/// Stops at its nth checkpoint.
class StopsLater final : public Progress {
 public:
  explicit StopsLater(int n) : left_(n) {}
  bool cancelled() const override { return --left_ < 0; }

 private:
  mutable int left_;
};

TEST_F(OutputFolder, LeavesNothingWhenItIsCancelledAtAnyPlace) {
  write_output_folder(root_ / "old", files_);
  const std::vector<OutputFile> fresh = {{files_[0].name, "fresh"}, {"another", "fresh"}};
  for (int n = 0; n < 3; ++n) {
    StopsLater into_new(n);
    EXPECT_THROW(write_output_folder(root_ / "new", fresh, into_new), Error);
    StopsLater into_old(n);
    EXPECT_THROW(write_output_folder(root_ / "old", fresh, into_old), Error);
    EXPECT_EQ(std::distance(fs::directory_iterator(root_), {}), 1);
    EXPECT_EQ(std::distance(fs::directory_iterator(root_ / "old"), {}), static_cast<std::ptrdiff_t>(files_.size()));
    EXPECT_EQ(read_whole_file(root_ / "old" / files_[0].name), files_[0].content);
  }
}

TEST_F(OutputFolder, NamesProgramsOfEarlierRunsAndNothingElse) {
  EXPECT_TRUE(earlier_programs(root_ / "none", {}).empty());
  for (const char* name : {"program_gcode3.ngc", "program_gcode5.ngc", "program_mine.ngc", "notes.txt"}) {
    write_file_atomically(root_ / name, "");
  }
  EXPECT_EQ(earlier_programs(root_, {{"program_gcode5.ngc", ""}}), (Names{"program_gcode3.ngc"}));
}

TEST_F(OutputFolder, IsCheckedBeforehandWithoutChangingAnything) {
  check_output_folder(root_ / "x/y/");
  check_output_folder(root_);
  check_output_folder("name");
  EXPECT_FALSE(fs::exists(root_ / "x"));
  write_output_folder(root_ / "old", files_);
  EXPECT_THROW(check_output_folder(root_ / "old" / files_[0].name), Error);
  EXPECT_THROW(check_output_folder(root_ / "old" / files_[0].name / "below/that"), Error);
  EXPECT_THROW(check_output_folder(root_ / "y" / std::string(300, 'n') / "z"), Error);
  EXPECT_EQ(names_in(root_), (Names{"old"}));
  EXPECT_EQ(names_in(root_ / "old"), (Names{"a.csv", "b.json"}));
}

TEST_F(OutputFolder, AFileIsCheckedBeforehandWithoutChangingAnything) {
  EXPECT_FALSE(obstacle_to_writing("name.csv"));
  EXPECT_FALSE(obstacle_to_writing(root_ / "x/y/a.csv"));
  EXPECT_TRUE(fs::is_empty(root_));
  write_file_atomically(root_ / "a.csv", "old");
  fs::create_directory(root_ / "folder");
  EXPECT_FALSE(obstacle_to_writing(root_ / "a.csv"));
  EXPECT_FALSE(obstacle_to_writing(root_ / "folder/a.csv"));
  EXPECT_EQ(obstacle_to_writing(root_ / "folder"), std::errc::is_a_directory);
  EXPECT_EQ(obstacle_to_writing(root_ / "a.csv/b.csv"), std::errc::not_a_directory);
  EXPECT_EQ(obstacle_to_writing(root_ / "x" / std::string(300, 'n') / "a.csv"), std::errc::filename_too_long);
  EXPECT_THROW(check_writable(root_ / "folder"), Error);
  EXPECT_EQ(names_in(root_), (Names{"a.csv", "folder"}));
  EXPECT_TRUE(fs::is_empty(root_ / "folder"));
  EXPECT_EQ(read_whole_file(root_ / "a.csv"), "old");
}

TEST_F(OutputFolder, DevicesAreWrittenToAndStay) {
  fs::create_symlink("/dev/null", root_ / "sink");
  EXPECT_FALSE(obstacle_to_writing(root_ / "sink"));
  write_file_atomically(root_ / "sink", "gone");
  EXPECT_TRUE(fs::is_symlink(root_ / "sink"));
  EXPECT_EQ(names_in(root_), (Names{"sink"}));
}

}  // namespace
}  // namespace isopath
