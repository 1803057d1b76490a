#pragma once

#include <array>
#include <vector>

#include "isopath/contour/bisector_graph.h"
#include "isopath/contour/face_fronts.h"

namespace isopath {

/// Where two fronts count as different, and how closely their bisectors are followed.
struct BisectorRule {
  bool by_root = false;        ///< different roots; otherwise different directions
  double min_angle = 0;        ///< of directions: at least this far apart, radians
  double size = 0;             ///< of the model, mm: what tolerances are relative to
  double chord_tolerance = 0;  ///< largest distance of a chord from its bisector

  bool separates(const Front& a, const Front& b, const Vec2& p) const;
  /// False where two fronts that are nearest before and behind p, walking along a vector, go apart: from a source at p.
  bool may_meet(const Front& before, const Front& after, const Vec2& p, const Vec2& along) const;
};

/// A point where two fronts meet. Walking counter-clockwise around the triangle that it bounds, `before` is nearer
/// before it and `after` behind it.
struct FrontTie {
  Vec2 at = Vec2::Zero();
  Front before;
  Front after;
  Index id = no_index;  ///< of a point of the graph; ~k for the k-th point that the face adds
};

/// The bisectors inside one face (paper ch. 8). Shortest paths never cross a bisector, so that each tie on the boundary
/// of a triangle goes on inside: two ties are joined, three that agree on a node meet there, and everything else is
/// divided into smaller triangles.
class FaceBisectors {
 public:
  using Side = std::vector<FrontTie>;  // along one side of a triangle
  struct Output {
    Index n_points = 0;  ///< that the face adds, with the ids ~0, ~1, …
    std::vector<BisectorPiece> pieces;
  };

  FaceBisectors(const ExactFieldData& data, Index face, const BisectorRule& rule);

  const FaceFronts& fronts() const { return fronts_; }
  /// The ties along the three sides; one at a corner belongs to the end of the side that leads to it.
  Output run(const std::array<Side, 3>& sides);

 private:
  struct Triangle {
    std::array<Vec2, 3> corners;
    std::array<Side, 3> sides;
  };

  bool same(const Front& a, const Front& b, const Vec2& p, const Vec2& q) const;
  void ties_along(const Vec2& p, const Front& a, const Vec2& q, const Front& b, int depth, Side& out) const;
  void ties_between_checked(const Vec2& p, const Front& a, const Vec2& q, int depth, Side& out) const;
  double tie_parameter(const Vec2& p, const Vec2& q, const Front& a, const Front& b) const;
  bool is_nearest(const Front& front, const Vec2& p) const;
  bool divides(const Front& left, const Front& right, const Vec2& p, const Vec2& to_left) const;
  void follow(const Triangle& triangle, int depth);
  bool join(const FrontTie& from, const FrontTie& to);
  bool refine(const FrontTie& from, const FrontTie& to, int depth, std::vector<FrontTie>& inner) const;
  bool middle(const FrontTie& from, const FrontTie& to, FrontTie& found) const;
  bool meet_in_node(const Triangle& triangle, const Side& ties);
  bool meet_at(const Vec2& node, const Side& ties) const;
  bool connect_to(FrontTie node, const Side& ties);
  bool start_at_source(const Triangle& triangle, const FrontTie& tie);
  void divide(const Triangle& triangle, int depth);
  void emit(const FrontTie& from, const std::vector<FrontTie>& inner, const FrontTie& to);

  const ExactFieldData& data_;
  FaceFronts fronts_;
  BisectorRule rule_;
  double same_distance_;  // distances that differ by less are equal
  int shallowest_ = 0;    // how often the face is divided at least
  Output out_;
};

}  // namespace isopath
