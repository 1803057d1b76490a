#include "isopath/post/poses.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "post/test_paths.h"

namespace isopath {
namespace {

struct Pose {
  int piece;
  std::string kind;
  std::vector<double> position, orientation;
  double feed, time;
};

std::vector<Pose> from_json(const std::string& text) {
  const nlohmann::json document = nlohmann::json::parse(text);
  EXPECT_EQ(document.at("format"), "isopath-poses");
  EXPECT_EQ(document.at("units").at("length"), "mm");
  std::vector<Pose> poses;
  for (const auto& piece : document.at("pieces")) {
    for (const auto& p : piece.at("poses")) {
      poses.push_back(
          {piece.at("piece"), p.at("kind"), p.at("position"), p.at("orientation"), p.at("feed"), p.at("time")});
    }
  }
  return poses;
}

std::vector<Pose> from_yaml(const std::string& text) {
  const YAML::Node document = YAML::Load(text);
  EXPECT_EQ(document["format"].as<std::string>(), "isopath-poses");
  EXPECT_EQ(document["units"]["length"].as<std::string>(), "mm");
  EXPECT_TRUE(document["pieces"].IsSequence());
  std::vector<Pose> poses;
  for (const auto& piece : document["pieces"]) {
    for (const auto& p : piece["poses"]) {
      poses.push_back({piece["piece"].as<int>(), p["kind"].as<std::string>(), p["position"].as<std::vector<double>>(),
                       p["orientation"].as<std::vector<double>>(), p["feed"].as<double>(), p["time"].as<double>()});
    }
  }
  return poses;
}

void expect_same(const ToolPath& path, const std::vector<Pose>& poses) {
  ASSERT_EQ(poses.size(), path.points.size());
  Eigen::Quaterniond before = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const ToolPoint& point = path.points[i];
    const Pose& pose = poses[i];
    EXPECT_EQ(pose.piece, point.piece);
    EXPECT_EQ(pose.kind, name_of(point.kind));
    EXPECT_EQ(Vec3(pose.position.at(0), pose.position.at(1), pose.position.at(2)), point.tip);
    EXPECT_EQ(pose.feed, point.feed_mm_per_min);
    EXPECT_EQ(pose.time, point.time);
    const Eigen::Quaterniond q(pose.orientation.at(3), pose.orientation.at(0), pose.orientation.at(1),
                               pose.orientation.at(2));
    EXPECT_NEAR(q.norm(), 1, 1e-14);
    EXPECT_LT((q * Vec3::UnitZ() - point.axis).norm(), 1e-13);
    EXPECT_LT((q * Vec3::UnitX() - point.tangent).norm(), 1e-13);
    EXPECT_GE(q.dot(before), 0) << i;
    before = q;
  }
}

TEST(Poses, YamlAndJsonReadBackToThePath) {
  for (const ImpactCurve& curve : {test::cylinder_helix(), test::sphere_spiral(), test::wavy_zigzag()}) {
    const ToolPath path = test::full_path(curve);
    expect_same(path, from_json(poses_json(path)));
    expect_same(path, from_yaml(poses_yaml(path)));
  }
}

TEST(Poses, AnEmptyPathHasNoPieces) {
  EXPECT_TRUE(from_json(poses_json({})).empty());
  EXPECT_TRUE(from_yaml(poses_yaml({})).empty());
}

}  // namespace
}  // namespace isopath
