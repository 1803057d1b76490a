#include "isopath/field/fan_layout.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "isopath/field/four_lanes.h"

namespace isopath {
namespace {

/// Spokes of a fan are read and written by four, and the four after them looked at.
constexpr std::size_t read_at_once = 4;

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

/// A way and what lies at its end as four words. As one, not one by one: who reads them together would wait for that.
Floats single_precision(const Vec3& way, std::uint32_t end) {
  using Doubles = double __attribute__((vector_size(16)));
  using FloatPair = float __attribute__((vector_size(8)));
  const auto xy = __builtin_convertvector(Doubles{way.x(), way.y()}, FloatPair);
  const FloatPair rest{static_cast<float>(way.z()), std::bit_cast<float>(end)};
  return __builtin_shufflevector(xy, rest, 0, 1, 2, 3);
}

/// Angles from 0 to π, up to 7e-5 (Abramowitz & Stegun, Handbook of Mathematical Functions, 4.4.45).
Floats angle_of(Floats cosine) {
  const Floats size = max(cosine, -cosine);
  const Floats root = square_root(max(1 - size, all(0)));
  const Floats angle = root * (1.5707288F + size * (-0.2121144F + size * (0.0742610F - size * 0.0187293F)));
  return cosine < 0 ? std::numbers::pi_v<float> - angle : angle;
}

/// The ways from the middle of a fan to the ends of four spokes.
struct Ways {
  Floats x;
  Floats y;
  Floats z;
  Floats length;
  Floats end;

  Ways(const FourRecords& ways, Floats squared_length)
      : x(ways.first), y(ways.second), z(ways.third), length(square_root(squared_length)), end(ways.fourth) {}
};

/// The last three lanes of four, and the first of the next four.
Floats moved_on(Floats here, Floats next) {
  const Floats with_next = __builtin_shufflevector(here, next, 4, 1, 2, 3);
  return __builtin_shufflevector(with_next, with_next, 1, 2, 3, 0);
}

/// Turns spokes that hold the way from the middle to their end in place of length, cosine and sine into what they are
/// to be, but for the last of each fan. Beside each of them is the square of its length, and after that its angle. Goes
/// on past n to a multiple of four.
void finish(FanSpoke* spokes, std::size_t n, float* beside) {
  Ways here(records(spokes), words_at(beside));
  for (std::size_t i = 0; i < n; i += read_at_once) {
    const Ways next(records(spokes + i + read_at_once), words_at(beside + i + read_at_once));
    const Floats x = moved_on(here.x, next.x);
    const Floats y = moved_on(here.y, next.y);
    const Floats z = moved_on(here.z, next.z);
    const Floats cross_x = here.y * z - here.z * y;
    const Floats cross_y = here.z * x - here.x * z;
    const Floats cross_z = here.x * y - here.y * x;
    const Floats product = here.length * moved_on(here.length, next.length);
    const Ints is_face = product > 0;
    const Floats inverse = is_face ? 1 / product : all(0);
    const Floats cosine = is_face ? inverse * (here.x * x + here.y * y + here.z * z) : all(1);
    const Floats sine = inverse * square_root(cross_x * cross_x + cross_y * cross_y + cross_z * cross_z);
    put_records({here.end, here.length, cosine, sine}, spokes + i);
    put_words(cosine, beside + i);
    here = next;
  }
  for (std::size_t i = 0; i < n; i += read_at_once) put_words(angle_of(words_at(beside + i)), beside + i);
}

}  // namespace

FanLayout::FanLayout(const TriangleMesh& mesh) : unit_(unit_of(mesh)), heads_(mesh.n_vertices() + 1) {
  // a spoke for each corner, and one more in each fan
  spokes_.resize(static_cast<std::size_t>(mesh.n_halfedges()) + static_cast<std::size_t>(mesh.n_vertices()) +
                 2 * read_at_once);
  // Block by block, first the ends, then the angles, last the sums: each is a short loop with nothing to wait for.
  constexpr Index block = 128;
  std::vector<float> beside(16 * block);
  std::uint32_t n_spokes = 0;
  for (Index first = 0; first < mesh.n_vertices(); first += block) {
    const Index last = std::min(mesh.n_vertices(), first + block);
    const std::uint32_t first_spoke = n_spokes;
    for (Index v = first; v < last; ++v) {
      n_spokes = find_ends(mesh, v, n_spokes, n_spokes - first_spoke, beside);
    }
    heads_[last] = {n_spokes, false, false, false};
    std::fill_n(spokes_.begin() + n_spokes, 2 * read_at_once, FanSpoke{});
    beside.resize(std::max<std::size_t>(beside.size(), n_spokes - first_spoke + 2 * read_at_once));
    finish(spokes_.data() + first_spoke, n_spokes - first_spoke, beside.data());
    for (Index v = first; v < last; ++v) close(v, beside.data() + (heads_[v].first - first_spoke));
  }
  std::fill(spokes_.begin() + n_spokes, spokes_.end(), FanSpoke{});
}

/// Appends the ways from a vertex to its neighbours, in place of spokes, in single precision. Beside them go the
/// squares of their lengths, which these could tell with more rounding only.
std::uint32_t FanLayout::find_ends(const TriangleMesh& mesh, Index vertex, std::uint32_t n_spokes, std::size_t n_beside,
                                   std::vector<float>& beside) {
  heads_[vertex] = {n_spokes, false, false, false};
  const Index start = mesh.outgoing(vertex);
  if (start == no_index) return n_spokes;
  static_assert(sizeof(Triangle) == 3 * sizeof(Index));  // half-edge h starts at corner h of all
  const Index* const corners = mesh.soup().triangles.front().data();
  const Vec3* const positions = mesh.soup().positions.data();
  const Vec3 middle = positions[vertex];
  const double scale = 1 / unit_;
  FanSpoke* spoke = spokes_.data() + n_spokes;
  const auto add = [&](std::uint32_t end) {
    const Vec3 way = scale * (positions[end] - middle);
    if (n_beside == beside.size()) beside.resize(2 * n_beside);
    beside[n_beside++] = static_cast<float>(way.squaredNorm());
    put_words(single_precision(way, end), spoke++);
  };
  add(static_cast<std::uint32_t>(mesh.to(start)));
  Index h = start;
  do {
    const std::uint32_t back = before(static_cast<std::uint32_t>(h));
    add(static_cast<std::uint32_t>(corners[back]));
    h = mesh.twin(static_cast<Index>(back));
  } while (h != start && h != no_index);
  heads_[vertex].closed = h == start;
  return static_cast<std::uint32_t>(spoke - spokes_.data());
}

/// Makes the last spoke of a fan, and sums up its angles.
void FanLayout::close(Index vertex, const float* angles) {
  Head& head = heads_[vertex];
  const std::uint32_t end = heads_[vertex + 1].first;
  if (end == head.first) return;
  FanSpoke& last = spokes_[end - 1];
  last = head.closed ? spokes_[head.first] : FanSpoke{last.end, last.length, 1, 0};
  float sum = head.closed ? -2 * std::numbers::pi_v<float> : -std::numbers::pi_v<float>;
  for (std::uint32_t i = 0; head.first + i + 1 < end; ++i) sum += angles[i];
  head.bends = sum > slight_saddle;
  head.bends_sharply = sum > sharp_saddle;
  most_spokes_ = std::max<std::size_t>(most_spokes_, end - head.first);
}

}  // namespace isopath
