#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "isopath/core/geometry.h"

namespace isopath {

/// How a person names where distances are measured from, before there is a mesh: `boundary:0`, `point:1,2,3`.
/// Coordinates are in mm, vertices are numbered from 0 as in the file, boundary loops from 0, longest first.
struct SourceSpec {
  enum class Kind {
    automatic,  ///< the boundary of every component that has one; else the vertex at the end of its longest box axis
    boundary,   ///< every boundary loop, or those in `indices`
    vertex,     ///< the vertices in `indices`
    point,      ///< the point of the surface nearest to `numbers` = x, y, z
    polyline,   ///< the points of `file`, one `x,y,z` a line, brought to the surface and joined on it
    plane,      ///< where the plane nx x + ny y + nz z = d cuts the surface; `numbers` = nx, ny, nz, d
    edges,      ///< edges whose faces meet at more than `numbers` = {angle in degrees}
  };
  Kind kind = Kind::automatic;
  std::vector<Index> indices = {};
  std::vector<double> numbers = {};
  std::filesystem::path file = {};

  friend bool operator==(const SourceSpec&, const SourceSpec&) = default;
};

/// What a spec may look like, one form a line, for messages and help.
std::string_view source_spec_forms();

/// Reads `boundary`, `boundary:K`, `vertex:I,J`, `point:X,Y,Z`, `polyline:FILE.csv`, `plane:NX,NY,NZ,D`,
/// `edges:ANGLE` or `auto`. Throws Error(bad_usage) that names the spec, the value in it and what is allowed.
SourceSpec parse_source_spec(std::string_view text);

/// The text that `parse_source_spec` reads back to an equal spec; a polyline's file is written as it stands.
std::string text_of(const SourceSpec& spec);

}  // namespace isopath
