#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "isopath/core/geometry.h"

namespace isopath {

/// How a person names where distances are measured from, before there is a mesh: `boundary:0`, `point:1,2,3`.
/// Coordinates are in mm, vertices are numbered from 0 as in the file, boundary loops from 0, longest first.
/// A search varies `numbers`, in the units stated.
struct SourceSpec {
  enum class Kind {
    /// the boundary of every component that has one, for two-way curves its longest loop; else the vertex at the end of
    /// its longest box axis
    automatic,
    boundary,  ///< every boundary loop, or those in `indices`
    vertex,    ///< the vertices in `indices`
    point,     ///< the point of the surface nearest to `numbers` = x, y, z
    polyline,  ///< the points of `file`, one `x,y,z` a line, brought to the surface and joined on it
    plane,     ///< where the plane nx x + ny y + nz z = d cuts the surface; `numbers` = nx, ny, nz, d
    edges,     ///< edges whose faces meet at more than `numbers` = {angle in degrees}
    geodesic,  ///< through the points `numbers` = x, y, z, x, y, z, and straight on to the boundary either way
    /// Where a plane cuts the surface; `numbers` = x, y, z of a point in it or the one signed distance of the plane
    /// from the middle of the part's box; then the angle of its trace from x towards y, and, if not 0, how far it leans
    /// to the left of that, both in degrees (cut_normal in curve_sources.h).
    cut,
    /// A part of a boundary loop, walked with the surface on its left: from the place nearest to the first of the two
    /// points `numbers` = x, y, z, x, y, z to the one nearest to the second, or in loop `indices` between the shares
    /// `numbers` = from, to of its length.
    segment,
    offset,  ///< all places at a distance from the edges of `numbers` = angle in degrees, distance in mm
  };
  Kind kind = Kind::automatic;
  std::vector<Index> indices = {};
  std::vector<double> numbers = {};
  std::filesystem::path file = {};

  friend bool operator==(const SourceSpec&, const SourceSpec&) = default;
};

/// What a spec may look like, one form a line, for messages and help.
std::string_view source_spec_forms();

/// Reads any of the forms that `source_spec_forms` lists. Throws Error(bad_usage) that names the spec, the value in it
/// and what is allowed.
SourceSpec parse_source_spec(std::string_view text);

/// The text that `parse_source_spec` reads back to an equal spec; a polyline's file is written as it stands.
std::string text_of(const SourceSpec& spec);

}  // namespace isopath
