#include "support/test_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace isopath::test {
namespace {

using std::numbers::pi;

/// Turns a quadrilateral a b c d (counter-clockwise) into two triangles.
void add_quad(TriangleSoup& soup, Index a, Index b, Index c, Index d, bool other_diagonal = false) {
  if (other_diagonal) {
    soup.triangles.push_back({a, b, d});
    soup.triangles.push_back({b, c, d});
  } else {
    soup.triangles.push_back({a, b, c});
    soup.triangles.push_back({a, c, d});
  }
}

TriangleSoup grid_soup(int nx, int ny, double width, double height, const GridOptions& options) {
  Rng rng(options.seed);
  TriangleSoup soup;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      double x = i;
      double y = j;
      if (i > 0 && i < nx && j > 0 && j < ny && options.jitter > 0) {
        x += random_real(rng, -options.jitter, options.jitter);
        y += random_real(rng, -options.jitter, options.jitter);
      }
      soup.positions.emplace_back(width * x / nx, height * y / ny, 0);
    }
  }
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const Index a = j * (nx + 1) + i;
      add_quad(soup, a, a + 1, a + nx + 2, a + nx + 1, options.diagonal == Diagonal::union_jack && (i + j) % 2 == 1);
    }
  }
  return soup;
}

/// Leaves out vertices that no triangle uses.
TriangleSoup compact(const TriangleSoup& soup) {
  TriangleSoup out;
  std::vector<Index> new_index(soup.positions.size(), no_index);
  for (Triangle triangle : soup.triangles) {
    for (Index& vertex : triangle) {
      if (new_index[vertex] == no_index) {
        new_index[vertex] = static_cast<Index>(out.positions.size());
        out.positions.push_back(soup.positions[vertex]);
      }
      vertex = new_index[vertex];
    }
    out.triangles.push_back(triangle);
  }
  return out;
}

/// Vertex 0 is the centre; rings of n vertices around it, outermost last.
TriangleSoup disc_soup(int rings, int n, const std::function<Vec3(double, double)>& position) {
  TriangleSoup soup;
  soup.positions.push_back(position(0, 0));
  for (int j = 1; j <= rings; ++j) {
    for (int i = 0; i < n; ++i) {
      soup.positions.push_back(position(static_cast<double>(j) / rings, 2 * pi * i / n));
    }
  }
  for (int i = 0; i < n; ++i) soup.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  for (int j = 1; j < rings; ++j) {
    for (int i = 0; i < n; ++i) {
      const Index inner = 1 + (j - 1) * n;
      const Index outer = inner + n;
      add_quad(soup, inner + i, outer + i, outer + (i + 1) % n, inner + (i + 1) % n);
    }
  }
  return soup;
}

Vec3 on_circle(double radius, double angle, double z) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

}  // namespace

TriangleMesh planar_grid(int nx, int ny, double width, double height, const GridOptions& options) {
  return TriangleMesh(grid_soup(nx, ny, width, height, options));
}

TriangleMesh height_grid(int nx, int ny, double width, double depth,
                         const std::function<double(double, double)>& height) {
  TriangleSoup soup = grid_soup(nx, ny, width, depth, {});
  for (Vec3& p : soup.positions) p.z() = height(p.x(), p.y());
  return TriangleMesh(std::move(soup));
}

TriangleMesh planar_cells(int nx, int ny, const std::function<bool(int, int)>& keep) {
  TriangleSoup soup = grid_soup(nx, ny, nx, ny, {});
  std::vector<Triangle> kept;
  for (std::size_t f = 0; f < soup.triangles.size(); ++f) {
    const int cell = static_cast<int>(f / 2);
    if (keep(cell % nx, cell / nx)) kept.push_back(soup.triangles[f]);
  }
  soup.triangles = kept;
  return TriangleMesh(compact(soup));
}

TriangleMesh l_shape(int n) {
  return planar_cells(2 * n, 2 * n, [n](int i, int j) { return i < n || j < n; });
}

TriangleMesh notched_square(int n) {
  return planar_cells(n, n, [n](int i, int j) { return i != n / 2 || j < 1; });
}

TriangleMesh planar_fan(const Vec2& centre, std::span<const Vec2> polygon) {
  TriangleSoup soup;
  soup.positions.emplace_back(centre.x(), centre.y(), 0);
  const Index n = static_cast<Index>(polygon.size());
  for (Index i = 0; i < n; ++i) {
    soup.positions.emplace_back(polygon[i].x(), polygon[i].y(), 0);
    soup.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  return TriangleMesh(std::move(soup));
}

TriangleMesh planar_star(int n, double outer, double inner) {
  std::vector<Vec2> polygon;
  for (int i = 0; i < 2 * n; ++i) {
    const double radius = i % 2 == 0 ? outer : inner;
    polygon.emplace_back(radius * std::cos(pi * i / n), radius * std::sin(pi * i / n));
  }
  return planar_fan(Vec2::Zero(), polygon);
}

TriangleMesh open_cylinder(int n, int rings, double radius, double height) {
  TriangleSoup soup;
  for (int j = 0; j <= rings; ++j) {
    for (int i = 0; i < n; ++i) soup.positions.push_back(on_circle(radius, 2 * pi * i / n, height * j / rings));
  }
  for (int j = 0; j < rings; ++j) {
    for (int i = 0; i < n; ++i) {
      const Index next = (i + 1) % n;
      add_quad(soup, j * n + i, j * n + next, (j + 1) * n + next, (j + 1) * n + i);
    }
  }
  return TriangleMesh(std::move(soup));
}

TriangleMesh open_cone(int n, int rings, double radius, double slant) {
  const double height = std::sqrt(slant * slant - radius * radius);
  return TriangleMesh(
      disc_soup(rings, n, [&](double t, double angle) { return on_circle(t * radius, angle, (1 - t) * height); }));
}

double cone_angle(int n, double radius, double slant) { return 2 * n * std::asin(radius * std::sin(pi / n) / slant); }

TriangleMesh closed_pyramid(int n, double radius, double height) {
  TriangleSoup soup;
  soup.positions.emplace_back(0, 0, height);
  for (int i = 0; i < n; ++i) soup.positions.push_back(on_circle(radius, 2 * pi * i / n, 0));
  soup.positions.emplace_back(0, 0, 0);
  for (int i = 0; i < n; ++i) {
    soup.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
    soup.triangles.push_back({n + 1, 1 + (i + 1) % n, 1 + i});
  }
  return TriangleMesh(std::move(soup));
}

TriangleMesh tetrahedron(double edge) {
  const double s = edge / std::sqrt(8.0);
  TriangleSoup soup;
  soup.positions = {{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  return TriangleMesh(std::move(soup));
}

TriangleMesh cube(int n, double edge) {
  TriangleSoup soup;
  std::map<std::array<int, 3>, Index> number;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [it, is_new] = number.try_emplace(at, static_cast<Index>(soup.positions.size()));
    if (is_new) soup.positions.push_back(edge / n * Vec3(at[0], at[1], at[2]));
    return it->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int u, int v) {
            std::array<int, 3> at{};
            at[axis] = side * n;
            at[(axis + 1) % 3] = u;
            at[(axis + 2) % 3] = v;
            return vertex(at);
          };
          const std::array<Index, 4> c = {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
          if (side == 1) {
            add_quad(soup, c[0], c[1], c[2], c[3]);
          } else {
            add_quad(soup, c[0], c[3], c[2], c[1]);
          }
        }
      }
    }
  }
  return TriangleMesh(std::move(soup));
}

TriangleMesh box(const Vec3& low, const Vec3& high) {
  TriangleSoup soup = cube(1, 1).soup();
  for (Vec3& p : soup.positions) p = low + (high - low).cwiseProduct(p);
  return TriangleMesh(std::move(soup));
}

TriangleMesh saddle_cone(int n, double radius, double amplitude) {
  TriangleSoup soup;
  soup.positions.push_back(Vec3::Zero());
  for (int i = 0; i < n; ++i) {
    soup.positions.push_back(on_circle(radius, 2 * pi * i / n, i % 2 == 0 ? amplitude : -amplitude));
    soup.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  return TriangleMesh(std::move(soup));
}

TriangleMesh icosphere(int level, double radius) {
  const double g = std::numbers::phi;
  TriangleSoup soup;
  soup.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  soup.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int step = 0; step < level; ++step) {
    std::map<std::pair<Index, Index>, Index> middle;
    std::vector<Triangle> finer;
    const auto mid = [&](Index a, Index b) {
      const auto [it, is_new] =
          middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<Index>(soup.positions.size()));
      if (is_new) soup.positions.emplace_back((soup.positions[a] + soup.positions[b]).normalized());
      return it->second;
    };
    for (Vec3& p : soup.positions) p.normalize();
    for (const auto& [a, b, c] : soup.triangles) {
      const Index ab = mid(a, b);
      const Index bc = mid(b, c);
      const Index ca = mid(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    soup.triangles = finer;
  }
  for (Vec3& p : soup.positions) p = radius * p.normalized();
  return TriangleMesh(std::move(soup));
}

TriangleMesh torus(int n_major, int n_minor, double major, double minor) {
  TriangleSoup soup;
  for (int i = 0; i < n_major; ++i) {
    for (int j = 0; j < n_minor; ++j) {
      const double v = 2 * pi * j / n_minor;
      soup.positions.push_back(on_circle(major + minor * std::cos(v), 2 * pi * i / n_major, minor * std::sin(v)));
    }
  }
  for (int i = 0; i < n_major; ++i) {
    for (int j = 0; j < n_minor; ++j) {
      const int i1 = (i + 1) % n_major;
      const int j1 = (j + 1) % n_minor;
      add_quad(soup, i * n_minor + j, i1 * n_minor + j, i1 * n_minor + j1, i * n_minor + j1);
    }
  }
  return TriangleMesh(std::move(soup));
}

TriangleMesh wavy_sheet(int n, double side, double a, double b, double c, std::uint64_t seed) {
  TriangleSoup soup = grid_soup(n, n, side, side, {.jitter = 0.2, .seed = seed});
  for (Vec3& p : soup.positions) p.z() = a * std::sin(b * p.x()) * std::cos(c * p.y());
  return TriangleMesh(std::move(soup));
}

TriangleMesh hemisphere(int rings, int segments, double radius) {
  return TriangleMesh(disc_soup(rings, segments, [&](double t, double angle) {
    return on_circle(radius * std::sin(t * pi / 2), angle, t == 1 ? 0 : radius * std::cos(t * pi / 2));
  }));
}

TriangleMesh notched_ellipse(int rings, int segments, double half_length, double half_width) {
  return TriangleMesh(disc_soup(rings, segments, [&](double t, double angle) {
    const double from_notch = std::remainder(angle - pi / 2, 2 * pi);
    const double reach = t * (1 - 0.6 * std::exp(-30 * from_notch * from_notch));
    const double x = half_length * reach * std::cos(angle);
    const double y = half_width * reach * std::sin(angle);
    return Vec3(x, y, 0.1 * half_width * std::sin(4 * x / half_width) * std::cos(3 * y / half_width));
  }));
}

TriangleMesh lofted_blade(int n_span, int n_chord) {
  const double chord = 40;
  const double span = 50 * chord / n_chord * n_span;
  TriangleSoup soup = grid_soup(n_chord, n_span, chord, span, {});
  for (Vec3& p : soup.positions) {
    const double along = p.y() / span;
    const double u = p.x() / chord - 0.5;
    const double camber = 0.12 * chord * (1 - 4 * u * u);
    const double twist = 0.6 * along;
    const double c = chord * (1 - 0.3 * along);
    p = {c * u * std::cos(twist) - camber * std::sin(twist), p.y(), c * u * std::sin(twist) + camber * std::cos(twist)};
  }
  return TriangleMesh(std::move(soup));
}

TriangleMesh scaled(const TriangleMesh& mesh, double factor) {
  TriangleSoup soup = mesh.soup();
  for (Vec3& p : soup.positions) p *= factor;
  return TriangleMesh(std::move(soup));
}

TriangleMesh moved(const TriangleMesh& mesh, const Vec3& axis, double angle, const Vec3& translation) {
  TriangleSoup soup = mesh.soup();
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  for (Vec3& p : soup.positions) p = (rotation * p + translation).eval();
  return TriangleMesh(std::move(soup));
}

TriangleMesh face_split(const TriangleMesh& mesh, Index face, const Vec3& barycentric) {
  TriangleSoup soup = mesh.soup();
  const auto [a, b, c] = soup.triangles[face];
  const Index middle = mesh.n_vertices();
  soup.positions.push_back(position_of(mesh, {face, barycentric}));
  soup.triangles[face] = {a, b, middle};
  soup.triangles.push_back({b, c, middle});
  soup.triangles.push_back({c, a, middle});
  return TriangleMesh(std::move(soup));
}

double length_of(const TriangleMesh& mesh, std::span<const SurfacePoint> points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    length += (position_of(mesh, points[i]) - position_of(mesh, points[i - 1])).norm();
  return length;
}

}  // namespace isopath::test
