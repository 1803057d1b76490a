#pragma once

#include <memory>
#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/source.h"
#include "isopath/field/surface_function.h"

namespace isopath {

struct ExactFieldData;

struct ExactFieldOptions {
  /// Windows that start farther than this are not propagated; points beyond are unreached or bounded from above.
  double stop_distance = infinity;
  /// Most that any distance may be off, in mm; 0 for exact distances up to rounding, otherwise finite and positive.
  /// 1e-6 of the model's size saves most of the windows of a curved part. Where fronts of two sources are almost
  /// equally far, roots are then only nearest within twice this; values on the two sides of an edge may differ by as
  /// much.
  double accuracy = 0;
  /// About how far the farthest point is from the source, where the caller knows; 0 where it is to be found out. Bounds
  /// hold in any case: it tells how to hand out the accuracy.
  double expected_reach = 0;
  /// Faces that many windows or sources concern are sorted (face_trees.h), so that distances of points in them are
  /// found quickly. Takes about as long as some questions for each window, and changes no distance.
  bool many_questions = false;

  void validate() const;  ///< throws Error(bad_usage)
};

/// The exact geodesic distance field of a source set on a polyhedral surface (paper ch. 4; Mitchell, Mount &
/// Papadimitriou 1987; Bommes & Kobbelt 2007 for segments), with all its windows retained. The mesh must outlive the
/// field.
class ExactField final : public SurfaceFunction {
 public:
  /// Throws Error(bad_usage) for an empty source set or invalid options, Error(cancelled) on request.
  static ExactField compute(const TriangleMesh& mesh, const SourceSet& sources, const ExactFieldOptions& options = {},
                            Progress& progress = Progress::none());

  /// The same in a metric (paper ch. 10): distances are lengths in it, and only directions still mean space.
  static ExactField compute(const TriangleMesh& mesh, IntrinsicGeometry metric, const SourceSet& sources,
                            const ExactFieldOptions& options = {}, Progress& progress = Progress::none());

  ExactField(ExactField&&) noexcept;
  ExactField& operator=(ExactField&&) noexcept;
  ~ExactField() override;

  const TriangleMesh& mesh() const;
  /// What lengths are measured in.
  const IntrinsicGeometry& geometry() const;
  /// Distance at every vertex in the mesh's order; infinity where no source reaches.
  std::span<const double> vertex_distances() const;
  /// The largest vertex distance that is finite.
  double max_vertex_distance() const;

  /// Distance, root id and direction of a point: all that the windows of its face tell.
  struct Nearest {
    double distance = infinity;
    Index root = no_index;
    Vec3 towards_source =
        Vec3::Zero();  ///< unit vector in space along which the shortest path leaves in the face; zero on a source
  };
  Nearest nearest(const SurfacePoint& point) const;

  /// The shortest path from a point back to its root, as points on consecutive edges; both ends included.
  /// Empty where the point is unreached.
  std::vector<SurfacePoint> shortest_path(const SurfacePoint& point) const;

  /// The windows of every edge and what else the field keeps (exact_field_data.h), for algorithms that follow fronts.
  const ExactFieldData& data() const { return *data_; }

  std::size_t windows_kept() const;
  std::size_t windows_propagated() const;
  /// Throws Error(internal) where the windows contradict each other: see verify_windows (field_invariants.h). Builds
  /// with assertions (without NDEBUG) verify every field once it is computed.
  void verify() const;

  double value_at_vertex(Index vertex) const override;
  double value(const SurfacePoint& point) const override;
  /// In a metric the ascent is the steepest there, against the shortest path, and not the steepest in space.
  Slope slope(const SurfacePoint& point) const override;
  void edge_crossings(Index edge, double level, std::vector<double>& parameters) const override;
  bool linear_in_faces() const override { return false; }
  bool monotone_in_face(Index face) const override;
  double max_slope() const override;
  double lower_bound() const override { return 0; }

 private:
  explicit ExactField(std::unique_ptr<ExactFieldData> data);
  static ExactField run(std::unique_ptr<ExactFieldData> data, const ExactFieldOptions& options, Progress& progress);
  std::unique_ptr<ExactFieldData> data_;
};

}  // namespace isopath
