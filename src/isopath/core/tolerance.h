#pragma once

namespace isopath {

/// The one tolerance rule: lengths are compared relative to the size of the model.
///
/// A coordinate of a model of size d carries a rounding error of about d·2⁻⁵³ ≈ 1.1e-16·d; a chain of a few thousand
/// unfoldings adds up to about 1e-13·d. `length` stands one decade above that: two points nearer than it are the same
/// point.
struct Tolerance {
  double length = 0;  ///< below this, a length is zero

  /// Rule for a model whose bounding box has this diagonal.
  static constexpr Tolerance of_size(double diagonal) { return {1e-12 * diagonal}; }
};

}  // namespace isopath
