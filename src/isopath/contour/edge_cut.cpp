#include "isopath/contour/edge_cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "isopath/core/error.h"

namespace isopath {

void EdgeCutter::collect(Index edge, double from, double to) {
  double low = std::min(from, to);
  double high = std::max(from, to);
  if (!function_.linear_in_faces()) {
    // A function of slope s over length l reaches at most (f(a) + f(b) ± s l) / 2, by meeting both cones.
    const double slack = max_slope_ * mesh_.edge_length(edge) * (1 + 1e-9);
    low = std::min(low, (from + to - slack) / 2);
    high = std::max(high, (from + to + slack) / 2);
  }
  const auto first = std::lower_bound(levels_.begin(), levels_.end(), low);
  const auto last = std::upper_bound(first, levels_.end(), high);
  first_level_ = static_cast<Index>(first - levels_.begin());
  parameters_.clear();
  begin_.assign(1, 0);
  // A crossing nearer to an end than lengths can be told apart is at the vertex.
  const double at_end = mesh_.tolerance().length / std::max(mesh_.edge_length(edge), mesh_.tolerance().length);
  for (auto level = first; level != last; ++level) {
    function_.edge_crossings(edge, *level, parameters_);
    for (std::size_t i = begin_.back(); i < parameters_.size(); ++i) {
      double& t = parameters_[i];
      t = t < at_end ? 0 : t > 1 - at_end ? 1 : t;
    }
    begin_.push_back(parameters_.size());
  }
  cursor_.assign(begin_.begin(), begin_.end() - 1);
}

bool EdgeCutter::pending(Index level) const {
  const Index i = level - first_level_;
  return i >= 0 && i < static_cast<Index>(cursor_.size()) && cursor_[i] < begin_[i + 1];
}

void EdgeCutter::cut(Index edge, std::vector<LevelCut::Crossing>& out) {
  const Index halfedge = mesh_.halfedge_of(edge);
  const double from = function_.value_at_vertex(mesh_.from(halfedge));
  const double to = function_.value_at_vertex(mesh_.to(halfedge));
  if (!std::isfinite(from) || !std::isfinite(to)) return;
  collect(edge, from, to);

  const auto band_of = [&](double value) {
    return static_cast<Index>(std::upper_bound(levels_.begin(), levels_.end(), value) - levels_.begin());
  };
  Index band = band_of(from);
  const Index last_band = band_of(to);
  bool rising = last_band > band;
  double parameter = 0;
  // From one band the next crossing can only be that of the level above or of the level below. Where rounding puts
  // both at one place, going on in the same direction is the order that a continuous function allows. Crossings that
  // cannot be passed in this way touch within rounding, come in pairs, and are left out.
  while (true) {
    const bool up = pending(band);
    const bool down = pending(band - 1);
    if (!up && !down) break;
    if (up && down) {
      const double t_up = next_of(band);
      const double t_down = next_of(band - 1);
      rising = t_up == t_down ? rising : t_up < t_down;
    } else {
      rising = up;
    }
    const Index level = rising ? band : band - 1;
    parameter = std::max(parameter, next_of(level));
    out.push_back({edge, level, parameter});
    ++cursor_[level - first_level_];
    band += rising ? 1 : -1;
  }
  if (band != last_band) {
    throw Error(ErrorCode::internal, "the crossings of an edge contradict the values at its ends",
                {.element = fmt::format("edge {} from vertex {} to {}", edge, mesh_.from(halfedge), mesh_.to(halfedge)),
                 .value = fmt::format("values {} and {}", from, to)});
  }
}

}  // namespace isopath
