#pragma once

#include <span>
#include <vector>

#include "isopath/core/geometry.h"

namespace isopath {

/// What waits on a front, in the order of its places along an axis across it.
///
/// Threads that share it from both ends meet in the middle, in every round of a computation at nearly the same place:
/// so each finds in its cache what it left there, but for what lies next to where they meet. Without an order every
/// part that one takes from the other, anywhere on the front, has neighbours that are another thread's ever after.
class FrontOrder {
 public:
  struct Noted {
    Index item;
    float along;  ///< coordinate of its place
  };
  /// By bucket.
  using Notes = std::vector<std::vector<Noted>>;

  /// For places within these bounds.
  explicit FrontOrder(const Box3& bounds);

  float along(const Vec3& place) const { return static_cast<float>(axis_.dot(place - centre_)); }

  /// Lets the axis be the one along which these places spread most, if it is not nearly that; true if it turned.
  bool turn(std::span<const Vec3> places);

  /// Moves the notes into `sorted`, nearly in the order of their coordinates: those that are as good as at one place
  /// stay as they were.
  static void sort(std::vector<Noted>& notes, std::vector<Noted>& sorted);

 private:
  Vec3 centre_;
  double size_;
  Vec3 axis_;  ///< of length 1 / size
};

}  // namespace isopath
