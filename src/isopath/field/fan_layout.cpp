#include "isopath/field/fan_layout.h"

#include <algorithm>
#include <cmath>

namespace isopath {
namespace {

/// Saddles by less than this angle send no fan of their own: on smooth surfaces every second vertex is one, and fronts
/// stay whole there. In radians.
constexpr float slight_saddle = 0.03F;
/// From saddles by more than this, fronts are followed exactly at first.
constexpr float sharp_saddle = 0.5F;

/// The power of two next below the mean edge length: scaling with it rounds nothing.
double unit_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (const double length : mesh.edge_lengths()) sum += length;
  const double mean = mesh.n_edges() > 0 ? sum / mesh.n_edges() : 0;
  return mean > 0 ? std::ldexp(1.0, std::ilogb(mean)) : 1;
}

/// A sum of angles, each from 0 to π, by turning a unit vector: exact enough, and without an arcus tangent for each.
class AngleSum {
 public:
  void add(float cosine, float sine) {
    const float x = x_ * cosine - y_ * sine;
    const float y = x_ * sine + y_ * cosine;
    const float sign = std::copysign(1.0F, y);  // a branch would be guessed wrongly twice a fan
    half_turns_ += sign < 0 ? 1 : 0;
    x_ = sign * x;
    y_ = sign * y;
  }
  /// Whether the sum is more than so many half turns and a slight angle.
  bool exceeds(int half_turns, float slight) const {
    return half_turns_ > half_turns || (half_turns_ == half_turns && (y_ > slight || x_ < 0));
  }

 private:
  float x_ = 1;
  float y_ = 0;
  int half_turns_ = 0;
};

}  // namespace

FanLayout::FanLayout(const TriangleMesh& mesh) : unit_(unit_of(mesh)), heads_(mesh.n_vertices() + 1) {
  // a spoke for each corner, and one more in each fan
  constexpr std::size_t read_at_once = 4;
  spokes_.resize(static_cast<std::size_t>(mesh.n_halfedges()) + static_cast<std::size_t>(mesh.n_vertices()) +
                 read_at_once);
  const double scale = 1 / unit_;
  std::uint32_t n_spokes = 0;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    Head& head = heads_[v];
    head = {n_spokes, false, false, false};
    const Index start = mesh.outgoing(v);
    if (start == no_index) continue;
    const Vec3& middle = mesh.position(v);
    const auto towards = [&](Index vertex) -> Vec3 { return scale * (mesh.position(vertex) - middle); };
    AngleSum total;
    Index h = start;
    Index end = mesh.to(h);
    Vec3 along = towards(end);
    auto length = static_cast<float>(std::sqrt(along.squaredNorm()));
    do {
      const Index next_end = mesh.from(TriangleMesh::prev(h));
      const Vec3 next_along = towards(next_end);
      const auto next_length = static_cast<float>(std::sqrt(next_along.squaredNorm()));
      const float product = length * next_length;
      const float inverse = product > 0 ? 1 / product : 0;
      const float cosine = product > 0 ? inverse * static_cast<float>(along.dot(next_along)) : 1;
      const float sine = inverse * std::sqrt(static_cast<float>(along.cross(next_along).squaredNorm()));
      spokes_[n_spokes++] = {static_cast<std::uint32_t>(end), length, cosine, sine};
      total.add(cosine, sine);
      end = next_end;
      along = next_along;
      length = next_length;
      h = mesh.next_outgoing(h);
    } while (h != start && h != no_index);
    head.closed = h == start;
    const FanSpoke again = spokes_[head.first];
    spokes_[n_spokes++] = head.closed ? again : FanSpoke{static_cast<std::uint32_t>(end), length, 1, 0};
    head.bends = total.exceeds(head.closed ? 2 : 1, slight_saddle);
    head.bends_sharply = total.exceeds(head.closed ? 2 : 1, sharp_saddle);
    most_spokes_ = std::max<std::size_t>(most_spokes_, n_spokes - head.first);
  }
  std::fill(spokes_.begin() + n_spokes, spokes_.end(), FanSpoke{});
  heads_[mesh.n_vertices()] = {n_spokes, false, false, false};
}

}  // namespace isopath
