// Windows side by side in the lanes of vectors: what the passes over whole lists share (once for each instruction set).
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "isopath/field/list_targets.h"
#include "isopath/field/window_list.h"

#include <hwy/highway.h>

#ifndef ISOPATH_FIELD_SET_BITS
#define ISOPATH_FIELD_SET_BITS
namespace isopath {
namespace {

/// For each byte the places of its set bits in ascending order, four bits a place.
constexpr std::array<std::int64_t, 256> places_of_set_bits() {
  std::array<std::int64_t, 256> places{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    int count = 0;
    for (std::int64_t bit = 0; bit < 8; ++bit) {
      if ((byte >> bit & 1) != 0) places[byte] |= bit << 4 * count++;
    }
  }
  return places;
}
constexpr std::array<std::int64_t, 256> set_bits = places_of_set_bits();

}  // namespace
}  // namespace isopath
#endif

#if defined(ISOPATH_FIELD_LIST_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef ISOPATH_FIELD_LIST_LANES_INL
#undef ISOPATH_FIELD_LIST_LANES_INL
#else
#define ISOPATH_FIELD_LIST_LANES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace isopath::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Fixed for all targets: eight doubles at most, as WindowBlock::lanes promises. Sums are not fused (see the tests: all
// targets give the same bits).
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr D d;

V zero() { return hn::Zero(d); }
V all(double value) { return hn::Set(d, value); }
V square(V v) { return hn::Mul(v, v); }

/// Some windows side by side.
struct Windows {
  V begin, end, x, y, offset;
  M line;
  bool any_line;

  Windows(const WindowArrays& a, std::size_t i, M present)
      : begin(hn::LoadU(d, a.begin + i)),
        end(hn::LoadU(d, a.end + i)),
        x(hn::LoadU(d, a.x + i)),
        y(hn::LoadU(d, a.y + i)),
        offset(hn::LoadU(d, a.offset + i)),
        line(hn::And(present, hn::Gt(y, zero()))),
        any_line(!hn::AllFalse(d, line)) {}

  V distance(V at) const {
    const V circle = hn::Add(offset, hn::Sqrt(hn::Add(square(hn::Sub(at, x)), square(y))));
    return any_line ? hn::IfThenElse(line, hn::Add(offset, hn::Mul(x, at)), circle) : circle;
  }
  /// What longer() compares: the square of a circle's way from its source, the way of a straight front.
  V way_to(V at) const {
    const V circle = hn::Add(square(hn::Sub(at, x)), square(y));
    return any_line ? hn::IfThenElse(line, hn::Mul(x, at), circle) : circle;
  }
  M longer(V way, V than) const {
    const M circle = hn::Or(hn::Lt(than, zero()), hn::Gt(way, square(than)));
    return any_line ? hn::Or(hn::And(line, hn::Gt(way, than)), hn::AndNot(line, circle)) : circle;
  }
  M longer_or_equal(V way, V than) const {
    const M circle = hn::Or(hn::Le(than, zero()), hn::Ge(way, square(than)));
    return any_line ? hn::Or(hn::And(line, hn::Ge(way, than)), hn::AndNot(line, circle)) : circle;
  }
  /// Distance of a point beyond the half-edge, straight on.
  V straight_to(V px, V py) const {
    const V circle = hn::Add(offset, hn::Sqrt(hn::Add(square(hn::Sub(px, x)), square(hn::Sub(py, y)))));
    return any_line ? hn::IfThenElse(line, hn::Add(offset, hn::Add(hn::Mul(x, px), hn::Mul(y, py))), circle) : circle;
  }
  /// Direction of travel at a point of the half-edge, of any length.
  V ray_x(V at) const {
    const V circle = hn::Sub(at, x);
    return any_line ? hn::IfThenElse(line, x, circle) : circle;
  }
  V ray_y() const { return hn::Abs(y); }
  /// Length of that direction, within a factor of √2.
  V ray_length(V at) const { return hn::Add(hn::Abs(ray_x(at)), ray_y()); }
};

unsigned bits_of(M mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, mask, bits);
  return bits[0];
}

/// Place of the lowest set bit; past all places of any list when there is none.
std::size_t first_bit(unsigned bits) {
  return bits != 0 ? static_cast<std::size_t>(std::countr_zero(bits)) : std::numeric_limits<std::size_t>::max() / 2;
}

/// How to move the lanes of a mask together. (The library's own way is compiled into a copy of its table at every call,
/// and compressing stores take a hundred cycles on some processors.)
auto packing(M keep) {
  constexpr hn::RebindToSigned<D> ds;
  HWY_ALIGN static constexpr std::int64_t lane_shifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
  const auto places = hn::Shr(hn::Set(ds, set_bits[bits_of(keep)]), hn::Load(ds, lane_shifts));
  return hn::IndicesFromVec(d, hn::And(places, hn::Set(ds, 7)));
}

/// Stores the kept lanes; roots and errors are those of the windows from `tags` on.
HWY_INLINE std::size_t store(const WindowArrays& to, M keep, V begin, V end, V x, V y, V offset,
                             const WindowArrays& tags) {
  if (hn::AllTrue(d, keep)) {
    hn::StoreU(begin, d, to.begin);
    hn::StoreU(end, d, to.end);
    hn::StoreU(x, d, to.x);
    hn::StoreU(y, d, to.y);
    hn::StoreU(offset, d, to.offset);
    if (tags.root != nullptr) {
      hn::StoreU(hn::LoadU(d, tags.root), d, to.root);
      hn::StoreU(hn::LoadU(d, tags.error), d, to.error);
    }
    return hn::Lanes(d);
  }
  const auto packed = packing(keep);
  hn::StoreU(hn::TableLookupLanes(begin, packed), d, to.begin);
  hn::StoreU(hn::TableLookupLanes(end, packed), d, to.end);
  hn::StoreU(hn::TableLookupLanes(x, packed), d, to.x);
  hn::StoreU(hn::TableLookupLanes(y, packed), d, to.y);
  hn::StoreU(hn::TableLookupLanes(offset, packed), d, to.offset);
  if (tags.root != nullptr) {
    hn::StoreU(hn::TableLookupLanes(hn::LoadU(d, tags.root), packed), d, to.root);
    hn::StoreU(hn::TableLookupLanes(hn::LoadU(d, tags.error), packed), d, to.error);
  }
  return hn::CountTrue(d, keep);
}

}  // namespace
}  // namespace isopath::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
