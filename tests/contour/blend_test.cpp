#include "isopath/contour/blend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "isopath/contour/blend_mesh.h"
#include "isopath/contour/spokes.h"
#include "isopath/contour/turn_angle.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

ExactField boundary_field(const TriangleMesh& mesh) { return ExactField::compute(mesh, boundary_source(mesh)); }

TriangleMesh fine(const TriangleMesh& mesh, double spacing) {
  return refine_for_blend(mesh, boundary_field(mesh), spacing).mesh;
}

/// Two squares of 8, joined by a neck 4 wide and 6 long.
TriangleMesh dumbbell() {
  return test::planar_cells(22, 8, [](int i, int j) { return i < 8 || i >= 14 || (j >= 2 && j < 6); });
}

TriangleMesh flat_annulus(int segments, int rings, double inner, double outer) {
  TriangleSoup soup;
  for (int r = 0; r <= rings; ++r) {
    for (int k = 0; k < segments; ++k) {
      const double angle = 2 * std::numbers::pi * k / segments;
      const double radius = inner + (outer - inner) * r / rings;
      soup.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    }
  }
  for (int r = 0; r < rings; ++r) {
    for (int k = 0; k < segments; ++k) {
      const Index a = r * segments + k;
      const Index b = r * segments + (k + 1) % segments;
      soup.triangles.push_back({a, a + segments, b + segments});
      soup.triangles.push_back({a, b + segments, b});
    }
  }
  return TriangleMesh(std::move(soup));
}

/// Number of connected parts of the vertices that `holds` names.
template <class Holds>
int parts_of(const TriangleMesh& mesh, const Holds& holds) {
  std::vector<Index> part(mesh.n_vertices());
  std::iota(part.begin(), part.end(), 0);
  const auto find = [&](Index v) {
    while (part[v] != v) v = part[v] = part[part[v]];
    return v;
  };
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    const Index h = mesh.halfedge_of(e);
    if (holds(mesh.from(h)) && holds(mesh.to(h))) part[find(mesh.from(h))] = find(mesh.to(h));
  }
  int n = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) n += mesh.outgoing(v) != no_index && holds(v) && find(v) == v ? 1 : 0;
  return n;
}

/// Most parts that the values above any of 60 levels fall into, and most that those below do, boundary included.
std::pair<int, int> most_parts(const TriangleMesh& mesh, std::span<const double> values) {
  const double top = *std::max_element(values.begin(), values.end());
  std::pair<int, int> most = {0, 0};
  for (int k = 0; k < 60; ++k) {
    const double level = (k + 0.37) / 60 * top;
    most.first = std::max(most.first, parts_of(mesh, [&](Index v) { return values[v] > level; }));
    most.second = std::max(most.second, parts_of(mesh, [&](Index v) { return values[v] <= level; }));
  }
  return most;
}

TEST(Spokes, OfASquareLeadToItsDiagonals) {
  const TriangleMesh mesh = test::planar_grid(20, 20, 10, 10, {.jitter = 0.2, .seed = 7});
  const double tolerance = 0.01;
  const std::vector<Spoke> all = spokes(boundary_field(mesh), tolerance);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3& p = mesh.position(v);
    const double x = std::min(p.x(), 10 - p.x());
    const double y = std::min(p.y(), 10 - p.y());
    if (mesh.is_boundary_vertex(v)) {
      EXPECT_FALSE(all[v].end.valid());
      continue;
    }
    // the tolerance, and a start a fiftieth of an edge beside the vertex
    EXPECT_NEAR(all[v].length, std::max(x, y), 0.03) << "at " << p.transpose();
    const Vec3 end = position_of(mesh, all[v].end);
    EXPECT_NEAR(std::min(end.x(), 10 - end.x()), std::min(end.y(), 10 - end.y()), 0.03) << "at " << p.transpose();
    if (std::max(x, y) < 4.9) {
      EXPECT_NEAR(all[v].axis_slope, std::sqrt(0.5), 1e-9) << "at " << p.transpose();
    }
  }
}

TEST(Spokes, OfAStripMeetHeadOn) {
  const TriangleMesh mesh = test::planar_grid(40, 8, 40, 4, {.jitter = 0.2, .seed = 3});
  const std::vector<Spoke> all = spokes(boundary_field(mesh), 0.005);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3& p = mesh.position(v);
    if (p.x() < 3 || p.x() > 37 || mesh.is_boundary_vertex(v)) continue;
    EXPECT_NEAR(all[v].length, 2, 0.01);
    EXPECT_NEAR(all[v].axis_slope, 0, 1e-9);
  }
}

TEST(Spokes, EndOnABoundaryThatIsNoSource) {
  const TriangleMesh mesh = test::planar_grid(10, 10, 10, 10);
  std::vector<Index> side;
  for (const Index h : mesh.boundary_loops()[0]) {
    if (mesh.position(mesh.from(h)).y() == 0 && mesh.position(mesh.to(h)).y() == 0) side.push_back(h);
  }
  SourceSet source;
  source.add_halfedges(mesh, side, false);
  const std::vector<Spoke> all = spokes(ExactField::compute(mesh, source), 0.01);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.position(v).y() == 0) continue;
    EXPECT_NEAR(all[v].length, 10, 1e-9);
    EXPECT_EQ(all[v].axis_slope, 1);
  }
}

TEST(Spokes, RefusesAToleranceOfNothing) {
  const TriangleMesh mesh = test::planar_grid(2, 2, 1, 1);
  EXPECT_THROW(spokes(boundary_field(mesh), 0), Error);
}

/// The distance of a point inside from the boundary of a regular polygon around the origin.
double distance_in_polygon(int n, double radius, const Vec3& p) {
  double nearest = infinity;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / n;
    const double out = p.x() * std::cos(angle) + p.y() * std::sin(angle);
    nearest = std::min(nearest, radius * std::cos(std::numbers::pi / n) - out);
  }
  return nearest;
}

// Many straight fronts overlap in every list, and some rays pass exactly through vertices.
TEST(Blend, DistancesItStartsFromAreThoseOfThePolygon) {
  for (const int n : {60, 97, 120, 200}) {
    const TriangleMesh mesh = fine(test::open_cone(n, 10, 10, 10), 1);
    const ExactField field = boundary_field(mesh);
    for (Index v = 0; v < mesh.n_vertices(); ++v)
      ASSERT_NEAR(field.vertex_distances()[v], distance_in_polygon(n, 10, mesh.position(v)), 1e-9) << n << " sides";
  }
}

TEST(Blend, OfADiscIsTheDistance) {
  const TriangleMesh mesh = fine(test::open_cone(120, 10, 10, 10), 1);
  const ExactField field = boundary_field(mesh);
  const BlendedField blended = blend(field, {.spacing = 1});
  EXPECT_EQ(blended.n_levels, 10);
  EXPECT_LT(mesh.position(blended.root).norm(), 0.1);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    // pulled up by half a level or a little more where it ends, and nowhere else
    const double distance = field.vertex_distances()[v];
    const double off = blended.values[v] - distance;
    EXPECT_NEAR(off, 0, mesh.position(v).norm() < 0.7 ? 0.6 : 0.03) << mesh.position(v).transpose();
  }
}

TEST(Blend, HasOneTopWhereTheDistanceHasSeveralButForIslandsFarOff) {
  struct Case {
    const char* name;
    TriangleMesh mesh;
    int islands;
  };
  const Case cases[] = {{"dumbbell", dumbbell(), 1},
                        {"L", test::l_shape(6), 0},
                        {"star", test::planar_star(5, 10, 4), 0},
                        {"notched ellipse", test::notched_ellipse(12, 60, 10, 6), 1},
                        {"wavy sheet", test::wavy_sheet(14, 10, 1.2, 1.3, 1.1, 5), 0}};
  for (const Case& c : cases) {
    const TriangleMesh mesh = fine(c.mesh, 0.9);
    const ExactField field = boundary_field(mesh);
    const BlendedField blended = blend(field, {.spacing = 0.9});
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      if (mesh.is_boundary_vertex(v)) {
        EXPECT_EQ(blended.values[v], 0) << c.name;
      }
      EXPECT_GE(blended.values[v], field.vertex_distances()[v] - 0.5 * 0.9)
          << c.name << " at " << mesh.position(v).transpose();
    }
    EXPECT_EQ(most_parts(mesh, blended.values), std::pair(1 + c.islands, 1)) << c.name;
    std::vector<double> without = blended.values;
    leave_one_top(mesh, blended.root_of_component, without);
    EXPECT_EQ(most_parts(mesh, without), std::pair(1, 1)) << c.name;
    EXPECT_EQ(*std::max_element(blended.values.begin(), blended.values.end()), blended.values[blended.root]) << c.name;
    if (c.mesh.n_faces() == dumbbell().n_faces()) {
      EXPECT_GT(most_parts(mesh, field.vertex_distances()).first, 1) << "the case shows nothing";
    }
  }
}

TEST(Blend, IsNoHigherThanTheWidestPlaceAsksFor) {
  // unlike the paper's form, which counts the way along the axis
  const TriangleMesh mesh = fine(test::planar_grid(30, 6, 30, 6), 1);
  const BlendedField blended = blend(boundary_field(mesh), {.spacing = 1});
  EXPECT_EQ(blended.n_levels, 3);
  EXPECT_LE(*std::max_element(blended.values.begin(), blended.values.end()), 3.5);
}

TEST(Blend, LetsTipsReachOutForWhatRoundingTakesOff) {
  const TriangleMesh mesh = fine(test::planar_grid(20, 20, 20, 20), 2);
  const ExactField field = boundary_field(mesh);
  const BlendedField sharp = blend(field, {.spacing = 2});
  const BlendedField round = blend(field, {.spacing = 2, .radius = 0.3});
  ASSERT_EQ(sharp.spacing, round.spacing);
  int higher = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3& p = mesh.position(v);
    const double off_diagonal = std::min(std::abs(p.x() - p.y()), std::abs(20 - p.x() - p.y()));
    if (mesh.is_boundary_vertex(v) || (p - Vec3(10, 10, 0)).norm() < 3) continue;
    if (off_diagonal < 1e-9) {
      // a right angle loses 0.41 radii, of which the distance grows by half √2 along the diagonal, a sharper tip more
      EXPECT_GE(round.values[v] - sharp.values[v], 0.29 * 0.3) << p.transpose();
      ++higher;
    } else if (off_diagonal > 2.6) {
      EXPECT_NEAR(round.values[v], sharp.values[v], 1e-3) << p.transpose();
    }
  }
  EXPECT_GT(higher, 20);
}

TEST(Blend, IsTheSameEachTime) {
  const TriangleMesh mesh = fine(dumbbell(), 1);
  const ExactField field = boundary_field(mesh);
  EXPECT_EQ(blend(field, {.spacing = 1}).values, blend(field, {.spacing = 1}).values);
}

TEST(Blend, WantsTheWholeBoundary) {
  const TriangleMesh mesh = test::planar_grid(4, 4, 4, 4);
  SourceSet corner;
  corner.add_vertex(mesh, 0);
  EXPECT_THROW(blend(ExactField::compute(mesh, corner), {.spacing = 1}), Error);
  EXPECT_THROW(blend(boundary_field(mesh), {}), Error);
  EXPECT_THROW(blend(boundary_field(mesh), {.spacing = 1, .radius = -1}), Error);
}

TEST(Blend, OfASphereEndsOppositeItsSource) {
  const TriangleMesh mesh = test::icosphere(3, 5);
  SourceSet source;
  source.add_vertex(mesh, 0);
  const BlendedField blended = blend(ExactField::compute(mesh, source), {.spacing = 1.5});
  EXPECT_LT((mesh.position(blended.root) + mesh.position(0)).norm(), 1);
  EXPECT_EQ(most_parts(mesh, blended.values), std::pair(1, 1));
}

TEST(PaperBlend, OfARectangleFallsEvenlyAlongItsAxis) {
  // axis from (3, 3) to (27, 3), the root in the middle: h_R = 12 + 3
  const TriangleMesh mesh = fine(test::planar_grid(30, 6, 30, 6), 1);
  const BlendedField blended = blend(boundary_field(mesh), {.form = BlendForm::paper, .spacing = 1});
  const double scale = blended.n_levels * blended.spacing;
  int on_axis = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3& p = mesh.position(v);
    EXPECT_GE(blended.values[v], 0);
    EXPECT_LE(blended.values[v], (1 + 1e-9) * scale);
    if (std::abs(p.y() - 3) > 1e-9 || p.x() < 3 || p.x() > 27) continue;
    ++on_axis;
    // what D_MA starts with grows faster than a distance can where (h_R - τ)² < clearance × h_R: propagation lowers it
    const double way = std::abs(p.x() - 15);
    if ((15 - way) * (15 - way) > 1.1 * 3 * 15) {
      EXPECT_NEAR(blended.values[v] / scale, 1 - way / 15, 0.01) << "at " << p.transpose();
    } else {
      EXPECT_GE(blended.values[v] / scale, 1 - way / 15 - 0.01) << "at " << p.transpose();
    }
  }
  EXPECT_GT(on_axis, 10);
  // the half height is 3; the way along the axis is what counts
  EXPECT_GE(blended.n_levels, 12);
}

TEST(PaperBlend, OfADiscIsTheShareOfTheRadius) {
  const TriangleMesh mesh = fine(test::open_cone(120, 10, 10, 10), 1);
  const BlendedField blended = blend(boundary_field(mesh), {.form = BlendForm::paper, .spacing = 1});
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    EXPECT_NEAR(blended.values[v] / blended.n_levels, 1 - mesh.position(v).norm() / 10, 0.01);
  }
}

TEST(BlendBetween, CirclesIsTheShareOfTheWay) {
  const TriangleMesh mesh = flat_annulus(180, 12, 4, 10);
  const ExactField outer = ExactField::compute(mesh, boundary_source(mesh, 0));
  const ExactField inner = ExactField::compute(mesh, boundary_source(mesh, 1));
  const std::vector<double> values = blend_between(outer, inner);
  for (Index v = 0; v < mesh.n_vertices(); ++v) EXPECT_NEAR(values[v], (10 - mesh.position(v).norm()) / 6, 1e-3);
  EXPECT_EQ(levels_to_keep(mesh, values, 1), 6);
}

TEST(LevelsToKeep, IsTheRangeOverTheSpacing) {
  const TriangleMesh mesh = test::planar_grid(8, 8, 5, 5);
  std::vector<double> values;
  for (Index v = 0; v < mesh.n_vertices(); ++v) values.push_back(mesh.position(v).x() / 5);
  EXPECT_EQ(levels_to_keep(mesh, values, 1), 5);
  EXPECT_EQ(levels_to_keep(mesh, values, 1.3), 4);
}

TEST(LeaveOneTop, OfAnyFunction) {
  const TriangleMesh mesh = test::planar_grid(12, 12, 1, 1, {.diagonal = test::Diagonal::union_jack});
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::Rng rng(seed);
    std::vector<double> values;
    Index root = 0;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      values.push_back(mesh.is_boundary_vertex(v) ? 0 : test::random_real(rng, 0.01, 1));
      if (values[v] > values[root]) root = v;
    }
    const double top = values[root];
    leave_one_top(mesh, {root}, values);
    EXPECT_EQ(values[root], top) << "seed " << seed;
    EXPECT_EQ(most_parts(mesh, values), std::pair(1, 1)) << "seed " << seed;
  }
}

TEST(TurnAngle, OfAnAnnulusIsItsAngle) {
  const TriangleMesh mesh = flat_annulus(90, 8, 4, 10);
  const auto face_at = [&](int loop) { return TriangleMesh::face_of(mesh.boundary_loops()[loop][20]); };
  const TurnAngle angle = turn_angle(mesh, {face_at(1)}, {face_at(0)});
  const auto true_turn = [&](Index v) {
    return std::atan2(mesh.position(v).y(), mesh.position(v).x()) / (2 * std::numbers::pi);
  };
  const auto off = [](double turns) { return turns - std::round(turns); };
  const double sign = off(angle.turn[1] - angle.turn[0]) > 0 ? 1 : -1;
  for (Index v = 0; v < mesh.n_vertices(); ++v)
    EXPECT_NEAR(off(sign * (angle.turn[v] - angle.turn[0]) - (true_turn(v) - true_turn(0))), 0, 0.005);  // half a face
}

TEST(TurnAngle, GrowsByOneAroundAHole) {
  const TriangleMesh mesh = test::l_shape(6);
  const Index inner = 40;
  const Index outer = TriangleMesh::face_of(mesh.boundary_loops()[0][3]);
  const TurnAngle angle = turn_angle(mesh, {inner}, {outer});
  EXPECT_TRUE(angle.hole[inner]);
  double sum = 0;
  for (const Index h : mesh.boundary_loops()[0]) {
    const double step = angle.turn[mesh.to(h)] - angle.turn[mesh.from(h)];
    sum += step - std::round(step);
  }
  EXPECT_NEAR(std::abs(sum), 1, 1e-9);
}

TEST(RefineForBlend, LeavesNoLongEdges) {
  const TriangleMesh mesh = test::planar_grid(2, 2, 10, 10);
  const TriangleMesh result = fine(mesh, 1);
  for (Index e = 0; e < result.n_edges(); ++e) EXPECT_LE(result.edge_length(e), 0.4 + 1e-12);
  for (Index v = 0; v < mesh.n_vertices(); ++v) EXPECT_EQ(result.position(v), mesh.position(v));
  EXPECT_NEAR(result.area(), 100, 1e-9);
  // a function of slope 5 passes a spacing in half an edge
  std::vector<double> steep;
  for (Index v = 0; v < result.n_vertices(); ++v) steep.push_back(5 * result.position(v).x());
  const TriangleMesh finer = refine_for_levels(result, steep, 1).mesh;
  for (Index e = 0; e < finer.n_edges(); ++e) {
    const Index h = finer.halfedge_of(e);
    EXPECT_LE(5 * std::abs(finer.position(finer.from(h)).x() - finer.position(finer.to(h)).x()), 0.8 + 1e-9);
  }
}

}  // namespace
}  // namespace isopath
