#pragma once

#include <filesystem>
#include <functional>
#include <random>
#include <span>
#include <string>

#include "isopath/mesh/surface_point.h"
#include "isopath/mesh/triangle_mesh.h"

/// Meshes of known geometry for the tests of every layer.
namespace isopath::test {

using Rng = std::mt19937_64;

/// How the cells of a grid are cut: all along the same diagonal, or along alternating ones.
enum class Diagonal { regular, union_jack };

struct GridOptions {
  Diagonal diagonal = Diagonal::regular;
  double jitter = 0;  ///< inner vertices move by up to this fraction of a cell; below 0.25 no triangle turns over
  std::uint64_t seed = 1;
};

/// Rectangle [0, width] x [0, height] in the plane z = 0 of nx by ny cells; vertex (i, j) has index j (nx + 1) + i.
TriangleMesh planar_grid(int nx, int ny, double width, double height, const GridOptions& options = {});
/// The Delaunay triangulation of some n² random points of the square [0, side]², n random ones along each side; none
/// are nearer to each other than a fifth of side / n.
TriangleMesh scattered_square(int n, double side, std::uint64_t seed);
/// The graph z = height(x, y) over the same rectangle and with the same vertices.
TriangleMesh height_grid(int nx, int ny, double width, double depth,
                         const std::function<double(double, double)>& height);
/// The cells of a planar grid of unit squares that `keep(i, j)` names; unused vertices are left out.
TriangleMesh planar_cells(int nx, int ny, const std::function<bool(int, int)>& keep);
/// Square of side 2 n without its upper right quarter; the reflex corner is at (n, n).
TriangleMesh l_shape(int n);
/// Square of side n (odd, at least 3) with a slot of width 1 from the middle of the top down to height 1.
TriangleMesh notched_square(int n);
/// Planar polygon that is star-shaped around `centre`, which becomes vertex 0; the polygon runs counter-clockwise.
TriangleMesh planar_fan(const Vec2& centre, std::span<const Vec2> polygon);
/// Star of n points with the given radii.
TriangleMesh planar_star(int n, double outer, double inner);

/// Lateral surface of a prism over a regular polygon: unfolds to a strip of width `n` chords. Vertex (side i, ring j)
/// has index j n + i.
TriangleMesh open_cylinder(int n, int rings, double radius, double height);
/// n isosceles triangles around the apex, vertex 0 at height sqrt(slant^2 - radius^2), in `rings` rings; base open.
/// Vertex (side i, ring j) has index 1 + j n + i.
TriangleMesh open_cone(int n, int rings, double radius, double slant);
/// Total angle at the apex of `open_cone`.
double cone_angle(int n, double radius, double slant);
/// Cone with its base: apex vertex 0, base centre vertex n + 1.
TriangleMesh closed_pyramid(int n, double radius, double height);
TriangleMesh tetrahedron(double edge);
/// Surface of the cube [0, edge]^3, n by n cells a face.
TriangleMesh cube(int n, double edge);
/// Axis-parallel box of 12 triangles.
TriangleMesh box(const Vec3& low, const Vec3& high);
/// n (even) triangles around vertex 0, whose rim is alternately `amplitude` above and below it: angle above 2 pi.
TriangleMesh saddle_cone(int n, double radius, double amplitude);
TriangleMesh icosphere(int level, double radius);
TriangleMesh torus(int n_major, int n_minor, double major, double minor);
/// z = a sin(b x) cos(c y) over a jittered square grid of n by n cells.
TriangleMesh wavy_sheet(int n, double side, double a, double b, double c, std::uint64_t seed);
/// Half a sphere, open at the equator; vertex 0 is the pole.
TriangleMesh hemisphere(int rings, int segments, double radius);
/// A wavy elliptic disc whose boundary has one deep notch.
TriangleMesh notched_ellipse(int rings, int segments, double half_length, double half_width);
/// A twisted, cambered open blade whose triangles are about 50 times as long as wide.
TriangleMesh lofted_blade(int n_span, int n_chord);

struct RandomMeshOptions {
  int min_faces = 2;
  int max_faces = 30;
  bool closed = false;
  bool holes = false;    ///< removes some faces
  bool slivers = false;  ///< squeezes the shape and pulls some vertices close to a neighbour
};
/// A random triangulation with random vertex positions. Without `closed` it is a planar disc that was lifted.
TriangleMesh random_mesh(Rng& rng, const RandomMeshOptions& options = {});

TriangleMesh scaled(const TriangleMesh& mesh, double factor);
/// Rotated by `angle` about `axis`, then translated.
TriangleMesh moved(const TriangleMesh& mesh, const Vec3& axis, double angle, const Vec3& translation);
/// One face cut into three at a point inside it. The new vertex comes last; the face keeps its number and corners 0, 1,
/// and two faces are appended. Other faces keep their numbers.
TriangleMesh face_split(const TriangleMesh& mesh, Index face, const Vec3& barycentric);

/// Uniform in [low, high).
double random_real(Rng& rng, double low, double high);
/// Uniform in [0, n).
Index random_index(Rng& rng, Index n);
/// Of the straight ways from point to point.
double length_of(const TriangleMesh& mesh, std::span<const SurfacePoint> points);
/// Inside a face, uniform by area.
SurfacePoint random_surface_point(Rng& rng, const TriangleMesh& mesh);
/// In a face, on an edge or at a vertex, each a third of the time.
SurfacePoint random_supported_point(Rng& rng, const TriangleMesh& mesh);

/// Writes a mesh as OFF with all digits, to keep the input of a failing case.
void write_off(const TriangleMesh& mesh, const std::filesystem::path& path);

}  // namespace isopath::test
