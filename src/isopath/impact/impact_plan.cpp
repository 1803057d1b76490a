#include "isopath/impact/impact_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "isopath/core/error.h"
#include "isopath/impact/curve_assembly.h"
#include "isopath/impact/finish_curve.h"
#include "isopath/impact/gap_repair.h"
#include "isopath/impact/passes.h"
#include "isopath/impact/spiral.h"
#include "isopath/impact/stroke_order.h"
#include "isopath/impact/trochoid.h"
#include "isopath/impact/two_way.h"

namespace isopath {
namespace {

/// A link on the surface passes over what is covered already; beyond a few spacings the tool rather lifts.
constexpr double longest_link_in_spacings = 8;

/// Where two fronts meet at a right angle, the gap along their ridge is 2 / (1 + sin 45°) = 1.17 spacings; passes this
/// much closer keep it within `widest_corner_gap`, so that ordinary corners need no detours.
constexpr double pass_allowance = 0.98;

/// Gate g of a run: bit 0 tells whether it is entered at its last contour, bit 1 (open runs) at the end of a contour's
/// points.
std::vector<Gate> gates_of(const TriangleMesh& mesh, const Passes& passes, const Passes::Run& run,
                           std::size_t samples) {
  std::vector<Gate> gates;
  const Contour* ends[2] = {&passes.contours[run.contours.front()], &passes.contours[run.contours.back()]};
  if (run.closed) {
    const auto places = [&](const Contour& ring) {
      return samples_of(make_curve(mesh, ring.points).positions, samples);
    };
    for (int g = 0; g < 2; ++g) gates.push_back({places(*ends[g]), places(*ends[1 - g])});
    return gates;
  }
  const auto place = [&](const Contour& contour, bool at_end) {
    return std::vector<Vec3>{position_of(mesh, at_end ? contour.points.back() : contour.points.front())};
  };
  for (int g = 0; g < 4; ++g) {
    const bool at_end = g & 2;
    // passes are walked to and fro: after an odd number of them the curve comes out on the other side
    const bool out_at_end = run.contours.size() % 2 == 1 ? !at_end : at_end;
    gates.push_back({place(*ends[g & 1], at_end), place(*ends[1 - (g & 1)], out_at_end)});
  }
  return gates;
}

void finish(const SurfaceLinker& linker, const SmoothNormals& normals, const ImpactOptions& options, ImpactPlan& plan,
            Progress& progress) {
  const bool as_they_are = options.pattern == Pattern::contour || options.pattern == Pattern::planar;
  GapLimits limits{.spacing = options.spacing,
                   .widest = as_they_are ? widest_corner_gap : widest_gap,
                   .metric = options.metric,
                   .radius = options.min_radius};
  const bool two_way = options.pattern == Pattern::two_way;
  if (limits.radius == 0 && (two_way || options.smooth_levels))
    limits.radius = default_radius_in_spacings * options.spacing;
  finish_curve(linker, normals, plan, limits,
               {.radius_first = options.min_radius > 0,
                .gently = options.smooth_levels,
                .taut = (two_way || options.smooth_levels) && !options.metric},
               progress);
}

class Planner {
 public:
  Planner(const TriangleMesh& mesh, const SurfaceFunction& function, const ImpactOptions& options, Progress& progress)
      : mesh_(mesh),
        function_(function),
        options_(options),
        progress_(progress),
        locator_(mesh),
        normals_(mesh),
        linker_(mesh, locator_, progress) {}

  ImpactPlan run() {
    progress_.stage("isolines");
    choose();
    if (passes_.contours.empty()) {
      throw Error(
          ErrorCode::no_plan, "no isoline lies on the surface",
          {.element = "option spacing",
           .value = fmt::format("{} mm", options_.spacing),
           .advice = "the source reaches nothing, or the spacing is too wide for the part: give a smaller one"});
    }
    progress_.stage("curve");
    CurveAssembly assembly(
        linker_, normals_,
        {longest_link_in_spacings * options_.spacing, options_.clearance > 0 ? options_.clearance : options_.spacing});
    if (options_.pattern == Pattern::two_way) {
      add_closed_curves(assembly);
    } else {
      add_runs(assembly);
    }
    ImpactPlan plan;
    if (assembly.blocked_lifts() > 0) {
      plan.warnings.push_back(
          fmt::format("{} lifts may touch the part: no clear way was found for them", assembly.blocked_lifts()));
    }
    plan.curve = assembly.take();
    if (options_.close_gaps) finish(linker_, normals_, options_, plan, progress_);
    plan.contours = std::move(passes_.contours);
    return plan;
  }

 private:
  /// A closed curve over all passes is free to take the layout that is shorter: runs are none of its concern.
  void choose() {
    const double spacing = (keeps_spacing() ? 1 : pass_allowance) * options_.spacing;
    passes_ = choose_passes(mesh_, function_, spacing, progress_);
    if (options_.pattern != Pattern::two_way || passes_.spacing > (1 - 1e-3) * spacing) return;
    const auto length = [&](const Passes& passes) {
      double sum = 0;
      for (const Contour& contour : passes.contours) sum += length_of(mesh_, contour);
      return sum;
    };
    Passes exact = choose_passes(mesh_, function_, spacing, progress_, PassLayout::exact);
    if (length(exact) < length(passes_)) passes_ = std::move(exact);
  }

  /// Where gaps are closed down to `widest_gap` every corner needs its bump, and closer passes spare none of them. In a
  /// metric for a cusp height they keep that below what is asked for.
  bool keeps_spacing() const {
    const bool as_they_are = options_.pattern == Pattern::contour || options_.pattern == Pattern::planar;
    return options_.pattern == Pattern::two_way || (!as_they_are && !options_.metric);
  }

  void add_runs(CurveAssembly& assembly) {
    std::vector<std::vector<Gate>> gates;
    const std::size_t samples = passes_.runs.size() > 100 ? 8 : 48;
    for (const Passes::Run& run : passes_.runs) gates.push_back(gates_of(mesh_, passes_, run, samples));
    const double lift_cost = 20 * options_.spacing;
    const std::vector<Visit> visits =
        order_runs(gates, longest_link_in_spacings * options_.spacing, lift_cost, progress_);
    for (std::size_t i = 0; i < visits.size(); ++i) {
      progress_.checkpoint();
      add_run(passes_.runs[visits[i].run], visits[i].gate, assembly);
      if (i + 1 < visits.size())
        approach(passes_.runs[visits[i].run], visits[i].gate, gates[visits[i + 1].run][visits[i + 1].gate], assembly);
      progress_.at(static_cast<double>(i + 1) / static_cast<double>(visits.size()));
    }
  }

  /// One closed curve for every connected part; the curves of several parts in the order of their isolines.
  void add_closed_curves(CurveAssembly& assembly) {
    for (SurfaceCurve& curve : two_way(linker_, passes_.contours, passes_.spacing, progress_)) {
      if (!assembly.empty()) {
        curve.points.pop_back();
        curve.positions.pop_back();
        curve = rotated(curve, nearest_index(curve, assembly.end()));
        const SurfacePoint first = curve.points.front();
        curve.add(mesh_, first);
      }
      assembly.add_stroke(curve);
    }
  }

  void add_run(const Passes::Run& run, std::size_t gate, CurveAssembly& assembly) {
    std::vector<const Contour*> contours;
    for (const Index c : run.contours) contours.push_back(&passes_.contours[c]);
    if (gate & 1) std::reverse(contours.begin(), contours.end());
    if (!run.closed) return add_open(contours, gate & 2, assembly);
    const auto near = [&] { return assembly.empty() ? position_of(mesh_, contours[0]->points[0]) : assembly.end(); };
    if (options_.pattern == Pattern::spiral) {
      assembly.add_stroke(spiral(linker_, function_, contours, near(), progress_));
      return;
    }
    for (const Contour* contour : contours) assembly.add_stroke(closed_from(mesh_, *contour, near()));
  }

  /// A closed run ends on a whole ring: on along that ring to where the next run is nearest.
  void approach(const Passes::Run& run, std::size_t gate, const Gate& next, CurveAssembly& assembly) const {
    if (!run.closed) return;
    const Contour& last = passes_.contours[gate & 1 ? run.contours.front() : run.contours.back()];
    const SurfaceCurve ring = closed_from(mesh_, last, assembly.end());
    std::size_t goal = 0;
    double least = infinity;
    for (const Vec3& place : next.entry) {
      const std::size_t i = nearest_index(ring, place);
      const double d = (ring.positions[i] - place).norm();
      if (d < least) {
        least = d;
        goal = i;
      }
    }
    SurfaceCurve way;
    for (std::size_t i = 0; i <= goal; ++i) way.add(mesh_, ring.points[i]);
    SurfaceCurve other_way;
    for (std::size_t i = ring.size(); i-- > goal;) other_way.add(mesh_, ring.points[i]);
    assembly.add_link(length_of(way) <= length_of(other_way) ? way : other_way);
  }

  void add_open(const std::vector<const Contour*>& contours, bool from_end, CurveAssembly& assembly) {
    for (const Contour* contour : contours) {
      SurfaceCurve stroke = make_curve(mesh_, contour->points);
      if (from_end) stroke.reverse();
      assembly.add_stroke(stroke);
      from_end = !from_end;
    }
  }

  const TriangleMesh& mesh_;
  const SurfaceFunction& function_;
  const ImpactOptions& options_;
  Progress& progress_;
  SurfaceLocator locator_;
  SmoothNormals normals_;
  SurfaceLinker linker_;
  Passes passes_;
};

}  // namespace

std::string_view name_of(Pattern pattern) {
  switch (pattern) {
    case Pattern::contour:
      return "contour";
    case Pattern::spiral:
      return "spiral";
    case Pattern::double_spiral:
      return "double-spiral";
    case Pattern::meander:
      return "meander";
    case Pattern::two_way:
      return "two-way";
    case Pattern::trochoidal:
      return "trochoidal";
    case Pattern::planar:
      return "planar";
  }
  return "";
}

void ImpactOptions::validate() const {
  const auto reject = [](const char* what, const char* element, double value) {
    throw Error(ErrorCode::bad_usage, what, {.element = element, .value = fmt::format("{}", value)});
  };
  if (!(spacing > 0 && std::isfinite(spacing))) reject("must be a positive length in mm", "option spacing", spacing);
  if (!(min_radius >= 0 && std::isfinite(min_radius)))
    reject("must be a length in mm, or 0 for the default", "option min_radius", min_radius);
  if (!(clearance >= 0 && std::isfinite(clearance)))
    reject("must be a length in mm, or 0 for the default", "option clearance", clearance);
  if (!(circle_radius >= 0 && std::isfinite(circle_radius)))
    reject("must be a length in mm, or 0 for the default", "option circle-radius", circle_radius);
  if (!(circle_step >= 0 && std::isfinite(circle_step)))
    reject("must be a length in mm, or 0 for the default", "option circle-step", circle_step);
  if (pattern == Pattern::double_spiral) {
    throw Error(ErrorCode::bad_usage, "a double spiral needs a function at the vertices: see level_spiral",
                {.element = "option pattern"});
  }
}

ImpactPlan plan_impact(const TriangleMesh& mesh, const SurfaceFunction& function, const ImpactOptions& options,
                       Progress& progress) {
  options.validate();
  if (options.pattern == Pattern::trochoidal) return plan_trochoids(mesh, function, options, progress);
  return Planner(mesh, function, options, progress).run();
}

void finish_plan(const TriangleMesh& mesh, const ImpactOptions& options, ImpactPlan& plan, Progress& progress) {
  options.validate();
  const SurfaceLocator locator(mesh);
  const SmoothNormals normals(mesh);
  finish(SurfaceLinker(mesh, locator, progress), normals, options, plan, progress);
}

}  // namespace isopath
