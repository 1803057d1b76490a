#pragma once

#include <span>

#include "isopath/field/exact_field_data.h"

namespace isopath {

/// Across a face that is lower than this part of its longest edge, and on edges themselves, ways on both sides may be
/// equally long, so that each edge keeps a front that leaves the face and none one that enters.
inline constexpr double flattest_face = 1e-6;
bool lies_flat(const IntrinsicGeometry& geometry, Index face);

/// Length of the shortest way from p, in the frame of the edge's canonical half-edge, through a window that leads to
/// its side.
double way_by(const Window& w, const Vec2& p);
double squared_distance(const ExactFieldData::PlacedSource& source, const Vec2& p);

/// The shortest of the ways back by some windows and sources, and by the corners.
WayBack best_way_back_among(const ExactFieldData& data, Index face, const Vec3& barycentric,
                            std::span<const NearCandidate> candidates, const SkippedEdges& skipped = {});

}  // namespace isopath
