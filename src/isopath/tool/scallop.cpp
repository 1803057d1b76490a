#include "isopath/tool/scallop.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "isopath/core/error.h"
#include "isopath/mesh/surface_walk.h"
#include "isopath/tool/ball_sweep.h"

namespace isopath {
namespace {

/// How far one goes across a pass, and how far passes are seen from there, in spacings. Most neighbours are a spacing
/// away; in a metric whose stretches go down to 1/4 they are up to four.
struct Reach {
  double walk;
  double sight;
};
constexpr Reach reaches[] = {{1.25, 1.75}, {4, 6}};
constexpr double vertex_sights[] = {0.75, 6};
constexpr int steps_per_spacing = 10;
constexpr double first_in_spacings = 0.1;  ///< nearer cusps are those of passes that run into each other
constexpr double sample_in_spacings = 0.5;
constexpr std::size_t most_samples = 6000;
constexpr double parts_of_edge = 4;  ///< the centre's way across a face is curved: pieces of it are this much shorter

/// A covering move: a straight piece of the curve in one face.
struct Move {
  Index face;
  Vec3 from;
  Vec3 to;
  double length;
};

std::vector<Move> covering_moves(const TriangleMesh& mesh, const ImpactCurve& curve) {
  std::vector<Move> moves;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    const ImpactPoint& a = curve.points[i - 1];
    const ImpactPoint& b = curve.points[i];
    if (b.kind != MoveKind::cover || !a.at.valid() || !b.at.valid()) continue;
    const Index face = common_face(mesh, a.at, b.at);
    const double length = (b.position - a.position).norm();
    if (face == no_index || !(length > mesh.tolerance().length)) continue;
    moves.push_back({face, express_in(mesh, a.at, face).barycentric, express_in(mesh, b.at, face).barycentric, length});
  }
  return moves;
}

std::vector<BallSweep::Segment> centre_segments(const TriangleMesh& mesh, const CurvedSurface& surface,
                                                const std::vector<Move>& moves, double radius, double longest) {
  std::vector<BallSweep::Segment> segments;
  for (const Move& move : moves) {
    double edge = 0;
    for (Index h = 3 * move.face; h < 3 * move.face + 3; ++h) edge = std::max(edge, mesh.edge_length(mesh.edge_of(h)));
    const double piece = std::min(edge / parts_of_edge, 0.5 * longest);
    const int parts = static_cast<int>(std::clamp(std::ceil(move.length / piece), 1.0, 1e6));
    Vec3 last = Vec3::Zero();
    for (int k = 0; k <= parts; ++k) {
      const double t = static_cast<double>(k) / parts;
      const CurvedSurface::Point point = surface.at({move.face, (1 - t) * move.from + t * move.to});
      const Vec3 centre = point.position + radius * point.normal;
      if (k > 0) segments.push_back({last, centre});
      last = centre;
    }
  }
  return segments;
}

/// Only rounding along an edge could make a way this long.
constexpr std::size_t most_pieces = 10000;

/// The way straight across a pass: where a plane cuts the mesh, face by face.
class StraightWay {
 public:
  /// From inside a face, in the plane with this normal, on its left (seen along the normal) or on its right.
  StraightWay(const TriangleMesh& mesh, const SurfacePoint& start, const Vec3& plane, bool left, double longest) {
    SurfacePoint here = start;
    double arc = 0;
    while (arc < longest && pieces_.size() < most_pieces) {
      const Vec3 n = mesh.face_normal(here.face);
      const Vec3 direction = left ? n.cross(plane) : plane.cross(n);
      int side = -1;
      const double limit = way_out(mesh, here, direction.stableNormalized(), n, side);
      if (side < 0) break;
      pieces_.push_back({here.face, here.barycentric, here.barycentric, arc, arc + limit});
      Vec3& end = pieces_.back().to;
      for (int i = 0; i < 3; ++i) end[i] += limit * rate_[i];
      end[side] = 0;
      end = end.cwiseMax(0) / end.cwiseMax(0).sum();
      arc += limit;
      const Index twin = mesh.twin(3 * here.face + (side + 1) % 3);
      if (twin == no_index || support_of(mesh, {here.face, end}).kind != Support::Kind::edge) break;
      here = express_in(mesh, {here.face, end}, TriangleMesh::face_of(twin));
    }
  }

  double length() const { return pieces_.empty() ? 0 : pieces_.back().past; }
  SurfacePoint at(double arc) const {
    std::size_t i = 0;
    while (i + 1 < pieces_.size() && pieces_[i].past < arc) ++i;
    const Piece& piece = pieces_[i];
    const double span = piece.past - piece.first;
    const double t = span > 0 ? std::clamp((arc - piece.first) / span, 0.0, 1.0) : 0;
    return {piece.face, (1 - t) * piece.from + t * piece.to};
  }

 private:
  struct Piece {
    Index face;
    Vec3 from;
    Vec3 to;
    double first;
    double past;
  };

  /// How far it is to the side of the face that the direction leads to.
  double way_out(const TriangleMesh& mesh, const SurfacePoint& from, const Vec3& direction, const Vec3& n, int& side) {
    const double twice_area = 2 * mesh.face_area(from.face);
    double limit = infinity;
    if (!(twice_area > 0)) return limit;
    const Triangle& corner = mesh.triangle(from.face);
    for (int i = 0; i < 3; ++i) {
      const Vec3 opposite = mesh.position(corner[(i + 2) % 3]) - mesh.position(corner[(i + 1) % 3]);
      rate_[i] = direction.dot(n.cross(opposite)) / twice_area;
      if (!(rate_[i] < 0) || from.barycentric[i] / -rate_[i] >= limit) continue;
      limit = from.barycentric[i] / -rate_[i];
      side = i;
    }
    return limit;
  }

  std::vector<Piece> pieces_;
  Vec3 rate_ = Vec3::Zero();
};

class CuspFinder {
 public:
  CuspFinder(const TriangleMesh& mesh, const CurvedSurface& surface, const BallSweep& sweep, double spacing)
      : mesh_(mesh), surface_(surface), sweep_(sweep), spacing_(spacing) {}

  std::optional<Cusp> beside(const Move& move, double t, bool left) {
    std::optional<Cusp> cusp;
    for (const Reach& reach : reaches) {
      if (!cusp) cusp = beside(move, t, left, reach);
    }
    return cusp;
  }

 private:
  std::optional<Cusp> beside(const Move& move, double t, bool left, const Reach& reach) {
    const SurfacePoint start{move.face, (1 - t) * move.from + t * move.to};
    const Vec3 along = position_of(mesh_, {move.face, move.to}) - position_of(mesh_, {move.face, move.from});
    const StraightWay way(mesh_, start, along, left, reach.walk * spacing_);
    const CurvedSurface::Point pass = surface_.at(start);
    sweep_.near(pass.position + sweep_.radius() * pass.normal, reach.sight * spacing_, near_);
    keep_ahead(pass, left ? Vec3(pass.normal.cross(along)) : Vec3(along.cross(pass.normal)), along.normalized(), reach);
    const double step = spacing_ / steps_per_spacing;
    double top = 0;
    double top_at = 0;
    for (double arc = first_in_spacings * spacing_; arc < way.length(); arc += step) {
      const double height = height_at(way, arc);
      if (height == infinity) break;
      if (height > top) {
        top = height;
        top_at = arc;
      } else if (height < 0.5 * top) {  // down the other side
        const Cusp cusp = refined(way, top_at, step, pass.position);
        return cusp.height > 0 && cusp.height < infinity ? std::optional(cusp) : std::nullopt;
      }
    }
    return std::nullopt;
  }

  /// Leaves out what cannot be nearest on the way: passes behind, and parts that lie farther along the pass than the
  /// top of a cusp lies from either of its passes.
  void keep_ahead(const CurvedSurface::Point& pass, const Vec3& ahead, const Vec3& along, const Reach& reach) {
    const Vec3 centre = pass.position + sweep_.radius() * pass.normal;
    const double aside = 0.7 * reach.walk * spacing_;
    const double behind = -0.2 * spacing_ * ahead.norm();
    std::erase_if(near_, [&](const BallSweep::Segment& segment) {
      const Vec3 to = 0.5 * (segment.a + segment.b) - centre;
      return to.dot(ahead) < behind || std::abs(to.dot(along)) > aside;
    });
  }

  double height_at(const StraightWay& way, double arc) const {
    const CurvedSurface::Point point = surface_.at(way.at(arc));
    return sweep_.height(point.position, point.normal, near_);
  }

  /// Golden section between the steps before and after the highest one.
  Cusp refined(const StraightWay& way, double arc, double step, const Vec3& pass) const {
    constexpr double golden = 0.6180339887498949;
    double low = arc - step;
    double high = std::min(arc + step, way.length());
    for (int i = 0; i < 16; ++i) {
      const double x = high - golden * (high - low);
      const double y = low + golden * (high - low);
      if (height_at(way, x) < height_at(way, y)) {
        low = x;
      } else {
        high = y;
      }
    }
    const double top = 0.5 * (low + high);
    return {pass, surface_.at(way.at(top)).position, height_at(way, top)};
  }

  const TriangleMesh& mesh_;
  const CurvedSurface& surface_;
  const BallSweep& sweep_;
  double spacing_;
  std::vector<BallSweep::Segment> near_;
};

void find_cusps(const TriangleMesh& mesh, const CurvedSurface& surface, const BallSweep& sweep,
                const std::vector<Move>& moves, double spacing, const Progress& progress, ScallopReport& report) {
  std::vector<double> arc(1, 0.0);
  for (const Move& move : moves) arc.push_back(arc.back() + move.length);
  const auto count = std::clamp(static_cast<std::size_t>(std::min(1e9, arc.back() / (sample_in_spacings * spacing))),
                                std::size_t{1}, most_samples);
  std::vector<std::optional<Cusp>> found(2 * count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
    progress.checkpoint();
    // golden steps inside each share, so that samples do not fall into step with the mesh
    const double jitter = std::fmod(0.618034 * static_cast<double>(k), 1.0);
    const double at = arc.back() * (static_cast<double>(k) + jitter) / static_cast<double>(count);
    const auto past = std::upper_bound(arc.begin(), arc.end() - 1, at);
    const auto i = static_cast<std::size_t>(past - arc.begin()) - 1;
    CuspFinder finder(mesh, surface, sweep, spacing);
    for (const bool left : {false, true}) {
      found[2 * k + left] = finder.beside(moves[i], std::clamp((at - arc[i]) / moves[i].length, 0.0, 1.0), left);
    }
  });
  for (const std::optional<Cusp>& cusp : found) {
    if (cusp) report.cusps.push_back(*cusp);
  }
  report.open_share = 1 - static_cast<double>(report.cusps.size()) / static_cast<double>(found.size());
  if (report.cusps.empty()) return;
  std::vector<double> heights;
  for (const Cusp& cusp : report.cusps) heights.push_back(cusp.height);
  const std::size_t hundredth = heights.size() / 100;
  std::nth_element(heights.begin(), heights.end() - 1 - static_cast<std::ptrdiff_t>(hundredth), heights.end());
  report.p99 = *(heights.end() - 1 - static_cast<std::ptrdiff_t>(hundredth));
  for (const Cusp& cusp : report.cusps) {
    report.min = std::min(report.min, cusp.height);
    report.max = std::max(report.max, cusp.height);
    report.mean += cusp.height / static_cast<double>(report.cusps.size());
  }
}

void require_length(const char* what, double value) {
  if (value > 0 && std::isfinite(value)) return;
  throw Error(ErrorCode::bad_usage, "must be a positive length in mm",
              {.element = what, .value = fmt::format("{}", value)});
}

}  // namespace

double scallop_on_plane(double spacing, double ball_radius) {
  const double half = 0.5 * spacing;
  // R - sqrt(R² - w²/4) without cancellation
  return half < ball_radius ? half * half / (ball_radius + std::sqrt((ball_radius - half) * (ball_radius + half)))
                            : infinity;
}

double scallop_on_convex(double spacing, double ball_radius, double surface_radius) {
  const double sum = surface_radius + ball_radius;
  const double across = sum * std::sin(0.5 * spacing / surface_radius);
  if (!(across < ball_radius)) return infinity;
  return sum * std::cos(0.5 * spacing / surface_radius) - std::sqrt((ball_radius - across) * (ball_radius + across)) -
         surface_radius;
}

double scallop_pitch(double height, double ball_radius) {
  require_length("ball_radius", ball_radius);
  if (!(height > 0 && height < ball_radius)) {
    throw Error(ErrorCode::bad_usage, "the scallop height must lie between 0 and the ball's radius",
                {.element = "scallop", .value = fmt::format("{} mm, radius {} mm", height, ball_radius)});
  }
  return std::sqrt(8 * height * ball_radius);
}

ScallopReport measure_scallop(const TriangleMesh& mesh, const CurvedSurface& surface, const ImpactCurve& curve,
                              double ball_radius, double spacing, Progress& progress) {
  require_length("ball_radius", ball_radius);
  require_length("spacing", spacing);
  progress.stage("scallop");
  const std::vector<Move> moves = covering_moves(mesh, curve);
  if (moves.empty()) throw Error(ErrorCode::no_plan, "the curve covers nothing");
  const BallSweep sweep(centre_segments(mesh, surface, moves, ball_radius, spacing), ball_radius, spacing);
  ScallopReport report;
  find_cusps(mesh, surface, sweep, moves, spacing, progress, report);
  report.vertex_height.assign(mesh.n_vertices(), infinity);
  tbb::parallel_for(Index{0}, mesh.n_vertices(), [&](Index v) {
    if (mesh.outgoing(v) == no_index) return;
    progress.checkpoint();
    const CurvedSurface::Point point = surface.at(point_at_vertex(mesh, v));
    std::vector<BallSweep::Segment> near;
    for (const double sight : vertex_sights) {
      if (report.vertex_height[v] < infinity) continue;
      sweep.near(point.position + ball_radius * point.normal, sight * spacing, near);
      report.vertex_height[v] = sweep.height(point.position, point.normal, near);
    }
  });
  return report;
}

ScallopReport measure_scallop(const TriangleMesh& mesh, const ImpactCurve& curve, double ball_radius, double spacing,
                              Progress& progress) {
  return measure_scallop(mesh, CurvedSurface(mesh), curve, ball_radius, spacing, progress);
}

}  // namespace isopath
