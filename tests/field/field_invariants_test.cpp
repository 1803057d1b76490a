// Checks of the windows that an exact field keeps: sound fields pass, and each kind of fault is noticed.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/exact_field_data.h"
#include "isopath/field/field_invariants.h"
#include "support/random_sources.h"
#include "support/test_meshes.h"

namespace isopath::test {
namespace {

/// An edge of length 4 with three fronts: the first and the last from one source below the edge, between them a
/// straight one.
struct Sample {
  EdgeOfField edge{.edge = 7, .halfedge = 12, .twin = 20, .length = 4, .size = 10, .n_roots = 2};
  std::vector<Window> windows;

  Sample() {
    Window left;
    left.begin = 0;
    left.end = 1;
    left.source = Vec2(1, -2);
    left.offset = 0.5;
    left.halfedge = 12;
    left.root = 0;
    Window middle = left;
    middle.kind = Window::Kind::line;
    middle.begin = 1;
    middle.end = 3;
    middle.source = Vec2(0, 1);
    middle.offset = left.distance(1);
    middle.root = 1;
    Window right = left;
    right.begin = 3;
    right.end = 4;
    right.source.x() = 3;
    windows = {left, middle, right};
    edge.distance_at_start = left.distance(0);
    edge.distance_at_end = right.distance(4);
  }

  /// What the check says, empty when nothing.
  std::string complaint() const {
    try {
      verify_edge_windows(edge, windows);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::internal);
      EXPECT_NE(error.where().element.find("edge 7"), std::string::npos);
      return error.summary();
    }
    return {};
  }
};

TEST(FieldInvariants, SoundWindowsPass) {
  Sample sample;
  EXPECT_EQ(sample.complaint(), "");
  sample.windows[1].end = sample.windows[2].begin = 3 - 1e-12;  // a snap width aside
  EXPECT_EQ(sample.complaint(), "");
}

struct Fault {
  std::string word;  ///< in the complaint
  std::function<void(Sample&)> make;
};

class FieldInvariantsFault : public testing::TestWithParam<Fault> {};

TEST_P(FieldInvariantsFault, IsNoticed) {
  Sample sample;
  GetParam().make(sample);
  EXPECT_NE(sample.complaint().find(GetParam().word), std::string::npos) << "'" << sample.complaint() << "'";
}

INSTANTIATE_TEST_SUITE_P(All, FieldInvariantsFault,
                         testing::Values(Fault{"gap", [](Sample& s) { s.windows[1].begin += 1e-9; }},
                                         Fault{"gap", [](Sample& s) { s.windows.erase(s.windows.begin()); }},
                                         Fault{"overlap", [](Sample& s) { s.windows[0].end += 1e-9; }},
                                         Fault{"gap", [](Sample& s) { s.windows.pop_back(); }},
                                         Fault{"no windows", [](Sample& s) { s.windows.clear(); }},
                                         Fault{"empty", [](Sample& s) { s.windows[1].end = s.windows[1].begin; }},
                                         Fault{"ahead", [](Sample& s) { s.windows[0].source.y() = 2; }},
                                         Fault{"ahead", [](Sample& s) { s.windows[0].halfedge = 20; }},
                                         Fault{"ahead", [](Sample& s) { s.windows[1].source.y() = -1; }},
                                         Fault{"elsewhere", [](Sample& s) { s.windows[2].halfedge = 13; }},
                                         Fault{"unit", [](Sample& s) { s.windows[1].source.y() = 1 + 1e-6; }},
                                         Fault{"root", [](Sample& s) { s.windows[1].root = 2; }},
                                         Fault{"root", [](Sample& s) { s.windows[1].root = no_index; }},
                                         Fault{"impossible", [](Sample& s) { s.windows[0].offset = -3; }},
                                         Fault{"impossible", [](Sample& s) { s.windows[2].source.x() = infinity; }},
                                         Fault{"meet", [](Sample& s) { s.windows[1].offset += 1e-6; }},
                                         Fault{"vertex", [](Sample& s) { s.edge.distance_at_start += 1e-6; }},
                                         Fault{"vertex", [](Sample& s) { s.edge.distance_at_end = infinity; }}));

TEST(FieldInvariants, UnreachedEdgesHaveNoWindows) {
  Sample sample;
  sample.windows.clear();
  sample.edge.distance_at_start = sample.edge.distance_at_end = infinity;
  EXPECT_EQ(sample.complaint(), "");
}

TEST(FieldInvariants, OneWrongWindowOfAFieldIsNoticedWithinItsReachOnly) {
  const TriangleMesh mesh = wavy_sheet(12, 100, 10, 0.1, 0.08, 3);
  SourceSet sources;
  sources.add_vertex(mesh, 0);
  for (const double stop : {infinity, 60.0}) {
    const ExactField field = ExactField::compute(mesh, sources, {.stop_distance = stop});
    field.verify();
    int noticed = 0;
    int passed_over = 0;
    for (Index e = 0; e < mesh.n_edges(); ++e) {
      ExactFieldData damaged = field.data();
      const std::span<Window> windows = damaged.windows.of(e);
      if (windows.empty()) continue;
      windows.front().offset += 1e-3;
      const Index h = mesh.halfedge_of(e);
      const double nearer = std::min(field.value_at_vertex(mesh.from(h)), field.value_at_vertex(mesh.to(h)));
      bool notices = false;
      try {
        verify_windows(damaged);
      } catch (const Error&) {
        notices = true;
      }
      EXPECT_FALSE(notices && nearer > stop) << "edge " << e;
      EXPECT_TRUE(notices || nearer + 3 * mesh.edge_length(e) >= stop) << "edge " << e;
      ++(notices ? noticed : passed_over);
    }
    EXPECT_GT(noticed, 20);
    EXPECT_EQ(passed_over > 0, stop < infinity);
  }
}

TEST(FieldInvariants, ExactFieldsKeepThem) {
  const TriangleMesh meshes[] = {planar_grid(20, 20, 20, 20), cube(4, 2),
                                 torus(24, 12, 3, 1),         wavy_sheet(20, 100, 10, 0.1, 0.08, 3),
                                 saddle_cone(40, 1, 8),       notched_square(7)};
  for (const TriangleMesh& mesh : meshes) {
    Rng rng(11);
    for (int k = 0; k < 4; ++k) {
      const SourceSet sources = random_sources(rng, mesh, 4);
      EXPECT_NO_THROW(ExactField::compute(mesh, sources).verify());
      EXPECT_NO_THROW(ExactField::compute(mesh, sources, {.accuracy = 1e-6 * mesh.size()}).verify());
    }
  }
}

}  // namespace
}  // namespace isopath::test
