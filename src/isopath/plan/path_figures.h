#pragma once

#include "isopath/impact/impact_curve.h"

namespace isopath {

/// Figures of an impact curve that tell how smoothly a tool can follow it.
struct PathFigures {
  double cover_length = 0;  ///< mm
  double links_length = 0;  ///< mm
  Index pieces = 0;         ///< stretches between lifts
  Index lifts = 0;
  /// Smallest radius of the circles through a point of a covering stretch and the points half a spacing of arc before
  /// and behind it, or half the radius that corners were rounded with; infinity where all is straight or too short. A
  /// window that long sees the curve and not its chords.
  double min_radius = infinity;
  /// Turns by more than 45 degrees on the surface, seen over a twentieth of the spacing on either side, so that neither
  /// a chain of tiny chords hides a corner nor noise between them makes one.
  Index sharp_corners = 0;
  /// Turns by more than 45 degrees on the surface, seen over a quarter of the spacing on either side: where a machine
  /// that goes fast slows down, however the corner is rounded. A full circle this small is several.
  Index tight_turns = 0;
};

/// `radius` is what corners were rounded with, mm; 0 where they were not. Throws Error(bad_usage) unless spacing > 0.
PathFigures path_figures(const ImpactCurve& curve, double spacing, double radius = 0);

}  // namespace isopath
