#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/core/progress.h"

namespace isopath {

/// A way through a run of passes: where it can be entered, and where the curve then comes out.
struct Gate {
  std::vector<Vec3> entry;  ///< any of these points: a single end of an open pass, or samples of a closed one
  std::vector<Vec3> exit;
};

/// Every k-th of some places, so that about `most` are left.
std::vector<Vec3> samples_of(std::span<const Vec3> places, std::size_t most);

/// The gates of a run that is one curve through these places: from its start and from its end; of a closed one a
/// single gate, as it is entered and left at any of 48 samples.
std::vector<Gate> gates_of_curve(std::span<const Vec3> places, bool closed);

/// The run to do next and the gate to enter it by.
struct Visit {
  std::size_t run = 0;
  std::size_t gate = 0;
};

/// An order of runs, and a gate for each, with short ways between them: nearest neighbour from up to 127 starts, evenly
/// spread over all gates, each improved by moving single runs; the best kept. Ways longer than `longest_link` cost
/// `lift_cost` more, as the tool has to leave the surface. Throws Error(cancelled) on request.
std::vector<Visit> order_runs(const std::vector<std::vector<Gate>>& runs, double longest_link, double lift_cost,
                              const Progress& progress = Progress::none());

}  // namespace isopath
