#include "isopath/field/angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/test_meshes.h"

namespace isopath {
namespace {

void expect_angles(const std::vector<Vec2>& vectors, double tolerance) {
  std::vector<double> angles(vectors.size(), -1);
  angles_of(vectors, angles);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    EXPECT_NEAR(angles[i], std::atan2(vectors[i].y(), vectors[i].x()), tolerance)
        << vectors[i].x() << " " << vectors[i].y();
  }
}

TEST(Angles, AreThoseOfAtan2) {
  test::Rng rng(11);
  for (const std::size_t n : {0, 1, 2, 3, 7, 8, 9, 31, 20000}) {
    std::vector<Vec2> vectors;
    for (std::size_t i = 0; i < n; ++i) {
      const double scale = std::pow(10, test::random_real(rng, -9, 9));
      const double flat = std::pow(10, test::random_real(rng, -12, 12));
      vectors.emplace_back(scale * test::random_real(rng, -1, 1), std::abs(flat * test::random_real(rng, -1, 1)));
    }
    expect_angles(vectors, 5e-16);
  }
}

TEST(Angles, OfNeedlesKeepTheirDigits) {
  for (int k = 0; k < 300; k += 3) {
    const Vec2 needle(1, std::pow(10, -k));
    std::vector<double> angle(1);
    angles_of(std::vector{needle}, angle);
    EXPECT_NEAR(angle[0] / std::atan2(needle.y(), needle.x()), 1, 5e-16);
  }
}

TEST(Angles, AtTheEndsOfTheRange) {
  const std::vector<Vec2> vectors = {
      {0, 0}, {1, 0}, {-1, 0}, {0, 1}, {1, 1}, {-1, 1}, {1, std::sqrt(2) - 1}, {1e150, 1e-150}, {-1e150, 1e150}};
  expect_angles(vectors, 5e-16);
}

}  // namespace
}  // namespace isopath
