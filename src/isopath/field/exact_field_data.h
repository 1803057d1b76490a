#pragma once

#include <span>
#include <utility>
#include <vector>

#include "isopath/field/edge_windows.h"
#include "isopath/field/face_trees.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/source.h"
#include "isopath/field/vertex_fan.h"

namespace isopath {

/// What an exact field keeps: the windows of every edge side by side, vertex distances and roots, and which sources lie
/// in a face.
struct ExactFieldData {
  ExactFieldData(const TriangleMesh& m, IntrinsicGeometry g, const SourceSet& s)
      : mesh(m), geometry(std::move(g)), sources(s) {}

  /// A source element in the frame of half-edge 3·face of a face that it touches.
  struct PlacedSource {
    Index id = no_index;
    Vec2 a = Vec2::Zero();
    Vec2 b = Vec2::Zero();
    double squared_length = 0;  ///< zero for a point
  };
  /// A run of sources of one face with the box around them. Elements of a polyline follow each other, so the boxes are
  /// small.
  struct SourceBlock {
    Eigen::AlignedBox2d box;
    std::size_t first = 0;
    std::size_t past = 0;
  };
  std::span<const SourceBlock> source_blocks_in(Index face) const {
    return {source_blocks.data() + first_block[face], source_blocks.data() + first_block[face + 1]};
  }
  std::span<const PlacedSource> sources_in(Index face) const {
    return {face_sources.data() + first_source[face], face_sources.data() + first_source[face + 1]};
  }

  const TriangleMesh& mesh;
  IntrinsicGeometry geometry;
  SourceSet sources;
  EdgeWindows windows;
  std::vector<double> distance;            ///< per vertex
  std::vector<Index> root;                 ///< per vertex
  std::vector<FanArc> fans;                ///< per half-edge: what its tail, as a pseudo-source, sends into its face
  std::vector<PlacedSource> face_sources;  ///< face by face, by id
  std::vector<std::size_t> first_source;
  std::vector<SourceBlock> source_blocks;  ///< face by face
  std::vector<std::size_t> first_block;
  FaceTrees trees;  ///< empty unless many questions are expected
  std::size_t propagated = 0;
  double reach = infinity;  ///< beyond it windows may be missing
};

/// The way from a point of a face back towards the sources: straight to a source inside the face, to a corner, or
/// through an edge.
struct WayBack {
  enum class Stop { none, source, vertex, edge };
  double distance = infinity;  ///< length of the whole path
  Index root = no_index;
  Stop stop = Stop::none;
  Index at = no_index;             ///< source element, vertex, or half-edge of the face
  double x = 0;                    ///< on the half-edge, or fraction along the source element
  Vec2 towards = Vec2::Zero();     ///< to the unfolded source, in the frame of half-edge 3·face
  bool straight = false;           ///< a front of parallel rays: of `towards` only the direction means something
  std::size_t placed = 0;          ///< index of the placed source in ExactFieldData
  const Window* window = nullptr;  ///< that it goes by through the edge
};

/// Edges of a face that a way back must not go through, by the corner index of their tail.
struct SkippedEdges {
  bool skip[3] = {false, false, false};
  bool leaving = false;  ///< nor to where a front leaves the face: it comes by p, but goes away from the source
};

/// The shortest way back from a point of a face, not through the skipped edges, nor to corners that hold the point
/// itself.
WayBack best_way_back(const ExactFieldData& data, Index face, const Vec3& barycentric,
                      const SkippedEdges& skipped = {});

}  // namespace isopath
