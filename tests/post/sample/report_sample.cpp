// Writes a report of a wavy disc with a spiral, all from formulas: report_sample FILE [RINGS [STAND_OFF]].
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include "isopath/post/report.h"

namespace {

using namespace isopath;

constexpr double radius = 60;
constexpr double spacing = 4;
constexpr double feed_mm_per_min = 1800;

double height(double x, double y) { return 7 * std::sin(x / 15) * std::cos(y / 19); }

Vec3 on_surface(double x, double y) { return {x + 100, y - 40, height(x, y)}; }

Vec3 normal_at(double x, double y) {
  const double dx = 7 / 15.0 * std::cos(x / 15) * std::cos(y / 19);
  const double dy = -7 / 19.0 * std::sin(x / 15) * std::sin(y / 19);
  return Vec3(-dx, -dy, 1).normalized();
}

double gaussian_curvature(double x, double y) {
  const double zx = 7 / 15.0 * std::cos(x / 15) * std::cos(y / 19);
  const double zy = -7 / 19.0 * std::sin(x / 15) * std::sin(y / 19);
  const double zxx = -height(x, y) / 225;
  const double zyy = -height(x, y) / 361;
  const double zxy = -7 / 285.0 * std::cos(x / 15) * std::sin(y / 19);
  return (zxx * zyy - zxy * zxy) / std::pow(1 + zx * zx + zy * zy, 2);
}

/// Rings around a centre; ring k has 6 k vertices, so that the triangles are nearly equal: 6 rings² of them.
TriangleSoup disc(int rings) {
  TriangleSoup soup;
  soup.positions.push_back(on_surface(0, 0));
  for (int k = 1; k <= rings; ++k) {
    for (int i = 0; i < 6 * k; ++i) {
      const double angle = 2 * std::numbers::pi * i / (6 * k);
      const double r = radius * k / rings;
      soup.positions.push_back(on_surface(r * std::cos(angle), r * std::sin(angle)));
    }
  }
  const auto vertex = [](int k, int i) { return k == 0 ? 0 : 1 + 3 * k * (k - 1) + i % (6 * k); };
  for (int k = 1; k <= rings; ++k) {
    for (int side = 0; side < 6; ++side) {
      for (int i = 0; i < k; ++i) {
        const int outer = vertex(k, side * k + i);
        const int outer_next = vertex(k, side * k + i + 1);
        const int inner = vertex(k - 1, side * (k - 1) + i);
        soup.triangles.push_back({outer, outer_next, inner});
        if (i + 1 < k) soup.triangles.push_back({inner, outer_next, vertex(k - 1, side * (k - 1) + i + 1)});
      }
    }
  }
  return soup;
}

struct Spiral {
  ImpactCurve impact;
  ToolPath tool;
  double angle = 0;

  void add(MoveKind kind, Index piece, const Vec3& position, const Vec3& normal) {
    ToolPoint point{.kind = kind, .piece = piece, .tip = position, .axis = normal};
    point.feed_mm_per_min = kind == MoveKind::cover ? feed_mm_per_min * (0.6 + 0.4 * normal.z()) : 2 * feed_mm_per_min;
    if (!tool.points.empty()) {
      const ToolPoint& last = tool.points.back();
      point.time = last.time + (position - last.tip).norm() / point.feed_mm_per_min * 60;
    }
    impact.points.push_back({.kind = kind, .at = {}, .position = position, .normal = normal, .piece = piece});
    tool.points.push_back(point);
  }

  void add_at(MoveKind kind, Index piece, double r) {
    const double x = r * std::cos(angle);
    const double y = r * std::sin(angle);
    add(kind, piece, on_surface(x, y), normal_at(x, y));
  }

  /// A turn of the spiral loses one spacing of radius.
  void wind(MoveKind first, Index piece, double from, double to) {
    const double step = 0.02;
    add_at(first, piece, from);
    for (double r = from - spacing * step / (2 * std::numbers::pi); r > to;
         r -= spacing * step / (2 * std::numbers::pi)) {
      angle += step;
      add_at(MoveKind::cover, piece, r);
    }
  }

  /// The outer rings, a link inwards past a gap that is left too wide, then a lift to the middle.
  void plan() {
    wind(MoveKind::cover, 0, radius - spacing / 2, 40);
    for (double r = 39.8; r > 34; r -= 0.2, angle += 0.008) add_at(MoveKind::link, 0, r);
    wind(MoveKind::link, 0, 34, 16);
    const Vec3 up(0, 0, 14);
    add(MoveKind::lift, 0, tool.points.back().tip + up, Vec3::UnitZ());
    angle += 2;
    add(MoveKind::lift, 1, on_surface(11 * std::cos(angle), 11 * std::sin(angle)) + up, Vec3::UnitZ());
    wind(MoveKind::lift, 1, 11, 0.4);
  }
};

std::vector<ReportIsoline> circles() {
  std::vector<ReportIsoline> lines;
  for (double r = spacing; r < radius; r += spacing) {
    ReportIsoline line{.points = {}, .closed = true, .level = radius - r};
    for (int i = 0; i < 240; ++i) {
      const double angle = 2 * std::numbers::pi * i / 240;
      line.points.push_back(on_surface(r * std::cos(angle), r * std::sin(angle)));
    }
    lines.push_back(line);
  }
  return lines;
}

/// A made-up gap with a ring where it is too wide.
double gap_at(double r, double angle) {
  const double fraction = std::abs(std::remainder((radius - r) / spacing - angle / (2 * std::numbers::pi), 1.0));
  return spacing * (2 * fraction + 0.45 * std::exp(-std::pow((r - 38) / 1.6, 2)));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "report_sample FILE [RINGS [STAND_OFF]]\n";
    return 2;
  }
  const TriangleMesh mesh(disc(argc > 2 ? std::atoi(argv[2]) : 60));
  Spiral spiral;
  spiral.plan();
  const double stand_off = argc > 3 ? std::atof(argv[3]) : 0;
  for (ToolPoint& point : spiral.tool.points) point.tip += stand_off * point.axis;

  VertexScalar distance{.name = "distance", .unit = "mm", .values = {}};
  VertexScalar gap{.name = "gap", .unit = "mm", .values = {}, .limit = 1.02 * spacing};
  VertexScalar curvature{.name = "Gaussian curvature", .unit = "1/mm²", .values = {}, .diverging = true};
  std::vector<double> shares(32, 0.0);
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    const double x = mesh.position(v).x() - 100;
    const double y = mesh.position(v).y() + 40;
    const double r = std::hypot(x, y);
    distance.values.push_back(radius - r);
    gap.values.push_back(r < 3 ? infinity : gap_at(r, std::atan2(y, x)));
    curvature.values.push_back(gaussian_curvature(x, y));
    const double bin = gap.values.back() / (spacing / 20);
    shares[bin < 31 ? static_cast<std::size_t>(bin) : 31] += 1.0 / mesh.n_vertices();
  }

  ReportData data{.title = "Wavy disc <sample>", .subtitle = "spiral & 4 mm", .mesh = &mesh};
  data.scalars = {distance, gap, curvature};
  data.isolines = circles();
  data.impact = &spiral.impact;
  data.tool = &spiral.tool;
  data.tables = {{"Coverage",
                  {{"Area", "11\u2009532", "mm²"},
                   {"Covered", "97.4", "%", "Share of the area whose gap is at most 1.02 × spacing."},
                   {"Greatest gap", "1.45", "× spacing", "Twice the distance to the nearest pass, at its worst."}}},
                 {"Path",
                  {{"Length of the passes", "2 846", "mm"},
                   {"Pieces", "2", "", "Covered without leaving the surface."},
                   {"Time", "1:35.1", "min"}}}};
  data.histograms = {{.title = "Gap between passes",
                      .unit = "mm",
                      .bin_width = spacing / 20,
                      .shares = shares,
                      .marks = {{spacing, "spacing"}},
                      .limit = 1.02 * spacing}};
  data.warnings = {"The gap is wider than the spacing on 2.6 % of the area, between radius 36 and 40."};
  std::ofstream(argv[1], std::ios::binary) << report_html(data);
  return 0;
}
