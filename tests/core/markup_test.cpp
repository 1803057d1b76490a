#include "isopath/core/markup.h"

#include <gtest/gtest.h>

namespace isopath {
namespace {

TEST(MarkupEscaped, LeavesNothingThatAReaderOfMarkupWouldActOn) {
  EXPECT_EQ(markup_escaped("a < b && \"c\" > d"), "a &lt; b &amp;&amp; &quot;c&quot; &gt; d");
  EXPECT_EQ(markup_escaped("0.3 mm, Öl"), "0.3 mm, Öl");
  EXPECT_EQ(markup_escaped(""), "");
}

}  // namespace
}  // namespace isopath
