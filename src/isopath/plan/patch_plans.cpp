#include "isopath/plan/patch_plans.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/core/quiet_progress.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/gap.h"
#include "isopath/mesh/sub_mesh.h"
#include "isopath/plan/auto_pattern.h"
#include "isopath/plan/make_sources.h"
#include "isopath/plan/patch_links.h"

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

class PatchPlanner {
 public:
  PatchPlanner(const Partition& parts, const PatchPlanOptions& options, const RefinedMesh* display, Progress& progress)
      : parts_(parts), options_(options), display_(display), progress_(progress) {
    plan_.distances.assign(parts.mesh.n_vertices(), infinity);
    if (display) find_display_vertices();
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
                   .value = fmt::format("{} mm", options_.spacing),
                   .advice = "the spacing is too wide for the part: give a smaller one"});
    }
    string_together();
    return std::move(plan_);
  }

 private:
  void find_display_vertices() {
    const TriangleMesh& shown = display_->mesh;
    plan_.display_distances.assign(shown.n_vertices(), infinity);
    display_vertices_.resize(parts_.n_patches);
    std::vector<char> seen(shown.n_vertices(), 0);
    for (Index f = 0; f < shown.n_faces(); ++f) {
      const Index face = display_->old_face[f];
      for (const Index v : shown.triangle(f)) {
        if (std::exchange(seen[v], 1) == 0) display_vertices_[parts_.patch_of_face[face]].emplace_back(v, face);
      }
    }
  }

  struct Field {
    std::unique_ptr<SurfaceFunction> function;
    std::vector<double> at_vertices;
  };
  Field field_of(const TriangleMesh& mesh, Progress& progress) const {
    if (options_.pattern == Pattern::planar) {
      auto height = std::make_unique<VertexField>(height_field(mesh, options_.planar_direction));
      std::vector<double> values(height->values().begin(), height->values().end());
      return {std::move(height), std::move(values)};
    }
    const SourceSet sources = make_sources(mesh, std::vector{SourceSpec{}}, {}, progress);
    auto field =
        std::make_unique<ExactField>(ExactField::compute(mesh, sources, {.accuracy = options_.accuracy}, progress));
    std::vector<double> values(field->vertex_distances().begin(), field->vertex_distances().end());
    return {std::move(field), std::move(values)};
  }

  void plan_patch(Index p, const SubMesh& patch) {
    QuietProgress quiet(progress_);
    const Field field = field_of(patch.mesh, quiet);
    for (Index v = 0; v < patch.mesh.n_vertices(); ++v) {
      double& known = plan_.distances[patch.vertex[v]];
      known = std::min(known, field.at_vertices[v]);
    }
    show(p, patch, *field.function);

    ImpactOptions impact{.spacing = options_.spacing,
                         .clearance = options_.clearance,
                         .circle_radius = options_.circle_radius,
                         .circle_step = options_.circle_step,
                         .min_radius = options_.min_radius};
    PatchFigures figures;
    ImpactPlan plan;
    try {
      if (options_.pattern) {
        impact.pattern = figures.pattern = *options_.pattern;
        plan = plan_impact(patch.mesh, *field.function, impact, quiet);
      } else {
        ChosenPlan chosen = plan_by_part(patch.mesh, *field.function, field.at_vertices, impact, quiet);
        figures.pattern = chosen.pattern;
        plan = std::move(chosen.plan);
      }
    } catch (const Error& error) {
      if (error.code() != ErrorCode::no_plan) throw;
      plan_.impact.warnings.push_back(
          fmt::format("a patch of {:.4g} mm² is not covered: {}", patch.mesh.area(), error.summary()));
    }
    if (!plan.curve.points.empty()) {
      measure(patch.mesh, plan.curve, figures, quiet);
      add_curve(p, patch, plan);
    }
    figures_.push_back(figures);
  }

  void measure(const TriangleMesh& mesh, const ImpactCurve& curve, PatchFigures& figures, Progress& quiet) const {
    const GapReport gap = measure_gap(mesh, curve, options_.spacing, quiet);
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

  /// Distances at the display's vertices in this patch.
  void show(Index p, const SubMesh& patch, const SurfaceFunction& function) {
    if (!display_) return;
    for (const auto& [vertex, face] : display_vertices_[p]) {
      SurfacePoint at = express_in(parts_.mesh, display_->on_old[vertex], face);
      at.face = static_cast<Index>(std::lower_bound(patch.face.begin(), patch.face.end(), face) - patch.face.begin());
      plan_.display_distances[vertex] = function.value(at);
    }
  }

  void string_together() {
    std::vector<Index> rank(parts_.n_patches, no_index);
    std::vector<Index> patch_of_curve;
    for (const PatchCurve& curve : curves_) {
      patch_of_curve.push_back(curve.patch);
      figures_[curve.patch].pieces = static_cast<Index>(curve.stretches.size());
    }
    PatchChain chain = chain_patches(parts_.mesh, parts_.patch_of_face, std::move(curves_),
                                     {options_.spacing, options_.clearance}, progress_);
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
  const PatchPlanOptions& options_;
  const RefinedMesh* display_;
  Progress& progress_;
  std::vector<std::vector<std::pair<Index, Index>>> display_vertices_;  // of every patch, with a face of it
  std::vector<PatchFigures> figures_;
  std::vector<PatchCurve> curves_;
  PatchedPlan plan_;
};

}  // namespace

PatchedPlan plan_patches(const Partition& parts, const PatchPlanOptions& options, const RefinedMesh* display,
                         Progress& progress) {
  return PatchPlanner(parts, options, display, progress).run();
}

RefinedMesh parted(const RefinedMesh& refined, std::span<const Index> patch_of_face) {
  RefinedMesh out{{}, refined.on_old, refined.old_face};
  TriangleSoup soup = refined.mesh.soup();
  std::vector<Index> patch_of_shown;
  for (const Index face : refined.old_face) patch_of_shown.push_back(patch_of_face[face]);
  std::vector<char> used(soup.positions.size(), 0);
  for (const SubMesh& patch : split_mesh(refined.mesh, patch_of_shown)) {
    std::vector<Index> number = patch.vertex;
    for (Index& v : number) {
      if (std::exchange(used[v], 1) == 0) continue;
      soup.positions.push_back(Vec3(soup.positions[v]));
      out.on_old.push_back(SurfacePoint(out.on_old[v]));
      v = static_cast<Index>(soup.positions.size()) - 1;
    }
    for (Index f = 0; f < patch.mesh.n_faces(); ++f) {
      for (int i = 0; i < 3; ++i) soup.triangles[patch.face[f]][i] = number[patch.mesh.triangle(f)[i]];
    }
  }
  out.mesh = TriangleMesh(std::move(soup));
  return out;
}

}  // namespace isopath
