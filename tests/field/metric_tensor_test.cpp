#include "isopath/field/metric_tensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "support/test_meshes.h"

namespace isopath::test {
namespace {

using std::numbers::pi;

/// In the plane z = 0, the first direction at this angle.
MetricTensor planar(double angle, double first, double second) {
  return {Vec3(std::cos(angle), std::sin(angle), 0), Vec3(-std::sin(angle), std::cos(angle), 0), first, second};
}

MetricTensor half_way(const MetricTensor& a, const MetricTensor& b, TensorBlend blend) {
  return blended({a, b, b}, {0.5, 0.5, 0}, blend);
}

/// Largest difference of lengths of unit vectors in the plane.
double difference(const MetricTensor& a, const MetricTensor& b) {
  double worst = 0;
  for (int k = 0; k < 64; ++k) {
    const Vec3 v(std::cos(pi * k / 64), std::sin(pi * k / 64), 0);
    worst = std::max(worst, std::abs(a.length(v) - b.length(v)));
  }
  return worst;
}

TEST(MetricTensor, StretchesAlongItsDirections) {
  const MetricTensor t = planar(0.3, 3, 0.5);
  EXPECT_NEAR(t.length(2 * t.first), 6, 1e-14);
  EXPECT_NEAR(t.length(2 * t.second), 1, 1e-14);
  EXPECT_NEAR(t.length(t.first + t.second), std::hypot(3, 0.5), 1e-14);
}

TEST(MetricTensor, TurnsVectorsIntoItsPlaneWithoutShorteningThem) {
  const MetricTensor t = planar(0, 2, 2);
  EXPECT_NEAR(t.length({1, 2, 2}), 6, 1e-14);
}

TEST(MetricTensor, BlendsOfEqualTensorsChangeNothing) {
  for (const TensorBlend blend : {TensorBlend::linear, TensorBlend::paper}) {
    const MetricTensor t = planar(0.7, 3, 0.5);
    EXPECT_NEAR(difference(blended({t, t, t}, {0.2, 0.3, 0.5}, blend), t), 0, 1e-14);
    EXPECT_NEAR(difference(half_way(t, planar(0.7 + pi / 2, 0.5, 3), blend), t), 0, 1e-14);
    EXPECT_NEAR(difference(half_way(t, planar(0.7 + pi, 3, 0.5), blend), t), 0, 1e-14);
  }
}

TEST(MetricTensor, LinearBlendTakesTheMeanOfSquaredLengths) {
  Rng rng(4);
  for (int k = 0; k < 50; ++k) {
    const auto random = [&] {
      return planar(random_real(rng, 0, pi), random_real(rng, 0.1, 3), random_real(rng, 0.1, 3));
    };
    const std::array<MetricTensor, 3> t = {random(), random(), random()};
    const Vec3 w(0.2, 0.5, 0.3);
    const MetricTensor mean = blended(t, w, TensorBlend::linear);
    const Vec3 v(random_real(rng, -1, 1), random_real(rng, -1, 1), 0);
    double square = 0;
    for (int i = 0; i < 3; ++i) square += w[i] * t[i].length(v) * t[i].length(v);
    EXPECT_NEAR(mean.length(v), std::sqrt(square), 1e-13);
    EXPECT_GT(std::min(mean.first_stretch, mean.second_stretch), 0.0999);
  }
}

TEST(MetricTensor, PapersBlendTurnsDirectionsAndStretchesEvenly) {
  const MetricTensor middle = half_way(planar(0.2, 2, 1), planar(0.8, 4, 3), TensorBlend::paper);
  EXPECT_NEAR(difference(middle, planar(0.5, 3, 2)), 0, 1e-14);
}

TEST(MetricTensor, PapersBlendJumpsWhereDirectionsDifferBy45DegreesAndTheLinearOneDoesNot) {
  const MetricTensor a = planar(0, 3, 1);
  const MetricTensor below = planar(pi / 4 - 1e-6, 3, 1);
  const MetricTensor above = planar(pi / 4 + 1e-6, 3, 1);
  EXPECT_LT(difference(half_way(a, below, TensorBlend::linear), half_way(a, above, TensorBlend::linear)), 1e-5);
  EXPECT_GT(difference(half_way(a, below, TensorBlend::paper), half_way(a, above, TensorBlend::paper)), 0.5);
}

TEST(MetricTensor, PapersBlendDependsOnDirectionsThatAnUmbilicDoesNotHave) {
  const MetricTensor a = planar(0, 3, 1);
  EXPECT_LT(difference(half_way(a, planar(0.1, 2, 2), TensorBlend::linear),
                       half_way(a, planar(0.7, 2, 2), TensorBlend::linear)),
            1e-14);
  EXPECT_GT(difference(half_way(a, planar(0.1, 2, 2), TensorBlend::paper),
                       half_way(a, planar(0.7, 2, 2), TensorBlend::paper)),
            0.05);
}

TEST(MetricTensor, BlendsOnTiltedPlanesKeepStretches) {
  // around a cylinder along z, stretched along z and across
  const auto at = [](double angle) {
    return MetricTensor{Vec3(-std::sin(angle), std::cos(angle), 0), Vec3::UnitZ(), 2, 3};
  };
  for (const TensorBlend blend : {TensorBlend::linear, TensorBlend::paper}) {
    const MetricTensor middle = half_way(at(0), at(0.6), blend);
    const MetricTensor expected = at(0.3);
    EXPECT_NEAR((middle.normal() - expected.normal()).norm(), 0, 1e-14);
    EXPECT_NEAR(middle.length(expected.first), 2, 1e-14);
    EXPECT_NEAR(middle.length(Vec3::UnitZ()), 3, 1e-14);
  }
}

TEST(MetricTensor, EdgesTakeTheMeanOfTheirEnds) {
  const MetricTensor a = planar(0, 1, 1);
  const MetricTensor b = planar(0, 7, 7);
  EXPECT_NEAR(edge_length(Vec3::UnitX(), a, b, TensorBlend::linear), 5, 1e-14);
  EXPECT_NEAR(edge_length(Vec3::UnitX(), a, b, TensorBlend::paper), 4, 1e-14);
}

}  // namespace
}  // namespace isopath::test
