#include "isopath/mesh/sub_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "isopath/mesh/cut_along.h"
#include "isopath/mesh/straight_walk.h"
#include "isopath/mesh/surface_walk.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

/// What splitting promises: every face goes to one part, in its place and joined as before inside the part.
void expect_split(const TriangleMesh& mesh, const std::vector<Index>& label, const std::vector<SubMesh>& parts) {
  std::vector<int> seen(mesh.n_faces(), 0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const SubMesh& part = parts[p];
    ASSERT_EQ(part.mesh.n_faces(), static_cast<Index>(part.face.size()));
    for (Index f = 0; f < part.mesh.n_faces(); ++f) {
      ++seen[part.face[f]];
      EXPECT_EQ(label[part.face[f]], static_cast<Index>(p));
      for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(part.vertex[part.mesh.triangle(f)[i]], mesh.triangle(part.face[f])[i]);
        EXPECT_EQ(part.mesh.position(part.mesh.triangle(f)[i]), mesh.position(mesh.triangle(part.face[f])[i]));
        const Index twin = mesh.twin(3 * part.face[f] + i);
        const bool joined = twin != no_index && label[TriangleMesh::face_of(twin)] == static_cast<Index>(p);
        const Index here = part.mesh.twin(3 * f + i);
        ASSERT_EQ(here != no_index, joined);
        if (!joined) continue;
        EXPECT_EQ(part.face[TriangleMesh::face_of(here)], TriangleMesh::face_of(twin));
      }
    }
  }
  for (const int n : seen) EXPECT_EQ(n, 1);
}

TEST(SubMesh, EveryFaceGoesToItsPart) {
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const TriangleMesh mesh =
        test::random_mesh(rng, {.max_faces = 80, .closed = seed % 2 == 0, .holes = seed % 3 == 0});
    // Random labels make parts that only touch in vertices, with several pieces each.
    std::vector<Index> label(mesh.n_faces());
    for (Index& l : label) l = test::random_index(rng, 3);
    label[0] = 2;
    expect_split(mesh, label, split_mesh(mesh, label));
    std::vector<SubMesh> one_by_one;
    for (Index part = 0; part <= 2; ++part) {
      std::vector<Index> faces;
      for (Index f = 0; f < mesh.n_faces(); ++f) {
        if (label[f] == part) faces.push_back(f);
      }
      one_by_one.push_back(sub_mesh(mesh, faces));
    }
    expect_split(mesh, label, one_by_one);
  }
}

TEST(SubMesh, PartsLieBetweenTheCuts) {
  const TriangleMesh mesh = test::cube(3, 2);
  std::vector<char> cut(mesh.n_edges(), 0);
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    const Index h = mesh.halfedge_of(e);
    cut[e] =
        mesh.face_normal(TriangleMesh::face_of(h)).dot(mesh.face_normal(TriangleMesh::face_of(mesh.twin(h)))) < 0.5;
  }
  const std::vector<Index> part = parts_between_cuts(mesh, cut);
  EXPECT_EQ(*std::max_element(part.begin(), part.end()), 5);
  const std::vector<SubMesh> sides = split_mesh(mesh, part);
  expect_split(mesh, part, sides);
  for (const SubMesh& side : sides) EXPECT_NEAR(side.mesh.area(), 4, 1e-12);
  // Without one edge of a square's rim nothing is separated there.
  cut[static_cast<std::size_t>(std::find(cut.begin(), cut.end(), 1) - cut.begin())] = 0;
  const std::vector<Index> fewer = parts_between_cuts(mesh, cut);
  EXPECT_EQ(*std::max_element(fewer.begin(), fewer.end()), 4);
}

/// The cut edges lie on the lines, are as long as these, and the surface is the same.
void expect_cut(const TriangleMesh& mesh, const std::vector<std::vector<SurfacePoint>>& lines, const CutMesh& cut) {
  const TriangleMesh& fine = cut.refined.mesh;
  const double tolerance = 1e-5 * mesh.size();
  EXPECT_NEAR(fine.area(), mesh.area(), 1e-9 * mesh.area());
  ASSERT_EQ(cut.is_cut.size(), static_cast<std::size_t>(fine.n_edges()));
  for (Index f = 0; f < fine.n_faces(); ++f) {
    const Vec3 normal = mesh.face_normal(cut.refined.old_face[f]);
    for (const Index v : fine.triangle(f)) {
      const Vec3 off = fine.position(v) - mesh.position(mesh.triangle(cut.refined.old_face[f])[0]);
      EXPECT_NEAR(normal.dot(off), 0, tolerance);
    }
    EXPECT_GE(fine.face_normal(f).dot(normal) * fine.face_area(f), -1e-12 * mesh.area()) << "no face turns over";
  }
  for (Index v = 0; v < fine.n_vertices(); ++v) {
    if (fine.outgoing(v) == no_index) continue;
    EXPECT_NEAR((position_of(mesh, cut.refined.on_old[v]) - fine.position(v)).norm(), 0, tolerance);
  }
  double length = 0;
  for (const auto& line : lines) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Vec3 a = position_of(mesh, line[i - 1]);
      const Vec3 b = position_of(mesh, line[i]);
      length += (b - a).norm();
    }
  }
  double cut_length = 0;
  for (Index e = 0; e < fine.n_edges(); ++e) {
    if (cut.is_cut[e]) cut_length += fine.edge_length(e);
  }
  EXPECT_NEAR(cut_length, length, 1e-4 * length + 100 * tolerance);
}

TEST(CutAlong, LinesBecomeEdges) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Rng rng(seed);
    const TriangleMesh mesh = test::random_mesh(rng, {.min_faces = 4, .max_faces = 60, .closed = seed % 2 == 0});
    std::vector<std::vector<SurfacePoint>> lines;
    for (Index k = 0; k < 1 + static_cast<Index>(seed % 4); ++k) {
      const SurfacePoint from = test::random_supported_point(rng, mesh);
      const Vec3 along = mesh.position(mesh.triangle(from.face)[1]) - mesh.position(mesh.triangle(from.face)[0]);
      const double turn = test::random_real(rng, 0, 6.3);
      lines.push_back(straight_walk(mesh, from, along, turn, test::random_real(rng, 0.1, 1.5) * mesh.size()).points);
    }
    expect_cut(mesh, lines, cut_along(mesh, lines));
  }
}

TEST(CutAlong, ALineAcrossASquareHalvesIt) {
  const TriangleMesh mesh = test::planar_grid(5, 5, 5, 5);
  const StraightWalk line =
      straight_walk(mesh, point_on_halfedge(mesh.boundary_loops()[0][2], 0.5), Vec3::UnitY(), 0, 9);
  const double x = position_of(mesh, line.points.front()).x();
  ASSERT_TRUE(line.at_boundary);
  const CutMesh cut = cut_along(mesh, std::vector<std::vector<SurfacePoint>>{line.points});
  const std::vector<Index> part = parts_between_cuts(cut.refined.mesh, cut.is_cut);
  ASSERT_EQ(*std::max_element(part.begin(), part.end()), 1);
  std::vector<double> areas;
  for (const SubMesh& half : split_mesh(cut.refined.mesh, part)) areas.push_back(half.mesh.area());
  std::sort(areas.begin(), areas.end());
  EXPECT_NEAR(areas[0], 5 * std::min(x, 5 - x), 1e-9);
}

TEST(CutAlong, CrossingLinesCutEachOther) {
  // Three lines across both triangles of a square, two of which cross: five parts.
  const TriangleMesh mesh = test::planar_grid(1, 1, 6, 6);
  Index left = no_index;
  for (const Index h : mesh.boundary_loops()[0]) {
    if (mesh.position(mesh.from(h)).x() == 0 && mesh.position(mesh.to(h)).x() == 0) left = h;
  }
  std::vector<std::vector<SurfacePoint>> lines;
  for (const auto& [y0, y1] : {std::pair(1.0, 3.0), std::pair(3.0, 1.0), std::pair(4.0, 5.0)}) {
    const SurfacePoint from = point_on_halfedge(left, 1 - y0 / 6);  // the loop runs downwards there
    lines.push_back(straight_walk(mesh, from, Vec3(6, y1 - y0, 0), 0, 20).points);
    ASSERT_NEAR(position_of(mesh, lines.back().back()).y(), y1, 1e-12);
  }
  const CutMesh cut = cut_along(mesh, lines);
  expect_cut(mesh, lines, cut);
  const std::vector<Index> part = parts_between_cuts(cut.refined.mesh, cut.is_cut);
  EXPECT_EQ(*std::max_element(part.begin(), part.end()) + 1, 5);
}

TEST(OpenedAlong, HasBothSidesOfTheCutOnItsBoundary) {
  // from the rim to the middle: still one loop; from rim to rim: two parts
  const TriangleMesh mesh = test::planar_grid(8, 8, 8, 8);
  for (const double end : {4.0, 8.0}) {
    std::vector<char> is_cut(mesh.n_edges(), 0);
    for (Index e = 0; e < mesh.n_edges(); ++e) {
      const Index h = mesh.halfedge_of(e);
      const Vec3& a = mesh.position(mesh.from(h));
      const Vec3& b = mesh.position(mesh.to(h));
      is_cut[e] = a.y() == 4 && b.y() == 4 && std::max(a.x(), b.x()) <= end;
    }
    const TriangleMesh opened = opened_along(mesh, is_cut);
    ASSERT_EQ(opened.n_faces(), mesh.n_faces());
    for (Index f = 0; f < mesh.n_faces(); ++f) {
      for (int i = 0; i < 3; ++i)
        EXPECT_EQ(opened.position(opened.triangle(f)[i]), mesh.position(mesh.triangle(f)[i])) << "face " << f;
    }
    // the end of a cut inside stays one vertex, any other vertex of it becomes two
    EXPECT_EQ(opened.n_vertices() - mesh.n_vertices(), end == 8 ? 9 : 4);
    EXPECT_EQ(opened.n_components(), end == 8 ? 2 : 1);
    double rim = 0;
    for (Index e = 0; e < opened.n_edges(); ++e) rim += opened.is_boundary_edge(e) ? opened.edge_length(e) : 0;
    EXPECT_NEAR(rim, 32 + 2 * end, 1e-9);
  }
}

}  // namespace
}  // namespace isopath
