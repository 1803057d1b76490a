#include "isopath/field/virtual_source.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/field/beam.h"
#include "isopath/field/bucket_queue.h"
#include "isopath/field/flat_layout.h"
#include "isopath/field/large_pages.h"
#include "isopath/field/source_faces.h"

namespace isopath {
namespace {

constexpr float unreached = std::numeric_limits<float>::infinity();
/// Single precision: a shorter way by less than this share is no improvement.
constexpr float single_rounding = 1e-6F;
/// A ray that misses an end of a half-edge by less than this share of its length passes it.
constexpr float grazing = 1e-5F;
/// Growth of the lit part of a half-edge, as a share of its length, that is worth another look.
constexpr float enough_light = 1e-3F;
/// A way round a corner that is longer than the straight one by less than this share of its last edge is straight.
constexpr float slight_bend = 1e-4F;
/// Share by which a beam may come later than others to a corner and still be wanted: parts of a face where it is first
/// may hold none of its corners.
constexpr float late = 1e-3F;
/// Widest shadow, as a share of the half-edge, between two beams of one source that is taken for an accident of the
/// triangles; wider ones are creases and dents that light does not cross.
constexpr float widest_gap = 0.15F;
/// Beams whose sources are no farther apart, as a share of their distance, came over flat parts: a gap between them
/// only means that light is still to come.
constexpr float flat = 1e-4F;
/// Cosine of the angle between two beams above which they are parts of one front, not fronts that meet.
constexpr float same_heading = 0.95F;
/// Width of a bucket of the queue in units of the layout.
constexpr float bucket_step = 0.5F;

constexpr std::array<std::uint32_t, 3> next_corner{1, 2, 0};
constexpr std::array<std::uint32_t, 3> previous_corner{2, 0, 1};

/// A half-edge with the shape of its face in its frame.
struct Door {
  Door(FlatLayout& layout, FlatHalfedge halfedge)
      : h(halfedge),
        face(layout.faces[flat_face(h)]),
        corner(flat_corner(h)),
        length(face.length[corner]),
        apex{face.apex_x[corner], face.apex_y(corner)} {}

  std::uint32_t tail() const { return face.vertex[corner]; }
  std::uint32_t head() const { return face.vertex[next_corner[corner]]; }
  std::uint32_t top() const { return face.vertex[previous_corner[corner]]; }

  FlatHalfedge h;
  FlatFace& face;
  std::uint32_t corner;
  float length;
  FlatPoint apex;
};

template <bool with_segments>
class VirtualSources {
 public:
  explicit VirtualSources(const TriangleMesh& mesh)
      : mesh_(mesh),
        layout_(mesh),
        distance_(mesh.n_vertices(), unreached),
        fanned_(mesh.n_vertices(), unreached),
        queue_(bucket_step) {
    beams_.resize(3 * layout_.faces.size());  // so that references stay good; pages come as they are touched
  }

  void start(const SourceElement& element, std::uint32_t number);
  void run(Progress& progress);
  std::vector<double> distances() const;

 private:
  using Light = Beam<with_segments>;

  void relax(std::uint32_t vertex, float value) { distance_[vertex] = std::min(distance_[vertex], value); }
  void wait(FlatHalfedge h, Light& held, float key);
  void start_in_face(Index face, const SourceElement& element, std::uint32_t source);
  void fan_from(std::uint32_t vertex);
  void offer(FlatHalfedge h, Light beam);
  void join(const Door& door, Light& held, Light beam);
  void spread(FlatHalfedge h);
  void pass_left(const Door& door, const Light& beam, float crossing);
  void pass_right(const Door& door, const Light& beam, float crossing);
  bool wanted(const Door& door, const Light& beam, float straight) const;
  void bend(const Door& door, Light& held, const Sight& seen);
  bool shorten_along_edges();
  void look_ahead() const;

  const TriangleMesh& mesh_;
  FlatLayout layout_;
  LargeVector<Light> beams_;  ///< in the order in which light first came to their half-edges
  std::uint32_t n_beams_ = 0;
  LargeVector<float> distance_;
  LargeVector<float> fanned_;  ///< the vertex's distance when it last became a source
  BucketQueue queue_;
};

template <bool with_segments>
void VirtualSources<with_segments>::wait(FlatHalfedge h, Light& held, float key) {
  if (held.errand == Errand::spread) return;
  held.errand = Errand::spread;
  queue_.push(key, h);
}

/// Takes a beam if it brings the apex a shorter way than the beam that is there.
template <bool with_segments>
[[gnu::always_inline]] inline void VirtualSources<with_segments>::offer(FlatHalfedge h, Light beam) {
  const Door door(layout_, h);
  const Sight seen = sight(beam, door.apex);
  beam.value = way_to(beam, door.apex, seen, grazing * door.length);
  relax(door.top(), beam.value);
  std::uint32_t& record = door.face.record[door.corner];
  if (record == no_flat_record) {
    record = n_beams_++;
    beam.errand = Errand::spread;
    beams_[record] = beam;
    queue_.push(seen.straight, h);
    return;
  }
  Light& held = beams_[record];
  if (held.bent == beam.bent) {
    join(door, held, beam);
  } else if (beam.value < held.value * (1 - single_rounding)) {
    beam.errand = held.errand;
    held = beam;
    wait(h, held, seen.straight);
  }
}

/// Beams of one source that a half-edge gets from two sides of a vertex become one: what lies between them is lit. On a
/// curved surface the source unfolds to two places; the joint one turns about the end that the nearer beam reaches
/// until its distance to the other end is that of the other beam. Else errors would add up to one side.
template <bool with_segments>
[[gnu::noinline]] void VirtualSources<with_segments>::join(const Door& door, Light& held, Light beam) {
  const float slack = grazing * door.length;
  const bool better = beam.value < held.value * (1 - single_rounding);
  const float gain = std::max(held.low - beam.low, beam.high - held.high);
  if (!better && gain <= enough_light * door.length) return;
  beam.errand = held.errand;
  const float gap = std::max(held.low, beam.low) - std::min(held.high, beam.high);
  const bool unfolds_alike = norm(held.start - beam.start) <= flat * norm(beam.start);
  if (gap > widest_gap * door.length && !unfolds_alike) {
    if (!better) return;
    held = beam;
    return wait(door.h, held, beam.value);
  }
  const bool held_is_left = beam.low > held.low + slack && beam.high > held.high + slack;
  const bool held_is_right = beam.low < held.low - slack && beam.high < held.high - slack;
  Light joint = better ? beam : held;
  const Light& other = better ? held : beam;
  joint.low = std::min(held.low, beam.low);
  joint.high = std::max(held.high, beam.high);
  if ((held_is_left || held_is_right) && held.source == beam.source) {
    const FlatPoint pivot{held_is_left != better ? 0 : door.length, 0};
    const FlatPoint end{door.length - pivot.x, 0};
    const FlatPoint to_joint = end - nearest(joint, end);
    const FlatPoint to_other = end - nearest(other, end);
    const float distance = norm(to_other);
    if (dot(to_joint, to_other) > same_heading * norm(to_joint) * distance) turn(joint, pivot, end, distance);
  }
  const Sight seen = sight(joint, door.apex);
  joint.value = std::min(joint.value, way_to(joint, door.apex, seen, slack));
  held = joint;
  relax(door.top(), joint.value);
  wait(door.h, held, seen.straight);
}

/// Brings the beam of a half-edge on to the other two edges of its face.
template <bool with_segments>
void VirtualSources<with_segments>::spread(FlatHalfedge h) {
  const Door door(layout_, h);
  Light& held = beams_[door.face.record[door.corner]];
  const Light beam = held;
  held.errand = Errand::none;
  if (beam.errand == Errand::none) return;
  const Sight seen = sight(beam, door.apex);
  if (!wanted(door, beam, seen.straight)) return;
  if (beam.errand == Errand::spread) {
    if (seen.crossing > beam.low) pass_left(door, beam, seen.crossing);
    if (seen.crossing < beam.high) pass_right(door, beam, seen.crossing);
  }
  const float slack = grazing * door.length;
  if (seen.crossing < beam.low - slack || seen.crossing > beam.high + slack) bend(door, held, seen);
}

/// A beam that comes later than others to all three corners has nothing left to win.
template <bool with_segments>
bool VirtualSources<with_segments>::wanted(const Door& door, const Light& beam, float straight) const {
  if (straight <= (1 + late) * distance_[door.top()]) return true;
  const FlatPoint tail{0, 0};
  const FlatPoint head{door.length, 0};
  return beam.bent + norm(nearest(beam, tail)) <= (1 + late) * distance_[door.tail()] ||
         beam.bent + norm(head - nearest(beam, head)) <= (1 + late) * distance_[door.head()];
}

/// To the edge from the tail to the apex.
template <bool with_segments>
void VirtualSources<with_segments>::pass_left(const Door& door, const Light& beam, float crossing) {
  const FlatFace& face = door.face;
  const std::uint32_t exit = previous_corner[door.corner];
  if (face.twin[exit] == no_flat_halfedge || !(face.length[exit] > 0)) return;
  const float length = face.length[exit];
  const FlatPoint u{door.apex.x / length, door.apex.y / length};
  const auto hit = [&](float at) {
    const FlatPoint ray = FlatPoint{at, 0} - nearest(beam, {at, 0});
    const float across = cross(u, ray);
    return across > 0 ? std::clamp(at * ray.y / across, 0.0F, length) : 0.0F;
  };
  Light next = in_frame(beam, {0, 0}, u);
  next.low = beam.low > 0 ? hit(beam.low) : 0;
  next.high = beam.high < crossing ? hit(beam.high) : length;
  offer(face.twin[exit], next);
}

/// To the edge from the apex to the head.
template <bool with_segments>
void VirtualSources<with_segments>::pass_right(const Door& door, const Light& beam, float crossing) {
  const FlatFace& face = door.face;
  const std::uint32_t exit = next_corner[door.corner];
  if (face.twin[exit] == no_flat_halfedge || !(face.length[exit] > 0)) return;
  const float length = face.length[exit];
  const FlatPoint u{(door.length - door.apex.x) / length, -door.apex.y / length};
  const auto hit = [&](float at) {
    const FlatPoint ray = FlatPoint{at, 0} - nearest(beam, {at, 0});
    const float across = cross(u, ray);
    return across > 0 ? std::clamp(cross(FlatPoint{at, 0} - door.apex, ray) / across, 0.0F, length) : length;
  };
  Light next = in_frame(beam, door.apex, u);
  next.low = beam.low > crossing ? hit(beam.low) : 0;
  next.high = beam.high < door.length ? hit(beam.high) : length;
  offer(face.twin[exit], next);
}

/// The apex is in the shadow: if no other beam has come there by the time the way along the edge arrives, the way bends
/// at the end of the half-edge, which becomes a source.
template <bool with_segments>
void VirtualSources<with_segments>::bend(const Door& door, Light& held, const Sight& seen) {
  const bool at_tail = seen.crossing < held.low;
  const std::uint32_t vertex = at_tail ? door.tail() : door.head();
  const float last = door.face.length[at_tail ? previous_corner[door.corner] : next_corner[door.corner]];
  const float way = distance_[vertex] + last;
  if (distance_[door.top()] < way * (1 - single_rounding) || way - seen.straight < slight_bend * last) return;
  if (!(distance_[vertex] < fanned_[vertex])) return;
  if (queue_.due(way + bucket_step)) {
    fan_from(vertex);
  } else {
    held.errand = Errand::bend;
    queue_.push(way + bucket_step, door.h);
  }
}

/// Makes a vertex a source of light into all faces around it.
template <bool with_segments>
void VirtualSources<with_segments>::fan_from(std::uint32_t vertex) {
  const float bent = distance_[vertex];
  fanned_[vertex] = bent;
  const Index first = mesh_.outgoing(static_cast<Index>(vertex));
  for (Index h = first; h != no_index;) {
    const FlatFace& face = layout_.faces[h / 3];
    const auto corner = static_cast<std::uint32_t>(h % 3);
    const std::uint32_t opposite = next_corner[corner];
    const float length = face.length[opposite];
    relax(face.vertex[opposite], bent + face.length[corner]);
    relax(face.vertex[previous_corner[corner]], bent + face.length[previous_corner[corner]]);
    if (face.twin[opposite] != no_flat_halfedge && length > 0) {
      Light beam;
      beam.start = {length - face.apex_x[opposite], -face.apex_y(opposite)};
      if constexpr (with_segments) beam.along = {0, 0};
      beam.bent = bent;
      beam.low = 0;
      beam.high = length;
      beam.source = vertex;
      offer(face.twin[opposite], beam);
    }
    h = mesh_.next_outgoing(h);
    if (h == first) break;
  }
}

template <bool with_segments>
void VirtualSources<with_segments>::start_in_face(Index f, const SourceElement& element, std::uint32_t source) {
  const FlatFace& face = layout_.faces[f];
  const SurfacePoint a = express_in(mesh_, element.a, f);
  const SurfacePoint b = element.kind == SourceElement::Kind::segment ? express_in(mesh_, element.b, f) : a;
  for (std::uint32_t i = 0; i < 3; ++i) {
    relax(face.vertex[i],
          static_cast<float>(distance_in_face(mesh_, element, mesh_.position(mesh_.triangle(f)[i])) / layout_.unit));
    if (face.twin[i] == no_flat_halfedge || !(face.length[i] > 0)) continue;
    const float length = face.length[i];
    const auto beyond = [&](const Vec3& barycentric) {  // in the frame of the twin
      const auto head = static_cast<float>(barycentric[next_corner[i]]);
      const auto top = static_cast<float>(barycentric[previous_corner[i]]);
      return FlatPoint{length - head * length - top * face.apex_x[i], -top * face.apex_y(i)};
    };
    Light beam;
    beam.start = beyond(a.barycentric);
    const FlatPoint end = beyond(b.barycentric);
    if (beam.start.y == 0 && end.y == 0) continue;  // the face beyond holds the element too, or meets it at a vertex
    if constexpr (with_segments) beam.along = end - beam.start;
    beam.bent = 0;
    beam.low = 0;
    beam.high = length;
    beam.source = source;
    offer(face.twin[i], beam);
  }
}

template <bool with_segments>
void VirtualSources<with_segments>::start(const SourceElement& element, std::uint32_t number) {
  const bool is_point = element.kind == SourceElement::Kind::point;
  for (const SurfacePoint& end : {element.a, is_point ? element.a : element.b}) {
    const Support support = support_of(mesh_, end);
    if (support.kind != Support::Kind::vertex || fanned_[support.index] == 0) continue;
    distance_[support.index] = 0;
    fan_from(static_cast<std::uint32_t>(support.index));
  }
  for (const Index face : faces_of(mesh_, element)) {
    start_in_face(face, element, static_cast<std::uint32_t>(mesh_.n_vertices()) + number);
  }
}

/// Where a way along an edge is still shorter, its start becomes a source.
template <bool with_segments>
bool VirtualSources<with_segments>::shorten_along_edges() {
  bool found = false;
  for (const FlatFace& face : layout_.faces) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      std::uint32_t a = face.vertex[i];
      std::uint32_t b = face.vertex[next_corner[i]];
      if (distance_[a] > distance_[b]) std::swap(a, b);
      if (!((distance_[a] + face.length[i]) * (1 + single_rounding) < distance_[b])) continue;
      fan_from(a);
      found = true;
    }
  }
  return found;
}

/// Most of the time would go into waiting for memory: fetches the faces that items further back in the queue are about
/// to read and write.
template <bool with_segments>
void VirtualSources<with_segments>::look_ahead() const {
  const FlatHalfedge far = queue_.ahead(24);
  __builtin_prefetch(&layout_.faces[flat_face(far)], 1);
  const FlatHalfedge near = queue_.ahead(12);
  const FlatFace& face = layout_.faces[flat_face(near)];
  __builtin_prefetch(&beams_[face.record[flat_corner(near)]], 1);
  for (const std::uint32_t exit : {next_corner[flat_corner(near)], previous_corner[flat_corner(near)]}) {
    if (face.twin[exit] != no_flat_halfedge) __builtin_prefetch(&layout_.faces[flat_face(face.twin[exit])], 1);
  }
}

template <bool with_segments>
void VirtualSources<with_segments>::run(Progress& progress) {
  const std::size_t n_expected = 3 * layout_.faces.size() / 2;  // every edge once
  std::size_t spread_count = 0;
  do {
    while (!queue_.empty()) {
      const FlatHalfedge h = queue_.pop();
      look_ahead();
      if (++spread_count % 65536 == 0) {
        progress.checkpoint();
        progress.at(std::min(1.0, static_cast<double>(spread_count) / static_cast<double>(n_expected)));
      }
      spread(h);
    }
  } while (shorten_along_edges());
}

template <bool with_segments>
std::vector<double> VirtualSources<with_segments>::distances() const {
  std::vector<double> result(distance_.size());
  for (std::size_t v = 0; v < result.size(); ++v) result[v] = distance_[v] * layout_.unit;
  return result;
}

template <bool with_segments>
std::vector<double> distances_from(const TriangleMesh& mesh, const SourceSet& sources, Progress& progress) {
  progress.checkpoint();
  VirtualSources<with_segments> fronts(mesh);
  for (std::uint32_t k = 0; k < sources.elements().size(); ++k) fronts.start(sources.elements()[k], k);
  fronts.run(progress);
  return fronts.distances();
}

}  // namespace

std::vector<double> virtual_source_distances(const TriangleMesh& mesh, const SourceSet& sources, Progress& progress) {
  if (sources.empty()) throw Error(ErrorCode::bad_usage, "the source set is empty", {.advice = "name a source"});
  const bool with_segments = std::any_of(sources.elements().begin(), sources.elements().end(),
                                         [](const SourceElement& e) { return e.kind == SourceElement::Kind::segment; });
  return with_segments ? distances_from<true>(mesh, sources, progress) : distances_from<false>(mesh, sources, progress);
}

}  // namespace isopath
