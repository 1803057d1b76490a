#include "isopath/post/poses.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "isopath/tool/tool_frames.h"

namespace isopath {
namespace {

constexpr std::string_view frame_in_words =
    "z is the tool axis, from the tip towards the holder; x is the direction of travel; position is the tip; "
    "orientation is a quaternion x y z w";

std::vector<Eigen::Quaterniond> orientations(const ToolPath& path) {
  std::vector<Eigen::Quaterniond> result;
  result.reserve(path.points.size());
  Eigen::Quaterniond before = Eigen::Quaterniond::Identity();
  for (const ToolPoint& point : path.points) {
    Eigen::Quaterniond q = orientation_of(point);
    if (q.dot(before) < 0) q.coeffs() = -q.coeffs();
    result.push_back(before = q);
  }
  return result;
}

// Calls begin(piece) before the first pose of a piece and pose(point, orientation) for every point.
template <class Begin, class Pose>
void for_each_pose(const ToolPath& path, const Begin& begin, const Pose& pose) {
  const std::vector<Eigen::Quaterniond> turns = orientations(path);
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const ToolPoint& point = path.points[i];
    if (i == 0 || path.points[i - 1].piece != point.piece) begin(point.piece);
    pose(point, turns[i]);
  }
}

}  // namespace

std::string poses_yaml(const ToolPath& path) {
  std::string text = fmt::format(
      "format: isopath-poses\nversion: 1\nunits: {{length: mm, time: s, feed: mm/min}}\nframe: \"{}\"\npieces:{}\n",
      frame_in_words, path.points.empty() ? " []" : "");
  const auto append = std::back_inserter(text);
  for_each_pose(
      path, [&](Index piece) { fmt::format_to(append, "  - piece: {}\n    poses:\n", piece); },
      [&](const ToolPoint& p, const Eigen::Quaterniond& q) {
        fmt::format_to(
            append, "      - {{kind: {}, position: [{}, {}, {}], orientation: [{}, {}, {}, {}], feed: {}, time: {}}}\n",
            name_of(p.kind), p.tip.x(), p.tip.y(), p.tip.z(), q.x(), q.y(), q.z(), q.w(), p.feed_mm_per_min, p.time);
      });
  return text;
}

std::string poses_json(const ToolPath& path) {
  using Json = nlohmann::ordered_json;
  Json pieces = Json::array();
  for_each_pose(
      path,
      [&](Index piece) {
        pieces.push_back({{"piece", piece}, {"poses", Json::array()}});
      },
      [&](const ToolPoint& p, const Eigen::Quaterniond& q) {
        pieces.back()["poses"].push_back({{"kind", name_of(p.kind)},
                                          {"position", {p.tip.x(), p.tip.y(), p.tip.z()}},
                                          {"orientation", {q.x(), q.y(), q.z(), q.w()}},
                                          {"feed", p.feed_mm_per_min},
                                          {"time", p.time}});
      });
  const Json document = {{"format", "isopath-poses"},
                         {"version", 1},
                         {"units", {{"length", "mm"}, {"time", "s"}, {"feed", "mm/min"}}},
                         {"frame", frame_in_words},
                         {"pieces", std::move(pieces)}};
  return document.dump() + "\n";
}

}  // namespace isopath
