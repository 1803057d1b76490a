// The exact field on meshes that are hard on it: near-degenerate ones of every kind against exhaustive unfolding,
// properties that need no judge, and the two failures that other programs are known for (docs/robustness.md).
//
// ISOPATH_HARD_MESHES=100000 in the environment makes the comparison a long one (a few minutes); ISOPATH_HARD_SEED=n
// starts it at another seed, so that ISOPATH_HARD_SEED=17343 ISOPATH_HARD_MESHES=1 repeats a failure.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "field/field_from.h"
#include "isopath/core/error.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/graph_field.h"
#include "isopath/field/source_fronts.h"
#include "isopath/mesh/refine.h"
#include "support/hard_meshes.h"
#include "support/random_sources.h"
#include "support/slow_exact.h"
#include "support/stop_at.h"

namespace isopath::test {
namespace {

/// Every kind of hard mesh, short of triangles without height and of vertices that coincide.
constexpr HardMeshOptions moderate{.least_height = 1e-8, .least_distance = 1e-6, .strongest_squeeze = 1e-4};

std::uint64_t number_from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// 1e-9 relative, and never below what coordinates of this mesh resolve. That is all the conditioning there is:
/// moving every vertex by δ changes the straight way through a face by at most 2 δ, and a shortest way passes a face
/// once, so k faces change a distance by at most 2 k δ, needles or not. A coordinate's rounding is 1e-16 of the size;
/// with 70 faces, and a few roundings in each on the way, that stays below 1e-11.
double tolerance_of(const TriangleMesh& mesh, double distance) { return 1e-9 * distance + 1e-11 * mesh.size(); }

std::string describe(const SurfacePoint& p) {
  return fmt::format("face {} at {} {} {}", p.face, p.barycentric[0], p.barycentric[1], p.barycentric[2]);
}

/// On vertices, edges and faces; half of the latter close to a corner or an edge.
SurfacePoint probe(Rng& rng, const TriangleMesh& mesh) {
  const Index face = random_index(rng, mesh.n_faces());
  if (random_index(rng, 3) == 0) return point_on_halfedge(3 * face + random_index(rng, 3), random_real(rng, 0, 1));
  Vec3 weights(random_real(rng, 0, 1), random_real(rng, 0, 1), random_real(rng, 0, 1));
  if (random_index(rng, 2) == 0) weights[random_index(rng, 3)] *= std::pow(10.0, random_real(rng, -16, 0));
  if (random_index(rng, 2) == 0) weights[random_index(rng, 3)] *= std::pow(10.0, random_real(rng, -16, 0));
  return {face, weights / weights.sum()};
}

/// What is wrong with the field at one place, if anything.
std::optional<std::string> wrong(const TriangleMesh& mesh, double found, double expected, const std::string& where) {
  if (found == expected || std::abs(found - expected) <= tolerance_of(mesh, expected)) return std::nullopt;
  return fmt::format("{}: {:.17g} instead of {:.17g}, off by {:.2g} of the distance, {:.2g} of the size", where, found,
                     expected, (found - expected) / expected, (found - expected) / mesh.size());
}

/// Stops a computation that does not end: these meshes take a few milliseconds. Counts processor time, so that a busy
/// machine stops nothing.
class Deadline final : public Progress {
 public:
  bool cancelled() const override { return std::clock() > end_; }

 private:
  std::clock_t end_ = std::clock() + 5 * CLOCKS_PER_SEC;
};

std::optional<std::string> find_fault(Rng& rng, const TriangleMesh& mesh) {
  const SourceSet sources = random_sources(rng, mesh);
  const SlowExact judge(mesh, sources.elements());
  Deadline deadline;
  const ExactField field = ExactField::compute(mesh, sources, {}, deadline);
  field.verify();
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (auto fault = wrong(mesh, field.value_at_vertex(v), judge.vertex_distances()[v], fmt::format("vertex {}", v)))
      return fault;
  }
  for (int k = 0; k < 12; ++k) {
    const SurfacePoint p = probe(rng, mesh);
    if (auto fault = wrong(mesh, field.value(p), judge.distance(p), describe(p))) return fault;
  }
  return std::nullopt;
}

/// True when there is nothing to report.
bool expect_agreement_on_hard_mesh(std::uint64_t seed, const HardMeshOptions& options) {
  Rng rng(seed);
  const HardMesh hard = hard_mesh(rng, options);
  std::optional<std::string> fault;
  try {
    fault = find_fault(rng, hard.mesh);
  } catch (const std::exception& error) {
    fault = error.what();
  }
  if (fault)
    ADD_FAILURE() << "seed " << seed << " (" << hard.kind << ", " << hard.mesh.n_faces() << " faces): " << *fault;
  return !fault;
}

void expect_agreement_on_hard_meshes(const HardMeshOptions& options, std::uint64_t few) {
  const std::uint64_t first = number_from_environment("ISOPATH_HARD_SEED", 0);
  const std::uint64_t count = number_from_environment("ISOPATH_HARD_MESHES", few);
  constexpr int most_reports = 500;
  int faults = 0;
  for (std::uint64_t seed = first; seed < first + count && faults < most_reports; ++seed) {
    if (!expect_agreement_on_hard_mesh(seed, options)) ++faults;
  }
}

TEST(ExactFieldRobustness, HardMeshesAgreeWithExhaustiveUnfolding) { expect_agreement_on_hard_meshes(moderate, 3000); }

// Corners exactly on the opposite edge, vertices that coincide or nearly so.
TEST(ExactFieldRobustness, HardestMeshesAgreeWithExhaustiveUnfolding) { expect_agreement_on_hard_meshes({}, 4000); }

// One in some thousand: each of these once found a fault, in the field or in its judge (docs/robustness.md).
TEST(ExactFieldRobustness, RareFaultsStayMended) {
  for (const std::uint64_t seed :
       {23158,  24659,  25668,  26185,  31259,  39213,  44373,  45056,  48690,  53442,  54664,  54896,  59173,
        60454,  66277,  74384,  83548,  84802,  84836,  88071,  91444,  93529,  95596,  96583,  98330,  100546,
        104709, 110412, 110737, 111400, 116951, 124388, 126093, 130295, 131362, 131478, 136685, 150882, 150942,
        154655, 155668, 157653, 158387, 162613, 167332, 174516, 178676, 185957, 187144, 194281, 198440, 199685}) {
    expect_agreement_on_hard_mesh(seed, {});
  }
}

TEST(ExactFieldRobustness, StopsWhileSourcesAreLaidOut) {
  // Many points in one face: all the work is laying them out, before the first round.
  const TriangleMesh mesh = planar_grid(1, 1, 1, 1);
  SourceSet sources;
  for (int k = 1; k < 5000; ++k) sources.add_point({0, Vec3(k, 1, 5000 - k) / 5001});
  for (int at = 1; at <= 5; ++at) {
    StopAt progress(at);
    const IntrinsicGeometry geometry(mesh);
    try {
      source_fronts(mesh, geometry, sources, progress);
      FAIL() << "went on after look " << at;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
  }
}

/// Runs `check(rng, mesh)` on hard meshes until one fails; its seed is in the trace.
template <class Check>
void on_hard_meshes(std::uint64_t first, std::uint64_t last, Check check) {
  for (std::uint64_t seed = first; seed < last && !testing::Test::HasFailure(); ++seed) {
    Rng rng(seed);
    const HardMesh hard = hard_mesh(rng, moderate);
    SCOPED_TRACE(fmt::format("seed {} ({}, {} faces)", seed, hard.kind, hard.mesh.n_faces()));
    check(rng, hard.mesh);
  }
}

void expect_same(const TriangleMesh& mesh, double found, double expected) {
  if (expected == infinity) {
    EXPECT_EQ(found, infinity);
  } else {
    EXPECT_NEAR(found, expected, 2 * tolerance_of(mesh, expected));
  }
}

/// A point and a polyline, as points, so that they can be carried over to another mesh.
struct PointSources {
  SurfacePoint point;
  std::vector<SurfacePoint> polyline;

  PointSources(Rng& rng, const TriangleMesh& mesh)
      : point(random_supported_point(rng, mesh)), polyline(random_polyline(rng, mesh, 2 + random_index(rng, 4))) {}

  SourceSet on(const TriangleMesh& mesh) const {
    SourceSet sources;
    sources.add_point(point);
    sources.add_polyline(mesh, polyline, false);
    return sources;
  }
};

TEST(ExactFieldRobustness, DistancesAreSymmetricAndKeepTheTriangleInequality) {
  on_hard_meshes(1007000, 1007400, [](Rng& rng, const TriangleMesh& mesh) {
    const SurfacePoint a = probe(rng, mesh);
    const SurfacePoint b = probe(rng, mesh);
    const SurfacePoint c = probe(rng, mesh);
    const ExactField from_a = field_from(mesh, a);
    const ExactField from_b = field_from(mesh, b);
    expect_same(mesh, from_a.value(b), from_b.value(a));
    EXPECT_LE(from_a.value(a), tolerance_of(mesh, 0));
    const double straight = (position_of(mesh, a) - position_of(mesh, b)).norm();
    EXPECT_GE(from_a.value(b), straight - tolerance_of(mesh, straight));
    const double way_round = from_a.value(b) + from_b.value(c);
    if (way_round == infinity) return;
    EXPECT_LE(from_a.value(c), way_round + tolerance_of(mesh, way_round));
  });
}

TEST(ExactFieldRobustness, NoValueChangesFasterThanTheWay) {
  on_hard_meshes(1001000, 1001400, [](Rng& rng, const TriangleMesh& mesh) {
    const ExactField field = ExactField::compute(mesh, random_sources(rng, mesh));
    for (int k = 0; k < 20; ++k) {
      const SurfacePoint p = probe(rng, mesh);
      SurfacePoint q{p.face, Vec3(random_real(rng, 0, 1), random_real(rng, 0, 1), random_real(rng, 0, 1))};
      q.barycentric /= q.barycentric.sum();
      if (k % 2 == 0) q.barycentric = p.barycentric + 1e-4 * (q.barycentric - p.barycentric);
      const double at_p = field.value(p);
      if (at_p == infinity) continue;
      const double way = (position_of(mesh, p) - position_of(mesh, q)).norm();
      EXPECT_LE(std::abs(at_p - field.value(q)), way + tolerance_of(mesh, at_p)) << describe(p) << ", " << describe(q);
    }
    for (Index h = 0; h < mesh.n_halfedges(); ++h) {  // no step from one side of an edge to the other
      if (mesh.twin(h) == no_index || field.value_at_vertex(mesh.from(h)) == infinity) continue;
      const SurfacePoint here = point_on_halfedge(h, random_real(rng, 0, 1));
      const SurfacePoint there = express_in(mesh, here, TriangleMesh::face_of(mesh.twin(h)));
      expect_same(mesh, field.value(there), field.value(here));
    }
  });
}

TEST(ExactFieldRobustness, PlaceScaleAndNumberingDoNotMatter) {
  on_hard_meshes(1002100, 1002400, [](Rng& rng, const TriangleMesh& mesh) {
    const PointSources sources(rng, mesh);
    const ExactField field = ExactField::compute(mesh, sources.on(mesh));
    const double factor = 1000.0 / 7;
    const TriangleMesh larger = scaled(mesh, factor);
    const TriangleMesh turned = moved(mesh, {1, -2, 0.5}, 1.1, mesh.size() * Vec3(1, 2, -1));
    const ExactField field_larger = ExactField::compute(larger, sources.on(larger));
    const ExactField field_turned = ExactField::compute(turned, sources.on(turned));
    const Renumbered other = renumbered(rng, mesh);
    PointSources moved_sources = sources;
    moved_sources.point.face = other.face[sources.point.face];
    for (SurfacePoint& p : moved_sources.polyline) p.face = other.face[p.face];
    const ExactField field_other = ExactField::compute(other.mesh, moved_sources.on(other.mesh));
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      const double expected = field.value_at_vertex(v);
      expect_same(mesh, field_larger.value_at_vertex(v) / factor, expected);
      expect_same(mesh, field_turned.value_at_vertex(v), expected);
      expect_same(mesh, field_other.value_at_vertex(other.vertex[v]), expected);
    }
    for (int k = 0; k < 4; ++k) {
      const SurfacePoint p = probe(rng, mesh);
      expect_same(mesh, field_other.value({other.face[p.face], p.barycentric}), field.value(p));
    }
  });
}

TEST(ExactFieldRobustness, FinerTrianglesOfTheSameSurfaceChangeNothing) {
  on_hard_meshes(1008000, 1008200, [](Rng& rng, const TriangleMesh& mesh) {
    const Index source = mesh.from(random_index(rng, mesh.n_halfedges()));
    const RefinedMesh finer = refine(
        mesh, [&](const RefineTriangle&) { return random_index(rng, 3) == 0; }, 2);
    const ExactField field = field_from(mesh, point_at_vertex(mesh, source));
    const ExactField field_finer = field_from(finer.mesh, point_at_vertex(finer.mesh, source));
    for (Index v = 0; v < finer.mesh.n_vertices(); ++v) {
      if (finer.on_old[v].valid()) expect_same(mesh, field_finer.value_at_vertex(v), field.value(finer.on_old[v]));
    }
  });
}

TEST(ExactFieldRobustness, ShortestPathsAreAsLongAsTheDistance) {
  on_hard_meshes(1004000, 1004400, [](Rng& rng, const TriangleMesh& mesh) {
    const SourceSet sources = random_sources(rng, mesh);
    const ExactField field = ExactField::compute(mesh, sources);
    const SlowExact judge(mesh, sources.elements());
    for (int k = 0; k < 4; ++k) {
      const SurfacePoint p = probe(rng, mesh);
      const double distance = field.value(p);
      if (distance == infinity) continue;
      const std::vector<SurfacePoint> path = field.shortest_path(p);
      ASSERT_FALSE(path.empty());
      double length = 0;
      for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        length += (position_of(mesh, path[i + 1]) - position_of(mesh, path[i])).norm();
      }
      expect_same(mesh, length, distance);
      EXPECT_LE(judge.distance(path.back()), tolerance_of(mesh, distance));
    }
  });
}

class RegularGrid : public testing::TestWithParam<std::tuple<Diagonal, std::pair<int, int>>> {};

TEST_P(RegularGrid, EveryVertexHasItsStraightDistanceInSpiteOfTies) {
  const int n = 100;
  const auto& [diagonal, source] = GetParam();
  const TriangleMesh mesh = planar_grid(n, n, n, n, {.diagonal = diagonal});
  const Vec2 from(source.first, source.second);
  const ExactField field = field_from(mesh, point_at_vertex(mesh, source.second * (n + 1) + source.first));
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const double straight = (mesh.position(v).head<2>() - from).norm();
    ASSERT_NEAR(field.value_at_vertex(v), straight, 1e-12 * n) << "vertex " << v;
  }
  Rng rng(1);
  for (int k = 0; k < 2000; ++k) {
    const SurfacePoint p = probe(rng, mesh);
    const double straight = (position_of(mesh, p).head<2>() - from).norm();
    ASSERT_NEAR(field.value(p), straight, 1e-12 * n) << describe(p);
  }
}

INSTANTIATE_TEST_SUITE_P(ExactFieldRobustness, RegularGrid,
                         testing::Combine(testing::Values(Diagonal::regular, Diagonal::union_jack),
                                          testing::Values(std::pair(0, 0), std::pair(100, 0), std::pair(50, 50),
                                                          std::pair(37, 64))));

TEST(ExactFieldRobustness, ManyEqualSourcesOnARegularGridGiveTheNearestOne) {
  const int n = 100;
  const TriangleMesh mesh = planar_grid(n, n, n, n);
  SourceSet sources;
  for (int j = 10; j < n; j += 20) {
    for (int i = 10; i < n; i += 20) sources.add_vertex(mesh, j * (n + 1) + i);
  }
  const ExactField lattice = ExactField::compute(mesh, sources);
  const ExactField rim = ExactField::compute(mesh, boundary_source(mesh));
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const Vec3& p = mesh.position(v);
    const auto to_lattice = [](double x) { return std::abs(x - (10 + 20 * std::clamp(std::floor(x / 20), 0.0, 4.0))); };
    ASSERT_NEAR(lattice.value_at_vertex(v), std::hypot(to_lattice(p.x()), to_lattice(p.y())), 1e-12 * n) << v;
    ASSERT_NEAR(rim.value_at_vertex(v), std::min({p.x(), p.y(), n - p.x(), n - p.y()}), 1e-12 * n) << v;
  }
}

/// Two half-discs that hang together by an edge of length `width` on the y axis; vertices 0 and 1 are its ends.
TriangleMesh two_rooms(double width, int n) {
  TriangleSoup soup;
  soup.positions = {{0, -0.5 * width, 0}, {0, 0.5 * width, 0}};
  for (const double side : {-1.0, 1.0}) {
    const auto first = static_cast<Index>(soup.positions.size());
    for (int k = 0; k <= n; ++k) {
      const double angle = std::numbers::pi * (k - 0.5 * n) / (n + 2);
      soup.positions.emplace_back(side * std::cos(angle), std::sin(angle), 0);
    }
    for (int k = 0; k < n; ++k) {  // the lower half of the arc sees the lower end, the upper half the upper one
      const Index end = k < n / 2 ? 0 : 1;
      soup.triangles.push_back({end, first + k, first + k + 1});
      if (k == n / 2) soup.triangles.push_back({0, first + k, 1});
    }
    if (side < 0) {
      for (std::size_t f = soup.triangles.size() - n - 1; f < soup.triangles.size(); ++f)
        std::swap(soup.triangles[f][1], soup.triangles[f][2]);
    }
  }
  return TriangleMesh(std::move(soup));
}

TEST(ExactFieldRobustness, VerticesBehindAThinIntervalAreReached) {
  for (const double width : {1e-1, 1e-3, 1e-5, 1e-6}) {
    const int n = 20;
    const TriangleMesh mesh = two_rooms(width, n);
    for (Index source = 2; source < 2 + n; ++source) {
      const ExactField field = field_from(mesh, point_at_vertex(mesh, source));
      const Vec3& s = mesh.position(source);
      for (Index v = 3 + n; v < mesh.n_vertices(); ++v) {
        const Vec3& p = mesh.position(v);
        const double passage = s.y() + (p.y() - s.y()) * (0 - s.x()) / (p.x() - s.x());
        const Vec3 bend(0, std::clamp(passage, -0.5 * width, 0.5 * width), 0);
        ASSERT_NEAR(field.value_at_vertex(v), (s - bend).norm() + (p - bend).norm(), 1e-9)
            << "width " << width << ", from " << source << " to " << v;
      }
    }
  }
}

/// Agreement with the same surface in four times as many triangles, whose windows are others; and bounds.
void expect_all_reached(const TriangleMesh& mesh, Index source) {
  const ExactField field = field_from(mesh, point_at_vertex(mesh, source));
  const RefinedMesh finer = split_uniformly(mesh);
  const ExactField check = field_from(finer.mesh, point_at_vertex(finer.mesh, source));
  SourceSet sources;
  sources.add_vertex(mesh, source);
  const std::vector<double> along_edges = graph_distances(mesh, sources);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const double d = field.value_at_vertex(v);
    ASSERT_NEAR(d, check.value_at_vertex(v), 1e-11 * mesh.size()) << "vertex " << v;
    ASSERT_LE(d, along_edges[v] + 1e-11 * mesh.size()) << "vertex " << v;
    ASSERT_GE(d, (mesh.position(v) - mesh.position(source)).norm() - 1e-11 * mesh.size()) << "vertex " << v;
  }
  for (Index v = mesh.n_vertices(); v < finer.mesh.n_vertices(); ++v) {
    ASSERT_NEAR(field.value(finer.on_old[v]), check.value_at_vertex(v), 1e-11 * mesh.size()) << "midpoint " << v;
  }
}

TEST(ExactFieldRobustness, AllOfAWavySheetIsReached) {
  const TriangleMesh mesh = wavy_sheet(40, 100, 10, 0.3, 0.25, 1);
  for (const Index source : {0, 20 * 41 + 20, 41 * 41 - 1}) expect_all_reached(mesh, source);
}

TEST(ExactFieldRobustness, AllOfATorusIsReached) {
  const TriangleMesh mesh = torus(60, 24, 3, 1);
  for (const Index source : {0, 12, 700}) expect_all_reached(mesh, source);
}

}  // namespace
}  // namespace isopath::test
