#include "isopath/plan/spiral_choice.h"

#include <fmt/format.h>

#include "isopath/plan/nested_plan.h"
#include "isopath/plan/path_figures.h"

namespace isopath {
namespace {

constexpr double lift_over_spacing = 20;
constexpr double corner_over_spacing = 5;
constexpr double nothing_to_win = 1.03;
/// Of area / spacing: strips along rims need no pass of their own.
constexpr double least_to_cover = 0.8;
/// Triangles that refine_for_blend makes of a square with a side of one spacing, in the middle of what parts take.
constexpr double triangles_in_square = 40;

std::string figures_of(const CurveCost& cost, double area, double spacing) {
  std::string text = fmt::format("{:.3f} of area / spacing", cost.length * spacing / area);
  if (!cost.finished) text += " or more";
  if (cost.lifts > 0) text += fmt::format(", {} lifts", cost.lifts);
  return text + fmt::format(", {} sharp corners", cost.sharp_corners);
}

bool has_rim_at_zero(const TriangleMesh& mesh, std::span<const double> distances) {
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (!(distances[v] < infinity) || (mesh.is_boundary_vertex(v) && distances[v] > 1e-6 * mesh.size())) return false;
  }
  return true;
}

}  // namespace

CurveCost cost_of(const ImpactCurve& curve, double spacing, bool finished) {
  const PathFigures figures = path_figures(curve, spacing);
  return {figures.cover_length + figures.links_length, figures.lifts, figures.sharp_corners, finished};
}

double as_length(const CurveCost& cost, double spacing) {
  return cost.length + spacing * (lift_over_spacing * cost.lifts + corner_over_spacing * cost.sharp_corners);
}

bool may_blend_spiral(const Job& job, const TriangleMesh& mesh, std::span<const double> distances) {
  if (job.blend != Blending::automatic || (job.pattern && job.pattern != Pattern::spiral)) return false;
  if (job.smooth > 0 || job.scallop > 0 || mesh.boundary_loops().empty()) return false;
  return nested_shape_of(mesh) == NestedShape::disc && has_rim_at_zero(mesh, distances);
}

bool may_close_two_way(const Job& job, const TriangleMesh& mesh, std::span<const double> distances) {
  if (job.blend != Blending::automatic || job.pattern != Pattern::double_spiral) return false;
  const NestedShape shape = nested_shape_of(mesh);
  return (shape == NestedShape::annulus || shape == NestedShape::holes) && has_rim_at_zero(mesh, distances);
}

double triangles_for_blend(const TriangleMesh& mesh, double spacing) {
  return mesh.n_faces() + triangles_in_square * mesh.area() / (spacing * spacing);
}

bool is_good_spiral(const CurveCost& cost, double area, double spacing) {
  return cost.lifts == 0 && cost.sharp_corners == 0 && cost.length * spacing <= nothing_to_win * area;
}

bool may_cover(const CurveCost& cost, double area, double spacing) {
  return cost.length * spacing >= least_to_cover * area;
}

std::string text_of(const SpiralChoice& choice, double area, double spacing) {
  if (choice.too_fine > 0) {
    return fmt::format(
        "by the distance alone: blending would take about {:.0f},000 triangles; --blend does it all the same",
        1e-3 * choice.too_fine);
  }
  if (choice.by_two_way) {
    const std::string two_way = figures_of(*choice.by_two_way, area, spacing);
    if (!choice.by_blend) return "two-way curve, closed as well: no double spiral is possible";
    const std::string nested = figures_of(*choice.by_blend, area, spacing);
    return choice.blended ? fmt::format("double spiral: {}; as a two-way curve {}", nested, two_way)
                          : fmt::format("two-way curve, closed as well: {}; as a double spiral {}, which --blend keeps",
                                        two_way, nested);
  }
  if (!choice.by_blend) return "by the distance alone";
  const std::string plain = figures_of(*choice.by_distance, area, spacing);
  const std::string blended = figures_of(*choice.by_blend, area, spacing);
  return choice.blended ? fmt::format("blended: {}; by the distance alone {}", blended, plain)
                        : fmt::format("by the distance alone: {}; blended {}", plain, blended);
}

}  // namespace isopath
