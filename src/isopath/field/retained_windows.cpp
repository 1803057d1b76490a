// What a propagation leaves on the edges, as the lower envelope of all fronts that came by.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "isopath/field/edge_envelope.h"
#include "isopath/field/list_propagation.h"

namespace isopath {
namespace {

constexpr Index halfedges_at_a_time = 3 * 1024;
constexpr std::size_t few = 16;
/// Lists lie in memory in the order in which they crossed: they are fetched this many edges before they are needed.
constexpr std::size_t look_ahead = 8;

/// A stable sort that asks for no memory when there is little to sort.
template <class Before>
void sort_few(std::vector<Window>& windows, Before before) {
  if (windows.size() > few) {
    std::stable_sort(windows.begin(), windows.end(), before);
    return;
  }
  for (std::size_t i = 1; i < windows.size(); ++i) {
    for (std::size_t k = i; k > 0 && before(windows[k], windows[k - 1]); --k) std::swap(windows[k], windows[k - 1]);
  }
}

}  // namespace

double ListPropagation::snap_width(double edge_length) const {
  // Relative to the edge, and not below what coordinates of this model can resolve.
  return std::min(0.25 * edge_length, std::max(1e-11 * edge_length, 2e-14 * geometry_.size()));
}

void ListPropagation::fetch_kept(Index halfedge) const {
  for (const Index side : {halfedge, sites_[halfedge].twin}) {
    if (side == no_index || kept_[side] == nullptr) continue;
    const char* list = reinterpret_cast<const char*>(kept_[side]);
    __builtin_prefetch(list);
    __builtin_prefetch(list + 64);
  }
}

void ListPropagation::add_kept(EdgeEnvelope& envelope, Index halfedge, Index edge, std::vector<Window>& all) const {
  const Index twin = sites_[halfedge].twin;
  const double length = sites_[halfedge].length;
  all.clear();
  const auto collect = [&](Index h, bool flip, Index enters) {
    for (const KeptList* list = kept_[h]; list != nullptr; list = list->next) {
      auto* first = const_cast<double*>(reinterpret_cast<const double*>(list + 1));
      const WindowArrays windows = WindowArrays::at(first, list->size, true);
      for (std::size_t i = 0; i < list->size; ++i) {
        Window w = windows.window(i);
        if (flip) w = w.flipped(length);
        w.halfedge = enters;
        all.push_back(w);
      }
    }
  };
  const bool is_boundary = twin == no_index;
  collect(halfedge, is_boundary, is_boundary ? no_index : numbering_.halfedge_in_mesh(halfedge));
  if (!is_boundary) collect(twin, true, numbering_.halfedge_in_mesh(twin));
  // Straight fronts first: where a point's circle only ties with them, the segment keeps the root.
  sort_few(all, [](const Window& a, const Window& b) {
    return a.kind != b.kind ? a.kind == Window::Kind::line : a.begin < b.begin;
  });
  envelope.reset(length, snap_width(length));
  for (const Window& window : all) envelope.insert(window);
  // A source on the edge sends half a turn of rays through one point. On the edge, others may be as near on both sides.
  for (Window& window : all) {
    if (window.kind == Window::Kind::line || std::abs(window.source.y()) > snap_width(length)) continue;
    window.begin = std::max(window.begin, window.source.x() - 0.25 * snap_width(length));
    window.end = std::min(window.end, window.source.x() + 0.25 * snap_width(length));
    envelope.insert(window);
  }

  const auto by_edge = [](const auto& source, Index e) { return source.first < e; };
  for (auto s = std::lower_bound(edge_sources_.begin(), edge_sources_.end(), edge, by_edge);
       s != edge_sources_.end() && s->first == edge; ++s) {
    envelope.insert(s->second);
  }
  const auto follow_from = [&](Index vertex, double x) {
    if (distances_[vertex] == infinity) return;
    envelope.insert(along_edge(x, length, distances_[vertex], states_[vertex].arrival.error, states_[vertex].root));
  };
  const Index from = sites_[halfedge].tail;
  const Index to = sites_[TriangleMesh::next(halfedge)].tail;
  if (envelope.is_continuous(distances_[from], distances_[to])) {
    envelope.merge(limits_);
    return;  // ways along the edge are no shorter
  }
  follow_from(from, 0);
  follow_from(to, length);
  envelope.close_jumps();
  envelope.merge(limits_);
}

EdgeWindows ListPropagation::take_windows(Progress& progress) {
  struct Owner {
    Index halfedge;  ///< canonical in the mesh
    Index edge;
  };
  const Index n = mesh_.n_halfedges();
  const Index n_parts = (n + halfedges_at_a_time - 1) / halfedges_at_a_time;
  EdgeWindows retained(mesh_.n_edges(), n_parts);
  tbb::parallel_for(tbb::blocked_range<Index>(0, n_parts, 1), [&](const tbb::blocked_range<Index>& range) {
    EdgeEnvelope envelope;
    std::vector<Window> all;
    std::vector<Owner> owners;
    for (Index part = range.begin(); part < range.end(); ++part) {
      progress.checkpoint();
      owners.clear();
      for (Index h = part * halfedges_at_a_time; h < std::min(n, (part + 1) * halfedges_at_a_time); ++h) {
        const Index twin = sites_[h].twin;
        if (twin != no_index && twin < h) continue;
        const Index in_mesh = numbering_.halfedge_in_mesh(h);
        const bool is_canonical = twin == no_index || in_mesh < numbering_.halfedge_in_mesh(twin);
        owners.push_back({is_canonical ? h : twin, mesh_.edge_of(in_mesh)});
      }
      for (std::size_t i = 0; i < owners.size(); ++i) {
        if (i + look_ahead < owners.size()) fetch_kept(owners[i + look_ahead].halfedge);
        add_kept(envelope, owners[i].halfedge, owners[i].edge, all);
        retained.add(part, owners[i].edge, envelope.windows());
      }
      retained.finish(part);
    }
  });
  workshops_.clear();
  kept_ = {};
  return retained;
}

}  // namespace isopath
