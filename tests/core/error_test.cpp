#include "isopath/core/error.h"

#include <gtest/gtest.h>

namespace isopath {
namespace {

TEST(Error, MessageNamesFileElementValueAndAdvice) {
  const Error error(ErrorCode::bad_input, "vertex index out of range",
                    {.file = "part.off", .element = "line 12", .value = "99 of 8", .advice = "export it again"});
  EXPECT_STREQ(error.what(), "part.off: line 12: vertex index out of range (99 of 8)\n  export it again");
}

TEST(Error, InFileFillsInOnlyAnUnknownFile) {
  const Error bare(ErrorCode::bad_input, "broken", {.element = "line 1"});
  EXPECT_EQ(bare.in_file("a.stl").where().file, "a.stl");
  EXPECT_EQ(bare.in_file("a.stl").in_file("b.stl").where().file, "a.stl");
}

}  // namespace
}  // namespace isopath
