#include "isopath/impact/trochoid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "isopath/contour/isolines.h"
#include "isopath/core/error.h"
#include "isopath/field/value_range.h"
#include "isopath/impact/curve_assembly.h"
#include "isopath/impact/gap_repair.h"
#include "isopath/impact/stroke_order.h"
#include "isopath/mesh/straight_walk.h"
#include "isopath/mesh/surface_walk.h"

namespace isopath {
namespace {

constexpr double full_turn = 2 * std::numbers::pi;
/// The second zero of J0 is 5.520078.
constexpr double radius_over_distance = 5.520078110286311 / full_turn;
constexpr double default_chord_over_radius = 1.0 / 500;
constexpr double default_radius_over_spacing = 3;
constexpr double longest_link_in_spacings = 8;
constexpr double lift_cost_in_spacings = 20;
/// More is a slip of the keyboard or of the unit, and would take all memory.
constexpr double most_guides = 20000;
constexpr double most_points = 2e7;

double default_circle_radius(const ImpactOptions& options, double step) {
  const double usual = default_radius_over_spacing * options.spacing;
  return options.min_radius > 0 ? std::max(usual, circle_radius_for(options.min_radius, step)) : usual;
}

/// Between two points of a circle with a chord that keeps the tolerance.
double widest_angle(const CircleOptions& options) {
  const double tolerance =
      options.chord_tolerance > 0 ? options.chord_tolerance : default_chord_over_radius * options.radius;
  return 2 * std::acos(std::max(0.0, 1 - tolerance / options.radius));
}

/// Refuses circles that make more points of a guide, or of several of this length together, than anybody wants.
void check_points(double length, const CircleOptions& options) {
  const double points = (1 + length / options.step) * full_turn / widest_angle(options);
  if (points <= most_points) return;
  throw Error(ErrorCode::bad_usage, "the circles lie too close for the part",
              {.element = "circle step",
               .value = fmt::format("{:.4g} mm makes {:.3g} points, limit {}", options.step, points, most_points),
               .advice = "give a larger one, or the unit of the mesh file when that is not mm"});
}

double signed_angle(const Vec3& from, const Vec3& to, const Vec3& normal) {
  return std::atan2(normal.dot(from.cross(to)), from.dot(to));
}

/// Carries a direction from one face's plane into the next one's, as if both were laid out flat.
Vec3 carried(const Vec3& direction, const Vec3& from_normal, const Vec3& to_normal) {
  return Eigen::Quaterniond::FromTwoVectors(from_normal, to_normal) * direction;
}

/// A guide's segments, each with the face it lies in and a direction there that is parallel all along the guide.
class Guide {
 public:
  Guide(const TriangleMesh& mesh, const SurfaceCurve& curve) : mesh_(mesh) {
    for (std::size_t i = 1; i < curve.size(); ++i) {
      const double length = (curve.positions[i] - curve.positions[i - 1]).norm();
      if (!(length > mesh.tolerance().length)) continue;
      const Index face = common_face(mesh, curve.points[i - 1], curve.points[i]);
      if (face == no_index) throw Error(ErrorCode::internal, "points of a guiding curve share no face");
      const Vec3 normal = mesh.face_normal(face);
      const Vec3 along = (curve.positions[i] - curve.positions[i - 1]) / length;
      const Vec3 parallel = segments_.empty() ? along : carried(segments_.back().parallel, normal_, normal);
      segments_.push_back({express_in(mesh, curve.points[i - 1], face).barycentric,
                           express_in(mesh, curve.points[i], face).barycentric, face, parallel, this->length()});
      end_ = segments_.back().start + length;
      normal_ = normal;
    }
    closed_ = curve.size() > 2 && (curve.positions.front() - curve.positions.back()).norm() <= mesh.tolerance().length;
  }

  bool empty() const { return segments_.empty(); }
  bool closed() const { return closed_; }
  double length() const { return end_; }

  /// How far the parallel direction has turned against itself once round a closed guide.
  double holonomy() const {
    const Vec3 first_normal = mesh_.face_normal(segments_.front().face);
    const Vec3 last = carried(segments_.back().parallel, normal_, first_normal);
    return signed_angle(segments_.front().parallel, last, first_normal);
  }

  struct Place {
    SurfacePoint at;
    Vec3 parallel;
  };
  Place at(double arc) const {
    const auto next = std::upper_bound(segments_.begin() + 1, segments_.end(), arc,
                                       [](double a, const Segment& segment) { return a < segment.start; });
    const Segment& segment = *(next - 1);
    const double end = next == segments_.end() ? end_ : next->start;
    const double t = std::clamp((arc - segment.start) / (end - segment.start), 0.0, 1.0);
    return {{segment.face, (1 - t) * segment.from + t * segment.to}, segment.parallel};
  }

 private:
  struct Segment {
    Vec3 from;  // barycentric
    Vec3 to;
    Index face;
    Vec3 parallel;
    double start;
  };
  const TriangleMesh& mesh_;
  std::vector<Segment> segments_;
  Vec3 normal_ = Vec3::UnitZ();  // of the last segment's face
  double end_ = 0;
  bool closed_ = false;
};

/// An open guide without its ends, where circles would leave the surface.
SurfaceCurve shortened(const TriangleMesh& mesh, const SurfaceCurve& guide, double by) {
  const double length = length_of(guide);
  const double low = std::min(by, 0.45 * length);
  const double high = length - low;
  SurfaceCurve out;
  double arc = 0;
  for (std::size_t i = 1; i < guide.size(); ++i) {
    const double step = (guide.positions[i] - guide.positions[i - 1]).norm();
    const Index face = common_face(mesh, guide.points[i - 1], guide.points[i]);
    const Vec3 a = express_in(mesh, guide.points[i - 1], face).barycentric;
    const Vec3 b = express_in(mesh, guide.points[i], face).barycentric;
    const auto at = [&](double s) { return SurfacePoint{face, a + (s - arc) / step * (b - a)}; };
    if (out.empty() && arc + step > low) out.add(mesh, at(low));
    if (!out.empty() && arc + step >= high) {
      out.add(mesh, at(high));
      break;
    }
    if (!out.empty()) out.add(mesh, guide.points[i]);
    arc += step;
  }
  return out;
}

class TrochoidPlanner {
 public:
  TrochoidPlanner(const TriangleMesh& mesh, const SurfaceFunction& function, const ImpactOptions& options,
                  Progress& progress)
      : mesh_(mesh),
        function_(function),
        options_(options),
        circle_{options.circle_radius, options.circle_step > 0 ? options.circle_step : options.spacing, 0},
        progress_(progress),
        locator_(mesh),
        normals_(mesh),
        linker_(mesh, locator_, progress) {
    if (circle_.radius == 0) circle_.radius = default_circle_radius(options, circle_.step);
  }

  ImpactPlan run() {
    progress_.stage("isolines");
    ImpactPlan plan;
    const double asked = circle_.radius;
    plan.contours = isolines(mesh_, function_, layout().levels, {}, progress_);
    if (plan.contours.empty()) {
      throw Error(ErrorCode::no_plan, "no guiding curve lies on the surface",
                  {.element = "option circle-radius",
                   .value = fmt::format("{} mm", asked),
                   .advice = "the source reaches nothing, or the part is too narrow: give a smaller radius"});
    }
    double length = 0;
    for (const Contour& guide : plan.contours) length += length_of(mesh_, guide);
    check_points(length, circle_);
    progress_.stage("curve");
    CurveAssembly assembly(linker_, normals_,
                           {std::max(longest_link_in_spacings * options_.spacing, 4 * circle_.radius),
                            options_.clearance > 0 ? options_.clearance : options_.spacing});
    for (const Visit& visit : order(plan.contours)) {
      add(plan.contours[visit.run], visit.gate == 1, assembly);
    }
    if (assembly.blocked_lifts() > 0) {
      plan.warnings.push_back(
          fmt::format("{} lifts may touch the part: no clear way was found for them", assembly.blocked_lifts()));
    }
    if (circle_.radius < 0.75 * asked) {
      plan.warnings.push_back(
          fmt::format("circles of {:.4g} mm instead of {:.4g} mm were taken: guides for larger ones "
                      "do not fit the part evenly",
                      circle_.radius, asked));
    }
    if (const double tightest = tightest_radius(circle_); tightest < options_.min_radius) {
      plan.warnings.push_back(fmt::format(
          "circles of {:.4g} mm whose centre moves by {:.4g} mm in a turn turn with {:.4g} mm at least, "
          "which is less than the smallest radius of {:.4g} mm: give them a larger radius or a shorter step",
          circle_.radius, circle_.step, tightest, options_.min_radius));
    }
    plan.curve = assembly.take();
    progress_.stage("wide gaps");
    // Where a longer step than the spacing is asked for, what it leaves between turns is wanted.
    const double gap = std::max(options_.spacing, circle_.step);
    if (options_.close_gaps) {
      close_wide_gaps(linker_, normals_, plan.curve, {gap, widest_corner_gap, nullptr}, progress_);
    }
    return plan;
  }

 private:
  GuideLayout layout() {
    const double tolerance = 1e-6 * mesh_.size() * function_.max_slope();
    const ValueRange range = value_range(mesh_, function_, tolerance, progress_);
    if (range.empty() || !(range.low < range.high)) return {};
    bool low_at_rim = false;
    bool low_inside = false;
    Index top = no_index;
    for (Index v = 0; v < mesh_.n_vertices(); ++v) {
      const double value = function_.value_at_vertex(v);
      if (mesh_.outgoing(v) == no_index || !(value < infinity)) continue;
      if (value <= range.low + tolerance) (mesh_.is_boundary_vertex(v) ? low_at_rim : low_inside) = true;
      if (top == no_index || value > function_.value_at_vertex(top)) top = v;
    }
    const bool top_at_rim = top != no_index && mesh_.is_boundary_vertex(top) &&
                            function_.value_at_vertex(top) >= range.high - 10 * tolerance;
    const auto lay_out = [&](double radius) {
      return guide_layout(range.low, range.high, radius, low_at_rim && !low_inside, top_at_rim);
    };
    GuideLayout found = lay_out(circle_.radius);
    if (options_.circle_radius == 0 && found.levels.size() > 1 && tightest_at(found.radius) < options_.min_radius) {
      // with one guide less, the circles that fit evenly are larger than those that were looked for
      const double distances = (range.high - range.low) / found.distance;
      found = lay_out(found.radius * distances / (distances - 1) * (1 + 1e-9));
    }
    circle_.radius = found.radius;
    return found;
  }

  double tightest_at(double radius) const { return tightest_radius({radius, circle_.step, 0}); }

  std::vector<Visit> order(const std::vector<Contour>& guides) const {
    std::vector<std::vector<Gate>> gates;
    for (const Contour& guide : guides) {
      gates.push_back(gates_of_curve(make_curve(mesh_, guide.points).positions, guide.closed));
    }
    return order_runs(gates, longest_link_in_spacings * options_.spacing, lift_cost_in_spacings * options_.spacing,
                      progress_);
  }

  void add(const Contour& contour, bool from_end, CurveAssembly& assembly) {
    const Vec3 near = assembly.empty() ? position_of(mesh_, contour.points.front()) : assembly.end();
    SurfaceCurve guide = contour.closed ? closed_from(mesh_, contour, near) : make_curve(mesh_, contour.points);
    if (from_end) guide.reverse();
    if (!contour.closed) guide = shortened(mesh_, guide, circle_.radius);
    if (!(length_of(guide) > mesh_.tolerance().length)) return;
    SurfaceCurve trace;
    for (const CirclePoint& point : trochoid(mesh_, guide, near, circle_, progress_)) linker_.extend(trace, point.at);
    assembly.add_stroke(trace);
  }

  const TriangleMesh& mesh_;
  const SurfaceFunction& function_;
  const ImpactOptions& options_;
  CircleOptions circle_;
  Progress& progress_;
  SurfaceLocator locator_;
  SmoothNormals normals_;
  SurfaceLinker linker_;
};

}  // namespace

void CircleOptions::validate() const {
  const auto reject = [](const char* element, double value, const char* limit) {
    throw Error(ErrorCode::bad_usage, "circles cannot be like this",
                {.element = element, .value = fmt::format("{}, allowed is {}", value, limit)});
  };
  if (!(radius > 0 && std::isfinite(radius))) reject("radius", radius, "a length above 0");
  if (!(step > 0 && std::isfinite(step))) reject("step", step, "a length above 0");
  if (!(chord_tolerance >= 0 && std::isfinite(chord_tolerance)))
    reject("chord_tolerance", chord_tolerance, "0 or more");
}

double tightest_radius(const CircleOptions& options) {
  const double way = std::min(options.radius, options.step / full_turn);
  return (options.radius - way) * (options.radius - way) / options.radius;
}

double circle_radius_for(double tightest, double step) {
  const double way = step / full_turn;
  return way + 0.5 * (tightest + std::sqrt(tightest * (tightest + 4 * way)));
}

std::vector<CirclePoint> trochoid(const TriangleMesh& mesh, const SurfaceCurve& curve, const Vec3& towards,
                                  const CircleOptions& options, const Progress& progress) {
  options.validate();
  const Guide guide(mesh, curve);
  if (guide.empty()) throw Error(ErrorCode::bad_usage, "a guiding curve needs a length");
  check_points(guide.length(), options);
  const double holonomy = guide.closed() ? guide.holonomy() : 0;
  const double turns = std::max(1.0, std::round(guide.length() / options.step + holonomy / full_turn));
  const double total = turns * full_turn - holonomy;

  const Guide::Place start = guide.at(0);
  const Vec3 normal = mesh.face_normal(start.at.face);
  const Vec3 way = towards - position_of(mesh, start.at);
  const Vec3 flat = way - normal.dot(way) * normal;
  const bool points_somewhere = flat.norm() > 1e-6 * options.radius;
  const double first = points_somewhere ? signed_angle(start.parallel, flat, normal) : 0.5 * std::numbers::pi;

  const auto n = static_cast<std::size_t>(std::ceil(std::abs(total) / widest_angle(options)));
  std::vector<CirclePoint> trace;
  for (std::size_t k = 0; k <= n; ++k) {
    if (k % 256 == 0) progress.checkpoint();
    const double share = static_cast<double>(k) / static_cast<double>(n);
    const Guide::Place place = guide.at(share * guide.length());
    const StraightWalk spoke = straight_walk(mesh, place.at, place.parallel, first + share * total, options.radius);
    trace.push_back({place.at, spoke.points.back()});
  }
  if (guide.closed()) trace.back() = trace.front();
  return trace;
}

GuideLayout guide_layout(double low, double high, double radius, bool rim_at_low, bool rim_at_high) {
  if (!(radius > 0) || !(low < high)) {
    throw Error(ErrorCode::bad_usage, "guides need a radius above 0 and a range",
                {.value = fmt::format("radius {}, range {} to {}", radius, low, high)});
  }
  const double below = rim_at_low ? radius_over_distance : 0.5;
  const double above = rim_at_high ? radius_over_distance : 0.5;
  const double range = high - low;
  const double between = std::max(0.0, std::ceil(range * radius_over_distance / radius - below - above));
  if (!(between < most_guides)) {
    throw Error(ErrorCode::bad_usage, "the circles are too small for the part",
                {.element = "circle radius",
                 .value = fmt::format("{:.4g} mm needs {:.3g} guides, limit {}", radius, between + 1, most_guides),
                 .advice = "give a larger one, or the unit of the mesh file when that is not mm"});
  }
  GuideLayout layout;
  layout.distance = range / (below + above + between);
  layout.radius = radius_over_distance * layout.distance;
  for (double k = 0; k <= between; ++k) layout.levels.push_back(low + (below + k) * layout.distance);
  return layout;
}

ImpactPlan plan_trochoids(const TriangleMesh& mesh, const SurfaceFunction& function, const ImpactOptions& options,
                          Progress& progress) {
  if (options.metric) {
    throw Error(ErrorCode::bad_usage, "circles are measured in space and not in a metric",
                {.element = "pattern trochoidal", .advice = "give a spacing instead of a scallop's height"});
  }
  return TrochoidPlanner(mesh, function, options, progress).run();
}

}  // namespace isopath
