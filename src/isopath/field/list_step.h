#pragma once

#include <cstddef>

#include "isopath/field/window_list.h"

namespace isopath {

/// How a list of windows crosses a triangle, as passes over whole lists (triangle-oriented propagation: Qin, Han, Yu,
/// Yu & Zhang 2016). Each is compiled for several instruction sets and chosen at run time; all give the same bits.
/// Arrays may be read and written up to WindowBlock::lanes places beyond the list.

/// A triangle in the frame of the half-edge by which the windows enter.
struct StepGeometry {
  double length = 0;  ///< of the half-edge
  Vec2 apex = Vec2::Zero();
  double left_length = 0;           ///< from the tail to the apex
  double right_length = 0;          ///< from the apex to the head
  Vec2 right_axis = Vec2::UnitX();  ///< from the apex to the head, a unit vector
  double rounding = 0;              ///< of coordinates
};

/// What a list tells about the apex.
struct ApexReach {
  double distance = infinity;
  double x = 0;                   ///< where the way crosses the half-edge
  Index window = -1;              ///< by which it comes
  Index direct = -1;              ///< window with the shortest straight way among those whose beams hold the apex
  double direct_x = 0;            ///< where that way crosses the half-edge
  double beaten_from = infinity;  ///< straight ways longer than this are beaten by it
  std::size_t n_left = 0;         ///< windows that reach the left edge
  std::size_t n_right = 0;        ///< windows that reach the right edge
  std::size_t past_left = 0;      ///< one past the last of those that reach the left edge
  std::size_t first_right = 0;    ///< the first of those that reach the right edge
};
/// Finds the shortest way to the apex; one that is longer by no more than the margin may be as short. Writes on which
/// side of the begin ray and of the end ray of each window the apex lies: positive on the left.
ApexReach reach_apex(const WindowArrays& windows, std::size_t n, const StepGeometry& triangle, double margin,
                     double* side_of_begin, double* side_of_end);

/// The windows' children on the edge from tail to apex (`left`, in its frame from the tail) and on the edge from apex
/// to head (`right`, from the apex), as seen from behind the edge. Of windows that hold the apex but are farther from
/// it than the best, only the rays on their own side of the best way survive ("one angle, two sides"). Return the
/// number of children and put a bound on their distances from below into `least`.
std::size_t cross_to_left(const WindowArrays& windows, std::size_t n, const StepGeometry& triangle,
                          const ApexReach& apex, const double* side_of_begin, const double* side_of_end,
                          const WindowArrays& children, double& least);
std::size_t cross_to_right(const WindowArrays& windows, std::size_t n, const StepGeometry& triangle,
                           const ApexReach& apex, const double* side_of_begin, const double* side_of_end,
                           const WindowArrays& children, double& least);

}  // namespace isopath
