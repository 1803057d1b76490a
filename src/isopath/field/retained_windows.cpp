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

constexpr Index edges_at_a_time = 1024;
constexpr std::size_t few = 16;
/// Lists lie in memory in the order in which they crossed: they are fetched this many edges before they are needed.
constexpr Index look_ahead = 8;

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

void ListPropagation::fetch_kept(Index edge) const {
  const Index h = mesh_.halfedge_of(edge);
  for (const Index side : {h, mesh_.twin(h)}) {
    if (side == no_index || kept_[side] == nullptr) continue;
    const char* list = reinterpret_cast<const char*>(kept_[side]);
    __builtin_prefetch(list);
    __builtin_prefetch(list + 64);
  }
}

void ListPropagation::add_kept(EdgeEnvelope& envelope, Index edge, std::vector<Window>& all) const {
  const Index canonical = mesh_.halfedge_of(edge);
  const double length = geometry_.length(canonical);
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
  const Index twin = mesh_.twin(canonical);
  collect(canonical, twin == no_index, twin == no_index ? no_index : canonical);
  if (twin != no_index) collect(twin, true, twin);
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
  if (envelope.is_continuous(distances_[mesh_.from(canonical)], distances_[mesh_.to(canonical)])) {
    envelope.merge(limits_);
    return;  // ways along the edge are no shorter
  }
  follow_from(mesh_.from(canonical), 0);
  follow_from(mesh_.to(canonical), length);
  envelope.close_jumps();
  envelope.merge(limits_);
}

ListPropagation::RetainedWindows ListPropagation::take_windows(Progress& progress) {
  const Index n_parts = (mesh_.n_edges() + edges_at_a_time - 1) / edges_at_a_time;
  std::vector<std::vector<Window>> parts(n_parts);
  RetainedWindows retained;
  retained.first.assign(mesh_.n_edges() + 1, 0);
  tbb::parallel_for(tbb::blocked_range<Index>(0, n_parts, 1), [&](const tbb::blocked_range<Index>& range) {
    EdgeEnvelope envelope;
    std::vector<Window> all;
    for (Index part = range.begin(); part < range.end(); ++part) {
      progress.checkpoint();
      const Index past = std::min(mesh_.n_edges(), (part + 1) * edges_at_a_time);
      for (Index edge = part * edges_at_a_time; edge < past; ++edge) {
        fetch_kept(std::min(edge + look_ahead, past - 1));
        add_kept(envelope, edge, all);
        parts[part].insert(parts[part].end(), envelope.windows().begin(), envelope.windows().end());
        retained.first[edge + 1] = envelope.windows().size();
      }
      parts[part].shrink_to_fit();
    }
  });
  workshops_.clear();
  kept_ = {};
  for (Index edge = 0; edge < mesh_.n_edges(); ++edge) retained.first[edge + 1] += retained.first[edge];
  retained.windows.reserve(retained.first.back());
  for (std::vector<Window>& part : parts) {
    retained.windows.insert(retained.windows.end(), part.begin(), part.end());
    part = {};
  }
  return retained;
}

}  // namespace isopath
