#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "isopath/contour/level_cut.h"

namespace isopath {

/// The level sets of one function inside one face at a time: which crossings belong together, what loops lie inside,
/// and the points between. Keeps its buffers between faces.
class FaceCutter {
 public:
  /// A crossing on the face's boundary; in order of the half-edges, and along each of them.
  struct Event {
    Index crossing = no_index;
    Index level = no_index;
    int side = 0;          ///< which half-edge of the face
    double parameter = 0;  ///< along it
  };
  struct Output {
    std::vector<LevelCut::Piece> pieces;
    std::vector<SurfacePoint> points;
  };

  FaceCutter(const TriangleMesh& mesh, const SurfaceFunction& function, double chord_tolerance);

  void start(Index face);
  /// The levels [first, second) that could have a loop inside the face.
  std::pair<Index, Index> levels_inside(std::span<const double> levels) const;
  /// Appends the pieces of one level; `events` are those of this level only, an even number.
  void cut(Index level, double level_value, std::span<const Event> events, Output& out);

 private:
  struct Corner {
    Vec3 barycentric;
    double value = 0;    // relative to the level, its sign agreeing with `above`
    bool above = false;  // by the parity of crossings, which rounding cannot change
  };
  struct Mark {
    double parameter = 0;
    Index node = no_index;
  };
  using Side = std::vector<Mark>;  // crossings along one side of a triangle
  using Corners = std::array<Corner, 3>;
  using Sides = std::array<Side, 3>;

  double value_at(const Vec3& barycentric) const;
  double biased_at(const Vec3& barycentric) const;
  Vec2 plane(const Vec3& barycentric) const;
  Corner corner_at(const Vec3& barycentric, bool above) const;
  Side find_crossings(const Corner& a, const Corner& b, int depth);
  void find_between(const Corner& a, const Corner& b, std::array<double, 2> t, std::array<double, 2> g, int depth,
                    Side& out);
  double bisect(const Vec3& a, const Vec3& b, double t0, double g0, double t1, double g1) const;
  bool must_split(const Corners& corners, std::size_t n_crossings, int depth) const;
  bool may_hide_loop(const Corners& corners, int depth) const;
  void divide(const Corners& corners, const Sides& sides, int depth);
  void split(const Corners& corners, const Sides& sides, int depth);
  void link(const Corners& corners, const Sides& sides);
  void thin(std::vector<Vec3>& chain) const;
  void emit(Index level, Index from, Index to, std::vector<Vec3>& chain, Output& out) const;
  void refine(const Vec3& a, const Vec3& b, int depth, std::vector<SurfacePoint>& points) const;
  bool project(const Vec3& from, double g, const Vec3& direction, Vec3& found) const;

  const TriangleMesh& mesh_;
  const SurfaceFunction& function_;
  double chord_tolerance_;
  double max_slope_;
  double value_tolerance_;  // an inner point this near to its level is on it
  bool linear_;

  Index face_ = no_index;
  bool monotone_ = true;
  int deepest_ = 0;  // how often the face may be divided
  double level_value_ = 0;
  std::array<Vec2, 3> plane_;                   // the face's corners, laid into the plane
  Eigen::Matrix<double, 3, 2> to_barycentric_;  // of a step in that plane; zero for a face without area
  std::vector<Vec3> nodes_;                     // crossings: the events, then those on inner edges
  std::vector<Index> next_;                     // node that the level set leads to, the larger values on its left
};

}  // namespace isopath
