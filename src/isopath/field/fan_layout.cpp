#include "isopath/field/fan_layout.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <span>

#include "isopath/field/four_lanes.h"

namespace isopath {
namespace {

/// Spokes of a fan are worked out by four.
constexpr std::size_t at_once = 4;
/// What comes after the last ring is read as well, when a fan is worked out and when it is fetched.
constexpr std::size_t read_past = 8;
/// Room for this many spokes in each fan of a batch, on the average, and in one for all that there may be.
constexpr std::size_t usual_spokes = 12;

/// Saddles by less than this angle send no fan of their own: on smooth surfaces every second vertex is one, and fronts
/// stay whole there. In radians.
constexpr float slight_saddle = 0.03F;
/// From saddles by more than this, fronts are followed exactly at first.
constexpr float sharp_saddle = 0.5F;

/// The power of two next below the mean length of some thousand edges: scaling with it rounds nothing.
double unit_of(const TriangleMesh& mesh) {
  constexpr std::size_t enough = 4096;
  const std::span<const double> lengths = mesh.edge_lengths();
  const std::size_t step = 1 + lengths.size() / enough;
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t e = 0; e < lengths.size(); e += step, ++n) sum += lengths[e];
  return sum > 0 ? std::ldexp(1.0, std::ilogb(sum / static_cast<double>(n))) : 1;
}

/// The half-edge before another one in its face, without a branch, which would be guessed wrongly once in three times.
std::uint32_t before(std::uint32_t halfedge) {
  const std::uint32_t corner = halfedge % 3;
  return halfedge - 1 + 3 * static_cast<std::uint32_t>(corner == 0);
}

/// Angles from 0 to π, up to 7e-5 (Abramowitz & Stegun, Handbook of Mathematical Functions, 4.4.45).
Floats angle_of(Floats cosine) {
  const Floats size = max(cosine, -cosine);
  const Floats root = square_root(max(1 - size, all(0)));
  const Floats angle = root * (1.5707288F + size * (-0.2121144F + size * (0.0742610F - size * 0.0187293F)));
  return select(cosine < 0, std::numbers::pi_v<float> - angle, angle);
}

using Doubles = double __attribute__((vector_size(16)));
using FloatPair = float __attribute__((vector_size(8)));

Doubles two_at(const double* at) {
  Doubles two;
  std::memcpy(&two, at, sizeof(two));
  return two;
}

/// The ways from the middle of a fan to the ends of four spokes.
struct Ways {
  Floats x;
  Floats y;
  Floats z;
  Floats length;
};

/// Makes ways out of positions: differences in double precision, the rest in single.
struct Viewpoint {
  const FanLayout& layout;
  const Arrival* arrivals;
  Doubles middle_xy;
  Doubles middle_zz;
  Doubles scale;

  Viewpoint(const FanLayout& fans, std::uint32_t middle, const Arrival* known) : layout(fans), arrivals(known) {
    const Vec3& position = fans.position(middle);
    middle_xy = Doubles{position.x(), position.y()};
    middle_zz = Doubles{position.z(), position.z()};
    scale = Doubles{1 / fans.unit(), 1 / fans.unit()};
  }

  [[gnu::always_inline]] Ways ways_to(const std::uint32_t* ends) const {
    const auto xy = [&](std::size_t i) {
      __builtin_prefetch(&arrivals[ends[i]]);
      return __builtin_convertvector((two_at(layout.position(ends[i]).data()) - middle_xy) * scale, FloatPair);
    };
    const auto zz = [&](std::size_t i) {
      const Doubles two{layout.position(ends[i]).z(), layout.position(ends[i + 1]).z()};
      return __builtin_convertvector((two - middle_zz) * scale, FloatPair);
    };
    const Floats xy01 = __builtin_shufflevector(xy(0), xy(1), 0, 1, 2, 3);
    const Floats xy23 = __builtin_shufflevector(xy(2), xy(3), 0, 1, 2, 3);
    const Floats x = __builtin_shufflevector(xy01, xy23, 0, 2, 4, 6);
    const Floats y = __builtin_shufflevector(xy01, xy23, 1, 3, 5, 7);
    const Floats z = __builtin_shufflevector(zz(0), zz(2), 0, 1, 2, 3);
    return {x, y, z, square_root(x * x + y * y + z * z)};
  }
};

/// The last three lanes of four, and the first of the next four.
Floats moved_on(Floats here, Floats next) {
  const Floats with_next = __builtin_shufflevector(here, next, 4, 1, 2, 3);
  return __builtin_shufflevector(with_next, with_next, 1, 2, 3, 0);
}

}  // namespace

FanLayout::FanLayout(const TriangleMesh& mesh)
    : numbering_(mesh),
      own_positions_(numbering_.is_that_of_mesh() ? 0 : mesh.n_vertices()),
      positions_(numbering_.is_that_of_mesh() ? mesh.soup().positions.data() : own_positions_.data()),
      unit_(unit_of(mesh)),
      first_(mesh.n_vertices() + 1) {
  for (std::size_t v = 0; v < own_positions_.size(); ++v)
    own_positions_[v] = mesh.position(numbering_.vertex_in_mesh(static_cast<Index>(v)));
  lay_out_rings(LocalHalfedges(mesh, numbering_));
}

void FanLayout::lay_out_rings(const LocalHalfedges& halfedges) {
  // an end for each corner, and one more in each ring
  ends_.resize(static_cast<std::size_t>(halfedges.n_halfedges()) + static_cast<std::size_t>(halfedges.n_vertices()) +
               read_past);
  std::uint32_t* end = ends_.data();
  for (Index v = 0; v < halfedges.n_vertices(); ++v) {
    const std::uint32_t* const first = end;
    first_[v] = static_cast<std::uint32_t>(first - ends_.data());
    const Index start = halfedges.outgoing(v);
    if (start == no_index) continue;
    *end++ = static_cast<std::uint32_t>(halfedges.to(start));
    Index h = start;
    do {
      const auto back = static_cast<Index>(before(static_cast<std::uint32_t>(h)));
      *end++ = static_cast<std::uint32_t>(halfedges.from(back));
      h = halfedges.twin(back);
    } while (h != start && h != no_index);
    most_spokes_ = std::max(most_spokes_, static_cast<std::size_t>(end - first));
  }
  first_.back() = static_cast<std::uint32_t>(end - ends_.data());
  std::fill(end, ends_.data() + ends_.size(), 0);
}

FanBatch::FanBatch(const FanLayout& layout)
    : layout_(layout),
      most_numbers_(4 * (layout.most_spokes() + at_once)),
      numbers_(most_numbers_ + 4 * usual_spokes * most_fans) {}

void FanBatch::add(std::uint32_t vertex, const Arrival* arrivals) {
  const std::uint32_t* const ends = layout_.ring(vertex).data();
  const std::size_t n = layout_.ring(vertex).size();
  Fan& fan = fans_[n_fans_++];
  fan = {};
  if (n == 0) return;
  const std::size_t stride = (n + at_once - 1) / at_once * at_once;
  float* const length = numbers_.data() + n_numbers_;
  float* const next_length = length + stride;
  float* const cosine = next_length + stride;
  float* const sine = cosine + stride;
  n_numbers_ += 4 * stride;
  const Viewpoint middle(layout_, vertex, arrivals);
  Floats sums = all(0);
  Ways here = middle.ways_to(ends);
  for (std::size_t i = 0; i < n; i += at_once) {
    Ways next = here;
    if (i + at_once < n) next = middle.ways_to(ends + i + at_once);
    const Floats x = moved_on(here.x, next.x);
    const Floats y = moved_on(here.y, next.y);
    const Floats z = moved_on(here.z, next.z);
    const Floats to_next = moved_on(here.length, next.length);
    const Floats cross_x = here.y * z - here.z * y;
    const Floats cross_y = here.z * x - here.x * z;
    const Floats cross_z = here.x * y - here.y * x;
    const Floats product = here.length * to_next;
    const Ints is_face = product > 0;
    const Floats inverse = select(is_face, 1 / product, all(0));
    const Floats cosines = select(is_face, inverse * (here.x * x + here.y * y + here.z * z), all(1));
    put_words(here.length, length + i);
    put_words(to_next, next_length + i);
    put_words(cosines, cosine + i);
    put_words(inverse * square_root(cross_x * cross_x + cross_y * cross_y + cross_z * cross_z), sine + i);
    const auto faces_left = static_cast<std::int32_t>(n - 1 - i);
    const Ints counts = Ints{0, 1, 2, 3} < Ints{faces_left, faces_left, faces_left, faces_left};
    sums += select(counts, angle_of(cosines), all(0));
    here = next;
  }
  const bool closed = ends[0] == ends[n - 1];
  if (closed) {
    cosine[n - 1] = cosine[0];
    sine[n - 1] = sine[0];
  }
  const float flat = closed ? 2 * std::numbers::pi_v<float> : std::numbers::pi_v<float>;
  const float excess = (sums[0] + sums[1]) + (sums[2] + sums[3]) - flat;
  fan = {ends, n, closed, excess > slight_saddle, excess > sharp_saddle, length, next_length, cosine, sine};
}

}  // namespace isopath
