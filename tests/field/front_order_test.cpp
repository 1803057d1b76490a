#include "isopath/field/front_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/test_meshes.h"

namespace isopath {
namespace {

using Noted = FrontOrder::Noted;

TEST(FrontOrder, SortsByCoordinateUpToAHundredthOfTheRange) {
  test::Rng rng(5);
  for (const int n : {0, 1, 2, 50, 3000}) {
    std::vector<Noted> notes;
    for (Index i = 0; i < n; ++i) notes.push_back({i, static_cast<float>(test::random_real(rng, -0.3, 0.9))});
    std::vector<Noted> sorted = {{7, 7}};
    FrontOrder::sort(notes, sorted);
    EXPECT_TRUE(notes.empty());
    ASSERT_EQ(sorted.size(), static_cast<std::size_t>(n));
    float highest = -1;
    for (const Noted& noted : sorted) {
      EXPECT_GE(noted.along, highest - 0.012F);
      highest = std::max(highest, noted.along);
    }
    std::sort(sorted.begin(), sorted.end(), [](const Noted& a, const Noted& b) { return a.item < b.item; });
    for (Index i = 0; i < n; ++i) EXPECT_EQ(sorted[i].item, i);
  }
}

TEST(FrontOrder, LeavesThoseAtOnePlaceAsTheyWere) {
  for (const float apart : {0.0F, 1e-40F}) {
    std::vector<Noted> notes = {{3, 0.5F + apart}, {1, 0.5F}, {2, 0.5F + apart}};
    std::vector<Noted> sorted;
    FrontOrder::sort(notes, sorted);
    ASSERT_EQ(sorted.size(), 3);
    EXPECT_EQ(sorted[0].item, 3);
    EXPECT_EQ(sorted[1].item, 1);
    EXPECT_EQ(sorted[2].item, 2);
  }
}

/// Points of an ellipse with half axes 3 along `axis` and 1, far from the origin.
std::vector<Vec3> ellipse(const Vec3& axis, const Vec3& other) {
  std::vector<Vec3> places;
  for (int i = 0; i < 100; ++i) {
    const double angle = 2 * std::numbers::pi * i / 100;
    places.emplace_back(Vec3(1e6, 0, -1e6) + 3 * std::cos(angle) * axis + std::sin(angle) * other);
  }
  return places;
}

Box3 bounds_of(const std::vector<Vec3>& places) {
  Box3 bounds;
  for (const Vec3& place : places) bounds.extend(place);
  return bounds;
}

TEST(FrontOrder, TurnsToWhereTheFrontIsWide) {
  const Vec3 axis = Vec3(1, 2, -1).normalized();
  const Vec3 other = Vec3(1, 0, 1).normalized();
  const std::vector<Vec3> places = ellipse(axis, other);
  FrontOrder order(bounds_of(places));
  order.turn(ellipse(other, axis));
  EXPECT_TRUE(order.turn(places));
  const float wide = order.along(places[0]) - order.along(places[50]);
  const float narrow = order.along(places[25]) - order.along(places[75]);
  EXPECT_NEAR(std::abs(wide), 6 / bounds_of(places).diagonal().norm(), 1e-5);
  EXPECT_NEAR(narrow, 0, 1e-5);
}

TEST(FrontOrder, KeepsItsSenseWhenItTurns) {
  const auto axis_at = [](int k) {
    const double angle = k * std::numbers::pi / 3;
    return Vec3(std::cos(angle), std::sin(angle), 0);
  };
  FrontOrder order(bounds_of(ellipse(Vec3::UnitX(), Vec3::UnitY())));
  for (int k = 1; k < 12; ++k) {
    const std::vector<Vec3> places = ellipse(axis_at(k), Vec3::UnitZ());
    ASSERT_TRUE(order.turn(places));
    EXPECT_GT(order.along(places[0]), order.along(places[50])) << k;
  }
}

TEST(FrontOrder, StaysWhereItIsWideEnough) {
  const std::vector<Vec3> circle = [] {
    std::vector<Vec3> places = ellipse(Vec3::UnitX() / 3, Vec3::UnitY());
    return places;
  }();
  FrontOrder order(bounds_of(circle));
  EXPECT_FALSE(order.turn(circle));
}

TEST(FrontOrder, BearsAFrontThatIsAPoint) {
  const std::vector<Vec3> places(80, Vec3(1, 2, 3));
  FrontOrder order(bounds_of(places));
  order.turn(places);
  std::vector<Noted> notes(80, Noted{0, order.along(places[0])});
  std::vector<Noted> sorted;
  FrontOrder::sort(notes, sorted);
  EXPECT_EQ(sorted.size(), 80);
}

}  // namespace
}  // namespace isopath
