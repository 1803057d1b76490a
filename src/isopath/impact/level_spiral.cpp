#include "isopath/impact/level_spiral.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "isopath/contour/blend.h"
#include "isopath/contour/level_cut.h"
#include "isopath/contour/turn_angle.h"
#include "isopath/core/error.h"
#include "isopath/impact/component_spiral.h"
#include "isopath/impact/curve_assembly.h"
#include "isopath/impact/finish_curve.h"
#include "isopath/impact/min_radius.h"
#include "isopath/impact/two_way.h"

namespace isopath {
namespace {

class LevelSpiral {
 public:
  LevelSpiral(const VertexField& function, const LevelSpiralOptions& options, Progress& progress)
      : function_(&function),
        mesh_(function.mesh()),
        options_(options),
        progress_(progress),
        locator_(mesh_),
        normals_(mesh_),
        linker_(mesh_, locator_, progress) {}

  ImpactPlan run() {
    progress_.stage("isolines");
    sort_faces();
    find_rings();
    progress_.stage("curve");
    const TurnAngle angle = find_angle();
    const double asked = options_.asked_spacing > 0 ? options_.asked_spacing : options_.spacing;
    CurveAssembly assembly(linker_, normals_, {8 * asked, options_.clearance > 0 ? options_.clearance : asked});
    for (Index c = 0; c < mesh_.n_components(); ++c) {
      progress_.at(static_cast<double>(c) / mesh_.n_components());
      for (const SurfaceCurve& curve : curves_of(c, angle)) assembly.add_stroke(curve);
    }
    ImpactPlan plan;
    if (assembly.blocked_lifts() > 0) {
      plan.warnings.push_back(
          fmt::format("{} lifts may touch the part: no clear way was found for them", assembly.blocked_lifts()));
    }
    plan.curve = assembly.take();
    const double radius = options_.min_radius > 0 ? options_.min_radius : default_radius_in_spacings * asked;
    // levels reach out for what rounding takes off them; rounded last, they would have bumps for nothing
    progress_.stage("corners");
    keep_min_radius(linker_, normals_, plan.curve, radius, progress_);
    finish_curve(linker_, normals_, plan, {.spacing = asked, .radius = radius},
                 {.radius_first = options_.min_radius > 0}, progress_);
    plan.contours = std::move(contours_);
    for (std::vector<Contour>& islands : islands_)
      std::move(islands.begin(), islands.end(), std::back_inserter(plan.contours));
    return plan;
  }

 private:
  void sort_faces() {
    faces_.resize(mesh_.n_components());
    for (Index f = 0; f < mesh_.n_faces(); ++f) {
      if (!LevelCut::is_unreached(mesh_, *function_, f)) faces_[mesh_.component_of(f)].push_back(f);
    }
  }

  void find_rings() {
    double top = 0;
    for (const double value : function_->values()) {
      if (value < infinity) top = std::max(top, value);
    }
    std::vector<double> levels;
    for (int k = 1; (k - 0.5) * options_.spacing < top; ++k) levels.push_back((k - 0.5) * options_.spacing);
    contours_ = isolines(mesh_, *function_, levels, {}, progress_);
    if (const Contour* extra = sort_rings()) {
      if (!extra->closed) refuse(*extra);
      leave_islands_out(levels);
      extra = sort_rings();
      if (extra) refuse(*extra);
    }
    if (contours_.empty()) {
      throw Error(ErrorCode::no_plan, "no isoline lies on the surface",
                  {.element = "option spacing",
                   .value = fmt::format("{} mm", options_.spacing),
                   .advice = "the spacing is too wide for the part: give a smaller one"});
    }
  }

  /// Fills the rings of the components, level by level. A contour that is not the only one of its level there, or is
  /// open; null where all are nested.
  const Contour* sort_rings() {
    rings_.assign(mesh_.n_components(), {});
    for (const Contour& contour : contours_) {
      std::vector<const Contour*>& rings = rings_[mesh_.component_of(contour.points.front().face)];
      if (!contour.closed || (!rings.empty() && rings.back()->level >= contour.level)) return &contour;
      rings.push_back(&contour);
    }
    return nullptr;
  }

  [[noreturn]] static void refuse(const Contour& contour) {
    throw Error(ErrorCode::no_plan, "the levels are not nested closed curves",
                {.element = fmt::format("level {:.6g} mm", contour.level),
                 .value = contour.closed ? "several curves" : "an open curve",
                 .advice = "blend the distances (--blend), or take the pattern two-way"});
  }

  /// Cuts off all tops but the highest one of every component; what the levels go round there become islands.
  void leave_islands_out(const std::vector<double>& levels) {
    std::vector<Index> roots(mesh_.n_components(), no_index);
    for (Index c = 0; c < mesh_.n_components(); ++c) {
      for (const Index f : faces_[c]) {
        for (const Index v : mesh_.triangle(f)) {
          if (roots[c] == no_index || function_->value_at_vertex(v) > function_->value_at_vertex(roots[c]))
            roots[c] = v;
        }
      }
    }
    std::vector<double> values(function_->values().begin(), function_->values().end());
    leave_one_top(mesh_, roots, values);
    without_islands_.emplace(mesh_, std::move(values));
    islands_.resize(mesh_.n_components());
    for (Contour& contour : contours_) {
      const bool is_cut_off = without_islands_->value(contour.points.front()) < contour.level - 1e-6 * options_.spacing;
      if (is_cut_off) islands_[mesh_.component_of(contour.points.front().face)].push_back(std::move(contour));
    }
    function_ = &*without_islands_;
    contours_ = isolines(mesh_, *function_, levels, {}, progress_);
  }

  /// Turns are counted around the top, or around the hole of an annulus.
  TurnAngle find_angle() const {
    std::vector<Index> inner(mesh_.n_components(), no_index);
    std::vector<Index> outer(mesh_.n_components(), no_index);
    for (Index c = 0; c < mesh_.n_components(); ++c) {
      if (rings_[c].empty()) continue;
      double low = infinity;
      double low_on_boundary = infinity;
      double high_on_boundary = -infinity;
      Index lowest = no_index;
      for (const Index f : faces_[c]) {
        const double value = function_->value({f, Vec3::Constant(1.0 / 3)});
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
          if (mesh_.twin(h) != no_index) continue;
          const double here =
              0.5 * (function_->value_at_vertex(mesh_.from(h)) + function_->value_at_vertex(mesh_.to(h)));
          if (here < low_on_boundary) {
            low_on_boundary = here;
            outer[c] = f;
          }
          if (here > high_on_boundary) {
            high_on_boundary = here;
            inner[c] = f;
          }
        }
        if (value < low) {
          low = value;
          lowest = f;
        }
      }
      const double last = rings_[c].back()->level;
      if (!(high_on_boundary > last)) inner[c] = top_face(c, last);
      if (outer[c] == no_index || !(low_on_boundary < rings_[c].front()->level)) outer[c] = lowest;
    }
    return turn_angle(mesh_, inner, outer, progress_);
  }

  /// The face nearest to the middle of what the last level encloses.
  Index top_face(Index c, double last) const {
    Vec3 sum = Vec3::Zero();
    double area = 0;
    const auto middle = [&](Index f) {
      const Triangle& t = mesh_.triangle(f);
      return Vec3((mesh_.position(t[0]) + mesh_.position(t[1]) + mesh_.position(t[2])) / 3);
    };
    const auto is_top = [&](Index f) { return function_->value({f, Vec3::Constant(1.0 / 3)}) > last; };
    for (const Index f : faces_[c]) {
      if (!is_top(f)) continue;
      sum += mesh_.face_area(f) * middle(f);
      area += mesh_.face_area(f);
    }
    Index best = no_index;
    double least = infinity;
    for (const Index f : faces_[c]) {
      if (area > 0 && !is_top(f)) continue;
      // where the last level encloses no face's middle, the highest face
      const double off =
          area > 0 ? (middle(f) - sum / area).squaredNorm() : -function_->value({f, Vec3::Constant(1.0 / 3)});
      if (off < least) {
        least = off;
        best = f;
      }
    }
    return best;
  }

  std::vector<SurfaceCurve> curves_of(Index c, const TurnAngle& angle) {
    const auto& rings = rings_[c];
    if (rings.empty()) return {};
    const auto n = static_cast<int>(rings.size());
    if (n <= options_.arms) {
      std::vector<Contour> few;
      for (const Contour* ring : rings) few.push_back(*ring);
      return two_way(linker_, few, options_.spacing, progress_);
    }
    std::vector<SurfaceCurve> curves;
    curves.push_back(component_spiral(linker_, *function_, angle, faces_[c], rings,
                                      {.spacing = options_.spacing, .arms = options_.arms}, progress_));
    if (islands_.empty() || islands_[c].empty()) return curves;
    return joined_to_curve(linker_, curves.front(), islands_[c], options_.spacing, progress_);
  }

  const VertexField* function_;  // without its islands
  const TriangleMesh& mesh_;
  const LevelSpiralOptions& options_;
  Progress& progress_;
  SurfaceLocator locator_;
  SmoothNormals normals_;
  SurfaceLinker linker_;
  std::vector<std::vector<Index>> faces_;  // of every component, those that are reached
  std::vector<Contour> contours_;
  std::vector<std::vector<const Contour*>> rings_;
  std::optional<VertexField> without_islands_;
  std::vector<std::vector<Contour>> islands_;  // of every component, the contours around its other tops
};

}  // namespace

void LevelSpiralOptions::validate() const {
  const auto reject = [](const char* what, const char* element, double value) {
    throw Error(ErrorCode::bad_usage, what, {.element = element, .value = fmt::format("{}", value)});
  };
  if (arms != 1 && arms != 2) reject("must be 1 or 2", "option arms", arms);
  if (!(spacing > 0 && std::isfinite(spacing))) reject("must be a positive length in mm", "option spacing", spacing);
  if (!(asked_spacing >= 0 && std::isfinite(asked_spacing)))
    reject("must be a length in mm, or 0 for the default", "option asked_spacing", asked_spacing);
  if (!(clearance >= 0 && std::isfinite(clearance)))
    reject("must be a length in mm, or 0 for the default", "option clearance", clearance);
  if (!(min_radius >= 0 && std::isfinite(min_radius)))
    reject("must be a length in mm, or 0 for the default", "option min_radius", min_radius);
}

ImpactPlan level_spiral(const VertexField& function, const LevelSpiralOptions& options, Progress& progress) {
  options.validate();
  return LevelSpiral(function, options, progress).run();
}

}  // namespace isopath
