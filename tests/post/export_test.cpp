#include "isopath/post/export.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "isopath/core/error.h"
#include "post/test_paths.h"

namespace isopath {
namespace {

TEST(Export, EveryFormatOfTheListWritesAndNoTwoTheSame) {
  const ToolPath path = test::full_path(test::wavy_zigzag(), AxisMode::fixed_direction);
  std::set<std::string> texts;
  for (const ExportFormat& format : export_formats()) {
    EXPECT_TRUE(texts.insert(export_tool_path(path, format.name)).second) << format.name;
  }
  EXPECT_GE(texts.size(), 5U);
}

TEST(Export, AnUnknownFormatIsRefusedWithTheListOfThem) {
  try {
    export_tool_path({}, "apt");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_usage);
    for (const ExportFormat& format : export_formats()) {
      EXPECT_NE(error.where().advice.find(format.name), std::string::npos) << format.name;
    }
  }
}

}  // namespace
}  // namespace isopath
