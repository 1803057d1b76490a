#include "isopath/post/report_blocks.h"

#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "isopath/post/base64.h"

namespace isopath {
namespace {

using nlohmann::json;

/// Collects the blocks of one report. Positions are taken relative to the origin, so that single precision resolves
/// a part that lies far from the zero of its file.
class Blocks {
 public:
  explicit Blocks(const Vec3& origin) : origin_(origin) {}

  void add_meta(const json& meta) {
    // A "<" inside a string could end the script element; JSON may spell it as an escape.
    std::string text;
    for (char c : meta.dump(-1, ' ', false, json::error_handler_t::replace)) {
      if (c == '<') {
        text += "\\u003c";
      } else {
        text += c;
      }
    }
    html_ += fmt::format("<script type=\"application/json\" id=\"meta\">{}</script>\n", text);
  }

  template <typename Number>
  void add(std::string_view id, const std::vector<Number>& values) {
    html_ += fmt::format("<script type=\"application/octet-stream;base64\" id=\"{}\">", id);
    html_ += base64_of(std::span<const Number>(values));
    html_ += "</script>\n";
  }

  template <typename Range, typename Get>
  void add_positions(std::string_view id, const Range& range, const Get& get) {
    add_vectors(id, range, [&](const auto& item) -> Vec3 { return get(item) - origin_; });
  }

  template <typename Range, typename Get>
  void add_vectors(std::string_view id, const Range& range, const Get& get) {
    std::vector<float> values;
    values.reserve(3 * range.size());
    for (const auto& item : range) {
      const Vec3 v = get(item);
      for (int k = 0; k < 3; ++k) values.push_back(static_cast<float>(v[k]));
    }
    add(id, values);
  }

  std::string take() { return std::move(html_); }

 private:
  Vec3 origin_;
  std::string html_;
};

json optional_number(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

bool is_refined(const ReportData& data) {
  return data.shown != nullptr && data.shown->mesh.n_faces() > data.mesh->n_faces();
}

json meta_of(const ReportData& data, const Vec3& origin) {
  json meta;
  meta["format"] = 1;
  meta["origin"] = {origin.x(), origin.y(), origin.z()};
  meta["area"] = data.mesh->area();
  meta["refined"] = is_refined(data);
  meta["scalars"] = json::array();
  for (const VertexScalar& scalar : data.scalars) {
    meta["scalars"].push_back({{"name", scalar.name},
                               {"unit", scalar.unit},
                               {"least", optional_number(scalar.least)},
                               {"greatest", optional_number(scalar.greatest)},
                               {"limit", optional_number(scalar.limit)},
                               {"diverging", scalar.diverging}});
  }
  meta["isolines_name"] = data.isolines_name;
  meta["isolines"] = json::array();
  for (const ReportIsoline& line : data.isolines) {
    meta["isolines"].push_back({{"points", line.points.size()}, {"closed", line.closed}, {"level", line.level}});
  }
  meta["histograms"] = json::array();
  for (const ReportHistogram& histogram : data.histograms) {
    json marks = json::array();
    for (const auto& mark : histogram.marks) marks.push_back({{"value", mark.value}, {"label", mark.label}});
    meta["histograms"].push_back({{"title", histogram.title},
                                  {"unit", histogram.unit},
                                  {"bin_width", histogram.bin_width},
                                  {"shares", histogram.shares},
                                  {"marks", marks},
                                  {"limit", optional_number(histogram.limit)}});
  }
  meta["impact"] = data.impact != nullptr && !data.impact->points.empty();
  meta["tool"] = data.tool != nullptr && !data.tool->points.empty();
  return meta;
}

/// Kind and piece of each move, in that order.
template <typename Points>
std::vector<std::uint32_t> moves_of(const Points& points) {
  std::vector<std::uint32_t> moves;
  moves.reserve(2 * points.size());
  for (const auto& point : points) {
    moves.push_back(static_cast<std::uint32_t>(point.kind));
    moves.push_back(static_cast<std::uint32_t>(point.piece));
  }
  return moves;
}

template <typename Points, typename Get>
std::vector<float> floats_of(const Points& points, const Get& get) {
  std::vector<float> values;
  values.reserve(points.size());
  for (const auto& point : points) values.push_back(static_cast<float>(get(point)));
  return values;
}

void add_triangles(Blocks& blocks, std::string_view id, const TriangleMesh& mesh) {
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * mesh.soup().triangles.size());
  for (const Triangle& triangle : mesh.soup().triangles) {
    for (const Index vertex : triangle) corners.push_back(static_cast<std::uint32_t>(vertex));
  }
  blocks.add(id, corners);
}

/// The shown mesh and, where it is finer than the part's own, the part's triangles (its vertices come first among the
/// shown ones) with the one that each shown triangle is a part of.
void add_mesh(Blocks& blocks, const ReportData& data) {
  const TriangleMesh& shown = data.shown != nullptr ? data.shown->mesh : *data.mesh;
  blocks.add_positions("mesh-positions", shown.soup().positions, [](const Vec3& p) { return p; });
  add_triangles(blocks, "mesh-triangles", shown);
  if (!is_refined(data)) return;
  add_triangles(blocks, "part-triangles", *data.mesh);
  blocks.add("mesh-parents", std::vector<std::uint32_t>(data.shown->old_face.begin(), data.shown->old_face.end()));
}

void add_isolines(Blocks& blocks, const std::vector<ReportIsoline>& isolines) {
  std::vector<Vec3> points;
  for (const ReportIsoline& line : isolines) points.insert(points.end(), line.points.begin(), line.points.end());
  blocks.add_positions("isoline-points", points, [](const Vec3& p) { return p; });
}

void add_impact(Blocks& blocks, const std::vector<ImpactPoint>& points) {
  blocks.add_positions("impact-points", points, [](const ImpactPoint& p) { return p.position; });
  blocks.add_vectors("impact-normals", points, [](const ImpactPoint& p) { return p.normal; });
  blocks.add("impact-moves", moves_of(points));
}

void add_tool(Blocks& blocks, const std::vector<ToolPoint>& points) {
  blocks.add_positions("tool-tips", points, [](const ToolPoint& p) { return p.tip; });
  blocks.add_vectors("tool-axes", points, [](const ToolPoint& p) { return p.axis; });
  blocks.add("tool-moves", moves_of(points));
  blocks.add("tool-feeds", floats_of(points, [](const ToolPoint& p) { return p.feed_mm_per_min; }));
  blocks.add("tool-times", floats_of(points, [](const ToolPoint& p) { return p.time; }));
}

}  // namespace

std::string report_blocks(const ReportData& data) {
  const Vec3 origin = data.mesh->bounds().isEmpty() ? Vec3(Vec3::Zero()) : Vec3(data.mesh->bounds().center());
  Blocks blocks(origin);
  const json meta = meta_of(data, origin);
  blocks.add_meta(meta);
  add_mesh(blocks, data);
  for (std::size_t i = 0; i < data.scalars.size(); ++i) {
    blocks.add(fmt::format("scalar-{}", i), floats_of(data.scalars[i].values, [](double value) { return value; }));
  }
  if (!data.isolines.empty()) add_isolines(blocks, data.isolines);
  if (meta["impact"]) add_impact(blocks, data.impact->points);
  if (meta["tool"]) add_tool(blocks, data.tool->points);
  return blocks.take();
}

}  // namespace isopath
