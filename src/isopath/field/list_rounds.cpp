// The rounds: what waits is taken and does its work, by all threads at the same time.
#include <algorithm>
#include <atomic>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "isopath/field/list_propagation.h"
#include "isopath/field/prefetch.h"

namespace isopath {
namespace {

/// Shares of a thread in a round.
constexpr std::size_t lists_at_a_time = 8;
constexpr std::size_t vertices_at_a_time = 16;
/// Fewer are looked after sooner than another thread hears of them.
constexpr std::size_t least_shared = 64;
/// Items are fetched into the cache this many places before their turn; headers of lists twice as many.
constexpr std::ptrdiff_t ahead = 4;
/// So often the order of the front is looked after, by so many places on it.
constexpr int rounds_of_order = 16;
constexpr std::size_t places_of_order = 128;
/// Lists cross a half-edge a few times. Around closed needles they would go on and on, each turn a little longer than
/// the one before: after so many times a half-edge begins to remember what crossed.
constexpr Index lists_without_memory = 64;

}  // namespace

void ListPropagation::take_over_offers(Workshop& workshop, bool among_others) {
  for (const Offer& offer : workshop.offers) {
    among_others ? offer_vertex_locked(offer, workshop) : offer_vertex(offer, workshop);
  }
  workshop.offers.clear();
}

void ListPropagation::collect(FrontOrder::Notes& notes, std::vector<FrontOrder::Noted>& sorted) const {
  sorted.clear();
  if (bucket_ >= static_cast<Index>(notes.size())) return;
  is_shared_ ? FrontOrder::sort(notes[bucket_], sorted) : sorted.swap(notes[bucket_]);
}

std::size_t ListPropagation::n_waiting(Notes notes, const Workshop& workshop) const {
  const FrontOrder::Notes& buckets = workshop.*notes;
  return bucket_ < static_cast<Index>(buckets.size()) ? buckets[bucket_].size() : 0;
}

template <class Work>
void ListPropagation::each_workshop(Team& team, Notes notes, const Work& work) {
  std::size_t n = 0;
  for (const Workshop& workshop : workshops_) n += workshop.offers.size() + n_waiting(notes, workshop);
  const bool shared = is_shared_ && n >= least_shared;
  const auto some = [=, this](std::size_t first, std::size_t past, std::size_t) {
    for (std::size_t k = first; k < past; ++k) work(workshops_[k], shared);
  };
  shared ? team.share(workshops_.size(), 1, some) : some(0, workshops_.size(), 0);
}

template <class Item, class Work>
void ListPropagation::share(Team& team, std::vector<Item> Workshop::*items, std::size_t at_a_time, const Work& work) {
  std::size_t n = 0;
  for (const Workshop& workshop : workshops_) n += (workshop.*items).size();
  team.share(n, at_a_time, [=, this](std::size_t first, std::size_t past, std::size_t member) {
    for (Workshop& workshop : workshops_) {
      const std::span<Item> own(workshop.*items);
      if (first < own.size()) work(own, first, std::min(past, own.size()), member);
      if (past <= own.size()) return;
      first -= std::min(first, own.size());
      past -= own.size();
    }
  });
}

void ListPropagation::fetch_around(Index vertex) const {
  const std::span<const Spoke> ring = rings_.of(vertex);
  for (std::size_t k = 0; k < ring.size(); k += 2) __builtin_prefetch(&ring[k]);
  prefetch_to_write(&states_[vertex]);
}

void ListPropagation::fetch(const Crossing& crossing, const WindowBlocks& blocks) const {
  const Index first = crossing.halfedge - crossing.halfedge % 3;
  for (Index h = first; h < first + 3; ++h) {
    __builtin_prefetch(&sites_[h]);
  }
  for (const WindowBlock* block : crossing.lists) {
    if (block != nullptr) blocks.fetch(block);
  }
}

bool ListPropagation::stops_waiting(Index& bucket) const {
  Index noted = bucket_;
  return std::atomic_ref<Index>(bucket).compare_exchange_strong(noted, not_waiting, std::memory_order_relaxed);
}

bool ListPropagation::take(Index halfedge, Crossing& crossing, Workshop& workshop) {
  Site& site = sites_[halfedge];
  if (!stops_waiting(site.bucket)) return false;
  crossing.halfedge = halfedge;
  crossing.depth = std::numeric_limits<Index>::max();
  for (int k = 0; k < 3; ++k) crossing.lists[k] = std::exchange(site.waiting[k], nullptr);
  if (site.memory <= 0 && --site.memory <= -lists_without_memory) workshop.crowded.push_back(halfedge);
  return true;
}

bool ListPropagation::run_vertices(Team& team) {
  each_workshop(team, &Workshop::vertices, [this](Workshop& workshop, bool among_others) {
    take_over_offers(workshop, among_others);
    collect(workshop.vertices, workshop.active);
  });
  const auto is_idle = [](const Workshop& workshop) { return workshop.active.empty(); };
  if (std::all_of(workshops_.begin(), workshops_.end(), is_idle)) return false;
  share(team, &Workshop::active, vertices_at_a_time,
        [this](auto active, std::size_t first, std::size_t past, auto member) {
          Workshop& workshop = workshops_[member];
          for (std::size_t begin = first, end = first; begin < past; begin = end) {
            end = std::min(begin + vertices_at_a_time, past);
            workshop.fans.clear();
            for (std::size_t i = begin; i < end; ++i) {
              if (i + ahead < active.size()) fetch_around(active[i + ahead].item);
              const Index vertex = active[i].item;
              if (!stops_waiting(states_[vertex].bucket)) continue;
              relax_edges(vertex, workshop);
              find_fans(vertex, workshop);
            }
            for (const Fan& fan : workshop.fans) send_fan(fan, workshop);
          }
        });
  return true;
}

void ListPropagation::run_lists(Team& team) {
  // All are taken before one crosses: what crosses may be put down where another one waits.
  each_workshop(team, &Workshop::halfedges, [this](Workshop& workshop, bool among_others) {
    take_over_offers(workshop, among_others);
    collect(workshop.halfedges, workshop.sorted);
    workshop.crossings.clear();
    for (std::size_t i = 0; i < workshop.sorted.size(); ++i) {
      if (i + ahead < workshop.sorted.size()) prefetch_to_write(&sites_[workshop.sorted[i + ahead].item]);
      Crossing crossing;
      if (take(workshop.sorted[i].item, crossing, workshop)) workshop.crossings.push_back(crossing);
    }
  });
  remember_crowded();
  share(team, &Workshop::crossings, lists_at_a_time,
        [this](auto crossings, std::size_t first, std::size_t past, auto member) {
          Workshop& workshop = workshops_[member];
          const auto n = static_cast<std::ptrdiff_t>(crossings.size());
          const std::ptrdiff_t step = member % 2 == 0 ? 1 : -1;
          std::ptrdiff_t i = member % 2 == 0 ? first : past - 1;
          for (std::size_t times = past - first; times > 0; --times, i += step) {
            // What comes after this part most likely is the next one.
            const std::ptrdiff_t soon = i + step * ahead;
            const std::ptrdiff_t later = soon + step * ahead;
            if (0 <= later && later < n) {
              for (const WindowBlock* block : crossings[later].lists) __builtin_prefetch(block);
            }
            if (0 <= soon && soon < n) fetch(crossings[soon], workshop.blocks);
            cross(crossings[i], workshop);
          }
        });
}

void ListPropagation::remember_crowded() {
  for (Workshop& workshop : workshops_) {
    for (const Index h : workshop.crowded) {
      memories_.emplace_back().reset(sites_[h].length, snap_width(sites_[h].length));
      sites_[h].memory = static_cast<Index>(memories_.size());
    }
    workshop.crowded.clear();
  }
}

void ListPropagation::turn_order() {
  std::size_t n = 0;
  for (const Workshop& workshop : workshops_) n += workshop.crossings.size();
  const std::size_t step = n / places_of_order + 1;
  std::vector<Vec3> places;
  for (const Workshop& workshop : workshops_) {
    for (std::size_t i = 0; i < workshop.crossings.size(); i += step)
      places.push_back(positions_[sites_[workshop.crossings[i].halfedge].tail]);
  }
  if (places.size() >= places_of_order / 2 && order_.turn(places)) place_notes();
}

void ListPropagation::place_notes() {
  for (Workshop& workshop : workshops_) {
    for (auto& notes : workshop.halfedges) {
      for (FrontOrder::Noted& noted : notes) noted.along = along(sites_[noted.item].tail);
    }
    for (auto& notes : workshop.vertices) {
      for (FrontOrder::Noted& noted : notes) noted.along = along(noted.item);
    }
  }
}

void ListPropagation::run(double stop_distance, Progress& progress) {
  Team team;
  while (workshops_.size() < team.size()) workshops_.emplace_back(retain_);
  is_shared_ = team.size() > 1;
  if (is_shared_) place_notes();
  int rounds = 0;
  for (bucket_ = 0; bucket_ * bucket_width_ <= stop_distance; ++bucket_) {
    std::size_t past = 0;
    for (const Workshop& workshop : workshops_)
      past = std::max({past, workshop.vertices.size(), workshop.halfedges.size()});
    if (bucket_ >= static_cast<Index>(past)) break;
    const auto are_waiting = [&] {
      return std::any_of(workshops_.begin(), workshops_.end(),
                         [&](const Workshop& workshop) { return n_waiting(&Workshop::halfedges, workshop) > 0; });
    };
    while (run_vertices(team) || are_waiting()) {
      progress.checkpoint();
      run_lists(team);
      if (is_shared_ && ++rounds % rounds_of_order == 0) turn_order();
    }
  }
  progress.at(1);
}

}  // namespace isopath
