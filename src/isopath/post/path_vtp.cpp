#include "isopath/post/path_vtp.h"

#include <string_view>
#include <vector>

#include "isopath/mesh/write_vtp.h"

namespace isopath {
namespace {

template <class Value>
VtpArray array_of(const ToolPath& path, std::string_view name, const Value& value) {
  VtpArray array{std::string(name), {}};
  array.values.reserve(path.points.size());
  for (const ToolPoint& point : path.points) array.values.push_back(value(point));
  return array;
}

VtpArray arc_length(const ToolPath& path) {
  double s = 0;
  const ToolPoint* before = nullptr;
  return array_of(path, "s", [&](const ToolPoint& point) {
    if (before != nullptr) s += (point.tip - before->tip).norm();
    before = &point;
    return s;
  });
}

double number_of(MoveKind kind) { return static_cast<double>(kind); }

void add_lines(const ToolPath& path, VtpData& data) {
  VtpArray kind{"kind", {}};
  VtpArray piece{"piece", {}};
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const ToolPoint& point = path.points[i];
    const ToolPoint& before = path.points[i - 1];
    // The first point has no move that arrives, so that its kind does not end a run.
    if (i == 1 || point.kind != before.kind || point.piece != before.piece) {
      data.lines.push_back({Index(i - 1)});
      kind.values.push_back(number_of(point.kind));
      piece.values.push_back(point.piece);
    }
    data.lines.back().push_back(Index(i));
  }
  data.cell_arrays = {kind, piece};
}

}  // namespace

std::string path_vtp(const ToolPath& path) {
  VtpData data;
  for (const ToolPoint& point : path.points) data.points.push_back(point.tip);
  add_lines(path, data);
  data.point_arrays = {
      array_of(path, "kind", [](const ToolPoint& p) { return number_of(p.kind); }),
      array_of(path, "piece", [](const ToolPoint& p) { return double(p.piece); }),
      arc_length(path),
      array_of(path, "t", [](const ToolPoint& p) { return p.time; }),
      array_of(path, "feed", [](const ToolPoint& p) { return p.feed_mm_per_min; }),
      array_of(path, "i", [](const ToolPoint& p) { return p.axis.x(); }),
      array_of(path, "j", [](const ToolPoint& p) { return p.axis.y(); }),
      array_of(path, "k", [](const ToolPoint& p) { return p.axis.z(); }),
  };
  return vtp_content(data);
}

}  // namespace isopath
