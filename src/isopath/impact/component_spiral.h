#pragma once

#include <vector>

#include "isopath/contour/isolines.h"
#include "isopath/contour/turn_angle.h"
#include "isopath/core/progress.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/surface_curve.h"

namespace isopath {

struct ComponentSpiralOptions {
  double spacing = 0;  ///< between levels, mm; required, > 0
  int arms = 1;        ///< 1 or 2, see LevelSpiralOptions
};

/// The spiral of one component through its nested closed levels `rings`, one for each (k - ½) × spacing from the rim
/// up and more of them than arms: the level set that level_spiral describes, traced through `faces`, those that the
/// function reaches. `angle` counts turns around the top. The turn that levels are changed at is chosen where they run
/// straight and a spacing apart. Throws Error(cancelled) on request.
SurfaceCurve component_spiral(const SurfaceLinker& linker, const VertexField& function, const TurnAngle& angle,
                              const std::vector<Index>& faces, const std::vector<const Contour*>& rings,
                              const ComponentSpiralOptions& options, const Progress& progress = Progress::none());

}  // namespace isopath
