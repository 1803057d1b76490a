#include "isopath/plan/patch_plans.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/core/quiet_progress.h"
#include "isopath/impact/gap.h"
#include "isopath/mesh/sub_mesh.h"
#include "isopath/plan/patch_links.h"
#include "isopath/plan/plan_result.h"
#include "isopath/plan/stage_clock.h"
#include "isopath/plan/whole_plan.h"

namespace isopath {
namespace {

/// A patch's curve on the whole mesh.
PatchCurve on_whole(Index p, const SubMesh& patch, const ImpactCurve& curve) {
  PatchCurve out;
  out.patch = p;
  bool lifted = true;
  for (const ImpactPoint& point : curve.points) {
    if (!point.at.valid()) {
      lifted = true;
      continue;
    }
    if (lifted || point.kind == MoveKind::lift) out.stretches.emplace_back();
    lifted = false;
    out.stretches.back().push_back(point);
    out.stretches.back().back().at = patch.on_whole(point.at);
  }
  const std::vector<ImpactPoint>& first = out.stretches.front();
  out.closed = out.stretches.size() == 1 && first.size() > 2 &&
               (first.front().position - first.back().position).norm() <= patch.mesh.tolerance().length;
  return out;
}

/// The metric of the whole on a patch.
std::optional<IntrinsicGeometry> metric_of(const TriangleMesh& whole, const SubMesh& patch,
                                           const IntrinsicGeometry* metric) {
  if (!metric) return std::nullopt;
  std::vector<double> lengths;
  for (Index e = 0; e < patch.mesh.n_edges(); ++e) {
    const Index h = patch.mesh.halfedge_of(e);
    lengths.push_back(metric->length(whole.halfedge_of(whole.edge_of(3 * patch.face[h / 3] + h % 3))));
  }
  return IntrinsicGeometry(patch.mesh, lengths);
}

class PatchPlanner {
 public:
  PatchPlanner(const Partition& parts, const Job& job, double spacing, const IntrinsicGeometry* metric,
               Progress& progress)
      : parts_(parts), job_(job), spacing_(spacing), metric_(metric), progress_(progress) {
    job_.sources = {SourceSpec{}};
    job_.partition = {};
    // closed curves, which others can be joined to
    if (job_.blend == Blending::automatic)
      job_.blend = job_.pattern == Pattern::double_spiral ? Blending::least : Blending::none;
    if (form_of(job_.blend) && !job_.pattern) job_.pattern = Pattern::double_spiral;
    plan_.distances.assign(parts.mesh.n_vertices(), infinity);
    shown_.positions = parts.mesh.soup().positions;
    for (Index v = 0; v < parts.mesh.n_vertices(); ++v)
      plan_.display.refined.on_old.push_back(point_at_vertex(parts.mesh, v));
    plan_.display.distances.assign(parts.mesh.n_vertices(), infinity);
    is_shown_.assign(parts.mesh.n_vertices(), 0);
  }

  PatchedPlan run() {
    const std::vector<SubMesh> patches = split_mesh(parts_.mesh, parts_.patch_of_face);
    progress_.stage("patches");
    for (std::size_t p = 0; p < patches.size(); ++p) {
      progress_.at(static_cast<double>(p) / static_cast<double>(patches.size()));
      plan_patch(static_cast<Index>(p), patches[p]);
    }
    if (curves_.empty()) {
      throw Error(ErrorCode::no_plan, "no isoline lies on any patch",
                  {.element = "option spacing",
                   .value = fmt::format("{} mm", spacing_),
                   .advice = "the spacing is too wide for the part: give a smaller one"});
    }
    string_together();
    if (job_.report) plan_.display.refined.mesh = TriangleMesh(std::move(shown_));
    return std::move(plan_);
  }

 private:
  PlanResult planned(const SubMesh& patch, const IntrinsicGeometry* metric, const Job& job, Progress& quiet) const {
    PlanResult result;
    result.job = job;
    result.part.mesh = patch.mesh;
    result.spacing = spacing_;
    StageClock clock(result.times);
    plan_whole(result, metric, clock, quiet, patch.mesh.area() / parts_.mesh.area());
    for (ImpactPoint& point : result.impact.curve.points) point.at = result.trail.on_first(point.at);
    for (Contour& contour : result.impact.contours) {
      for (SurfacePoint& point : contour.points) point = result.trail.on_first(point);
    }
    return result;
  }

  /// Nothing that was blended where the patch has no such levels.
  PlanResult planned_somehow(const SubMesh& patch, const IntrinsicGeometry* metric, Progress& quiet) const {
    if (!form_of(job_.blend)) return planned(patch, metric, job_, quiet);
    try {
      return planned(patch, metric, job_, quiet);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::no_plan) throw;
    }
    Job job = job_;
    job.blend = Blending::none;
    if (job.pattern == Pattern::double_spiral) job.pattern = std::nullopt;
    return planned(patch, metric, job, quiet);
  }

  void plan_patch(Index p, const SubMesh& patch) {
    QuietProgress quiet(progress_);
    const std::optional<IntrinsicGeometry> metric = metric_of(parts_.mesh, patch, metric_);
    PatchFigures figures;
    PlanResult result;
    try {
      result = planned_somehow(patch, metric ? &*metric : nullptr, quiet);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::no_plan) throw;
      plan_.impact.warnings.push_back(
          fmt::format("a patch of {:.4g} mm² is not covered: {}", patch.mesh.area(), error.summary()));
    }
    figures.pattern = result.pattern;
    for (Index v = 0; v < patch.mesh.n_vertices() && !result.distances.empty(); ++v) {
      double& known = plan_.distances[patch.vertex[v]];
      known = std::min(known, result.distances[v]);
    }
    for (const std::string& warning : result.warnings) {
      std::vector<std::string>& all = plan_.impact.warnings;
      if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(warning);
    }
    if (job_.report) show(patch, result);
    if (!result.impact.curve.points.empty()) {
      measure(patch.mesh, result.impact.curve, metric ? &*metric : nullptr, figures, quiet);
      add_curve(p, patch, result.impact);
    }
    figures_.push_back(figures);
  }

  void measure(const TriangleMesh& mesh, const ImpactCurve& curve, const IntrinsicGeometry* metric,
               PatchFigures& figures, Progress& quiet) const {
    const GapReport gap = measure_gap(mesh, curve, spacing_, quiet, metric);
    figures.area = gap.area;
    figures.cover_length = length_of(curve, MoveKind::cover);
    figures.gap_max = gap.max;
    figures.gap_p99 = gap.p99;
    figures.evenness = gap.cv;
    figures.covered_fraction = gap.covered_fraction;
  }

  void add_curve(Index p, const SubMesh& patch, ImpactPlan& plan) {
    curves_.push_back(on_whole(p, patch, plan.curve));
    for (Contour& contour : plan.contours) {
      for (SurfacePoint& point : contour.points) point = patch.on_whole(point);
      plan_.impact.contours.push_back(std::move(contour));
    }
  }

  /// Adds the patch's picture to that of the part. Vertices of the part keep their numbers in the first patch that has
  /// them.
  void show(const SubMesh& patch, const PlanResult& result) {
    RefinedMesh& shown = plan_.display.refined;
    if (result.display.distances.empty()) {  // not covered
      for (const Index face : patch.face) {
        shown_.triangles.push_back(parts_.mesh.triangle(face));
        shown.old_face.push_back(face);
      }
      return;
    }
    const RefinedMesh& own = result.display.refined;
    std::vector<Index> number(own.on_old.size());
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (static_cast<Index>(v) < patch.mesh.n_vertices() && std::exchange(is_shown_[patch.vertex[v]], 1) == 0) {
        number[v] = patch.vertex[v];
        plan_.display.distances[number[v]] = result.display.distances[v];
        continue;
      }
      number[v] = static_cast<Index>(shown_.positions.size());
      shown_.positions.push_back(own.mesh.position(static_cast<Index>(v)));
      shown.on_old.push_back(patch.on_whole(result.trail.on_first(own.on_old[v])));
      plan_.display.distances.push_back(result.display.distances[v]);
    }
    for (Index f = 0; f < own.mesh.n_faces(); ++f) {
      const auto& [a, b, c] = own.mesh.triangle(f);
      shown_.triangles.push_back({number[a], number[b], number[c]});
      shown.old_face.push_back(patch.face[result.trail.on_first({own.old_face[f], Vec3::UnitX()}).face]);
    }
  }

  void string_together() {
    std::vector<Index> rank(parts_.n_patches, no_index);
    std::vector<Index> patch_of_curve;
    for (const PatchCurve& curve : curves_) {
      patch_of_curve.push_back(curve.patch);
      figures_[curve.patch].pieces = static_cast<Index>(curve.stretches.size());
    }
    PatchChain chain =
        chain_patches(parts_.mesh, parts_.patch_of_face, std::move(curves_), {spacing_, job_.clearance}, progress_);
    const auto comes_next = [&](Index p) {
      rank[p] = static_cast<Index>(plan_.patches.size());
      plan_.patches.push_back(figures_[p]);
    };
    for (const Index c : chain.order) comes_next(patch_of_curve[c]);
    for (Index p = 0; p < parts_.n_patches; ++p) {  // what is not covered comes last
      if (rank[p] == no_index) comes_next(p);
    }
    for (const Index p : parts_.patch_of_face) plan_.patch_of_face.push_back(rank[p]);
    if (chain.blocked_lifts > 0) {
      plan_.impact.warnings.push_back(
          fmt::format("{} lifts may touch the part: no clear way was found for them", chain.blocked_lifts));
    }
    plan_.impact.curve = std::move(chain.curve);
  }

  const Partition& parts_;
  Job job_;
  double spacing_;
  const IntrinsicGeometry* metric_;
  Progress& progress_;
  TriangleSoup shown_;
  std::vector<char> is_shown_;  // of the whole's vertices
  std::vector<PatchFigures> figures_;
  std::vector<PatchCurve> curves_;
  PatchedPlan plan_;
};

}  // namespace

PatchedPlan plan_patches(const Partition& parts, const Job& job, double spacing, const IntrinsicGeometry* metric,
                         Progress& progress) {
  return PatchPlanner(parts, job, spacing, metric, progress).run();
}

}  // namespace isopath
