#pragma once

#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/exact_field.h"

namespace isopath {

/// How the distance from the boundary is blended with what lies on its medial axis (paper ch. 11).
enum class BlendForm {
  /// Raised along the axis no more than it takes to have one top: the least function above the distance that does not
  /// fall on the way to the root, carried down along the spokes. Tops that are more than two spacings from the rest
  /// stay
  /// tops: islands, whose levels are joined to the others.
  least,
  /// The paper's D_S / (D_S + D_MA), with the distance from the axis offset so that values along it fall evenly from
  /// the root to the leaves.
  paper,
};

struct BlendOptions {
  BlendForm form = BlendForm::least;
  /// Distance that levels are to keep, mm; required, > 0. Where fronts meet at an angle, levels of the least form are
  /// pulled along the axis so far that no point of it is farther than half of this from one of them.
  double spacing = 0;
  /// What corners of curves along the levels will be rounded with, mm: tips of the least form reach out by what that
  /// takes off them.
  double radius = 0;
  void validate() const;  ///< throws Error(bad_usage)
};

/// A function on the vertices whose levels are nested closed curves around one top for each component, and around those
/// of islands: where its
/// slope along a shortest path from the boundary is 1, as it is mostly, it is the distance in mm.
struct BlendedField {
  std::vector<double> values;  ///< at every vertex: 0 on the sources; infinity where these do not reach
  double spacing = 0;          ///< levels (k + ½) × spacing, k = 0 … n_levels - 1, keep what was asked for
  int n_levels = 0;            ///< of the component that has the most
  Index root = no_index;       ///< vertex of the highest value
  std::vector<Index> root_of_component;  ///< `no_index` where nothing is reached
};

/// Blends the field of a part's whole boundary (or of a source that the part is a disc without). The field's mesh has
/// to be fine: see `refine_for_blend`. Every component must be a disc, or closed: with more holes levels are not closed
/// curves around one top.
/// Throws Error(bad_usage) for invalid options, Error(no_plan) when the boundary is not all at distance 0 or nothing
/// is reached, Error(cancelled) on request.
BlendedField blend(const ExactField& field, const BlendOptions& options, const Progress& progress = Progress::none());

/// Between two sources (paper ch. 11): D* = D_a / (D_a + D_b), from 0 on the first to 1 on the second; for annuli,
/// whose axis is a circle without a root. The values at vertices. Throws Error(bad_usage) when the fields are not of
/// one mesh.
std::vector<double> blend_between(const ExactField& a, const ExactField& b);

/// The number of levels, evenly over [0, 1], that are nowhere farther apart than `spacing`: the largest of
/// 1 / (spacing × slope) over all faces but for a thousandth of the area, as single slivers have any slope.
int levels_to_keep(const TriangleMesh& mesh, std::span<const double> values, double spacing);

/// Takes away what keeps the superlevel sets of a vertex function from being connected: local tops other than the root
/// of their component are cut off at the height of their saddle, and hollows that do not lead down to where the
/// function is 0 are filled. (Priority flood: Barnes, Lehman & Mulla, "Priority-flood", Computers & Geosciences 2014.)
void leave_one_top(const TriangleMesh& mesh, const std::vector<Index>& root_of_component, std::vector<double>& values);

}  // namespace isopath
