#pragma once

#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/exact_field.h"
#include "isopath/impact/near_places.h"

namespace isopath {

/// A small part of the surface, known by its centre.
struct SpotCell {
  SurfacePoint at;
  Vec3 position = Vec3::Zero();
  double distance = 0;  ///< of the centre from the source, in the field's lengths
  double radius = 0;    ///< nothing in it is farther from the centre
};

/// A connected part of the surface that is farther from the source than a limit.
struct OpenSpot {
  std::vector<SpotCell> cells;  ///< the one with the largest distance first
};

/// Where to look: within `radius` in space of some places. Everywhere when there are none.
struct OpenSpotsNear {
  const NearPlaces* places = nullptr;
  double radius = 0;
};

/// The parts of the surface that are more than `limit` away from the source. Branch and bound over the faces: as
/// distances have slope 1, no place is missed that is more than `resolution` farther than the limit. Cells are as
/// small as that at the rim of a spot, and up to ten times as large deep inside it. In an order that depends on nothing
/// but the field; unreached faces are left out. Throws Error(cancelled) on request.
std::vector<OpenSpot> open_spots(const ExactField& field, double limit, double resolution,
                                 const Progress& progress = Progress::none(), const OpenSpotsNear& near = {});

/// A spot cut in two across its longest extent. Nothing for one no longer than `smallest`, in space.
std::vector<OpenSpot> halves_of(const OpenSpot& spot, double smallest);

}  // namespace isopath
