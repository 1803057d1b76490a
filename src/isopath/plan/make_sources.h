#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/source.h"
#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"
#include "isopath/plan/source_spec.h"

namespace isopath {

/// The boundary loops of a component that `auto` stands for: all of them, or the longest alone, so that passes end at
/// holes.
enum class AutoLoops { all, longest };

/// The sources that the specs name on a mesh, joined in the order given. `vertex_of_file_vertex` maps the numbers a
/// `vertex:` uses to the mesh's; `no_index` marks a vertex that the mesh no longer has.
/// Throws Error(bad_usage) naming the spec, the value and the range the mesh allows ("9000 of 8231"), or saying that
/// the spec meets nothing; Error(bad_input) naming file and line for a polyline file that cannot be read.
SourceSet make_sources(const TriangleMesh& mesh, std::span<const SourceSpec> specs,
                       std::span<const Index> vertex_of_file_vertex, Progress& progress = Progress::none(),
                       AutoLoops loops = AutoLoops::all);

/// The point of the surface that a `point:` or `vertex:` spec of one vertex names. Throws as above, and
/// Error(bad_usage) for any other spec.
SurfacePoint make_point(const TriangleMesh& mesh, const SourceSpec& spec, std::span<const Index> vertex_of_file_vertex);

/// Reads points `x,y,z`, one a line; empty lines, lines that start with '#' and a heading line are skipped.
/// Throws Error(bad_input) naming file and line.
std::vector<Vec3> read_polyline(const std::filesystem::path& path);

/// Chains of half-edges along the edges whose two faces' normals differ by more than `angle` (radians), split where
/// other than two such edges meet. A chain is closed when it ends where it starts.
std::vector<std::vector<Index>> feature_chains(const TriangleMesh& mesh, double angle);

}  // namespace isopath
