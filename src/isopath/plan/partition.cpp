#include "isopath/plan/partition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "isopath/contour/medial_cuts.h"
#include "isopath/core/angle.h"
#include "isopath/core/error.h"
#include "isopath/core/quiet_progress.h"
#include "isopath/field/exact_field.h"
#include "isopath/mesh/cut_along.h"
#include "isopath/mesh/sub_mesh.h"

namespace isopath {
namespace {

/// A cut at least halves the logarithm of the unevenness, so that few rounds are needed.
constexpr int most_rounds = 8;
/// Where no more passes than these lie between border and axis, parting wide from narrow has nothing to even out.
constexpr double least_passes = 3;
/// Into so many patches creases may divide a component.
constexpr Index most_patches = 500;

std::vector<char> creases(const TriangleMesh& mesh, double angle) {
  std::vector<char> is_crease(mesh.n_edges(), 0);
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    if (mesh.is_boundary_edge(e)) continue;
    const Index h = mesh.halfedge_of(e);
    const Vec3 a = mesh.face_normal(TriangleMesh::face_of(h));
    const Vec3 b = mesh.face_normal(TriangleMesh::face_of(mesh.twin(h)));
    // A triangle without area has no normal, and hence no crease.
    if (a.isZero(0) || b.isZero(0)) continue;
    is_crease[e] = angle_between(a, b) > angle;
  }
  return is_crease;
}

std::vector<char> borders(const TriangleMesh& mesh, std::span<const Index> patch) {
  std::vector<char> is_border(mesh.n_edges(), 0);
  for (Index e = 0; e < mesh.n_edges(); ++e) {
    const Index h = mesh.halfedge_of(e);
    const Index g = mesh.twin(h);
    is_border[e] = g != no_index && patch[TriangleMesh::face_of(h)] != patch[TriangleMesh::face_of(g)];
  }
  return is_border;
}

/// Cuts the patches of a partition, round by round, until their medial axes are even or nothing is won any more.
class MedialSplitter {
 public:
  MedialSplitter(Partition& parts, double spacing, double unevenness, Progress& progress)
      : parts_(parts),
        least_clearance_(least_passes * spacing),
        options_{.unevenness = unevenness},
        progress_(progress) {}

  void run() {
    std::vector<char> open(parts_.n_patches, 1);  // patches still to be looked at
    for (int round = 0; round < most_rounds && std::count(open.begin(), open.end(), 1) > 0; ++round) {
      const std::vector<std::vector<SurfacePoint>> lines = lines_of(open);
      if (lines.empty()) return;
      open = cut(lines);
    }
  }

 private:
  std::vector<std::vector<SurfacePoint>> lines_of(const std::vector<char>& open) {
    std::vector<std::vector<SurfacePoint>> lines;
    const std::vector<SubMesh> patches = split_mesh(parts_.mesh, parts_.patch_of_face);
    QuietProgress quiet(progress_);
    for (std::size_t p = 0; p < patches.size(); ++p) {
      progress_.at(static_cast<double>(p) / static_cast<double>(patches.size()));
      if (!open[p] || patches[p].mesh.boundary_loops().empty()) continue;
      const ExactField field = ExactField::compute(patches[p].mesh, boundary_source(patches[p].mesh), {}, quiet);
      MedialCuts cuts = medial_cuts(field, options_, quiet);
      if (cuts.greatest_clearance < least_clearance_) continue;
      for (auto& line : cuts.lines) {
        for (SurfacePoint& point : line) point = patches[p].on_whole(point);
        lines.push_back(std::move(line));
      }
    }
    return lines;
  }

  /// Returns which of the new patches are parts of an old one that was divided.
  std::vector<char> cut(const std::vector<std::vector<SurfacePoint>>& lines) {
    CutMesh made = cut_along(parts_.mesh, lines);
    const TriangleMesh& mesh = made.refined.mesh;
    std::vector<Index> old_patch;
    for (const Index f : made.refined.old_face) old_patch.push_back(parts_.patch_of_face[f]);
    std::vector<char> separates = borders(mesh, old_patch);
    for (Index e = 0; e < mesh.n_edges(); ++e) separates[e] = separates[e] || made.is_cut[e];
    std::vector<Index> patch = parts_between_cuts(mesh, separates);
    const Index n = *std::max_element(patch.begin(), patch.end()) + 1;
    std::vector<Index> old_of(n, no_index);
    std::vector<Index> n_new(parts_.n_patches, 0);
    for (std::size_t f = 0; f < patch.size(); ++f) {
      if (old_of[patch[f]] == no_index) ++n_new[old_patch[f]];
      old_of[patch[f]] = old_patch[f];
    }
    std::vector<char> open;
    for (const Index old : old_of) open.push_back(n_new[old] > 1);
    parts_ = {std::move(made.refined.mesh), std::move(patch), n};
    return open;
  }

  Partition& parts_;
  double least_clearance_;
  MedialCutOptions options_;
  Progress& progress_;
};

/// Joins patches too narrow for a pass to their neighbours, the smallest first.
class Joiner {
 public:
  explicit Joiner(const Partition& parts)
      : area_(parts.n_patches, 0), rim_(parts.n_patches, 0), shared_(parts.n_patches) {
    const TriangleMesh& mesh = parts.mesh;
    for (Index f = 0; f < mesh.n_faces(); ++f) area_[parts.patch_of_face[f]] += mesh.face_area(f);
    for (Index h = 0; h < mesh.n_halfedges(); ++h) {
      const Index p = parts.patch_of_face[TriangleMesh::face_of(h)];
      const Index g = mesh.twin(h);
      const Index q = g == no_index ? no_index : parts.patch_of_face[TriangleMesh::face_of(g)];
      if (p == q) continue;
      rim_[p] += mesh.edge_length(mesh.edge_of(h));
      if (q != no_index) shared_[p][q] += mesh.edge_length(mesh.edge_of(h));
    }
    for (Index p = 0; p < parts.n_patches; ++p) into_.push_back(p);
  }

  void join_narrower_than(double width) {
    std::set<std::pair<double, Index>> narrow;
    const auto enqueue = [&](Index p) {
      if (2 * area_[p] < width * rim_[p] && !shared_[p].empty()) narrow.emplace(area_[p], p);
    };
    for (Index p = 0; p < static_cast<Index>(area_.size()); ++p) enqueue(p);
    while (!narrow.empty()) {
      const Index p = narrow.begin()->second;
      narrow.erase(narrow.begin());
      Index best = shared_[p].begin()->first;
      for (const auto& [q, length] : shared_[p]) best = length > shared_[p][best] ? q : best;
      narrow.erase({area_[best], best});
      join(p, best);
      enqueue(best);
    }
  }

  void relabel(Partition& parts) const {
    std::vector<Index> number(into_.size(), no_index);
    Index n = 0;
    for (Index& patch : parts.patch_of_face) {
      Index root = patch;
      while (into_[root] != root) root = into_[root];
      if (number[root] == no_index) number[root] = n++;
      patch = number[root];
    }
    parts.n_patches = n;
  }

 private:
  void join(Index p, Index into) {
    into_[p] = into;
    area_[into] += area_[p];
    rim_[into] += rim_[p] - 2 * shared_[p][into];
    for (const auto& [q, length] : shared_[p]) {
      shared_[q].erase(p);
      if (q == into) continue;
      shared_[q][into] += length;
      shared_[into][q] += length;
    }
    shared_[p].clear();
  }

  std::vector<double> area_;
  std::vector<double> rim_;  // length of the whole border
  std::vector<std::map<Index, double>> shared_;
  std::vector<Index> into_;
};

/// Every patch costs a field, a plan and a measurement. Where there are so many, the angle takes every edge for a
/// crease.
void check_count(const Partition& parts, double spacing, const PartitionOptions& options) {
  if (parts.n_patches - parts.mesh.n_components() < most_patches) return;
  throw Error(
      ErrorCode::no_plan, "the creases divide the part into too many patches",
      {.element = "crease_angle",
       .value = fmt::format("{:.4g} degrees makes {} patches at a spacing of {:.4g} mm, limit {}",
                            options.crease_angle * 180 / std::numbers::pi, parts.n_patches, spacing, most_patches),
       .advice = "give a larger angle, or a larger spacing: patches narrower than that are joined"});
}

}  // namespace

std::string_view name_of(PartitionBy by) {
  switch (by) {
    case PartitionBy::none:
      return "none";
    case PartitionBy::creases:
      return "creases";
    case PartitionBy::medial:
      return "medial";
    case PartitionBy::both:
      return "both";
  }
  return "";
}

void PartitionOptions::validate() const {
  const auto reject = [](const char* element, double value, const char* limit) {
    throw Error(ErrorCode::bad_usage, "the part cannot be divided like this",
                {.element = element, .value = fmt::format("{}, allowed is {}", value, limit)});
  };
  if (!(crease_angle > 0 && crease_angle < std::numbers::pi)) {
    reject("crease_angle", crease_angle, "above 0 and below π (180 degrees)");
  }
  if (!(unevenness > 1 && std::isfinite(unevenness))) reject("unevenness", unevenness, "above 1");
}

Partition partition(TriangleMesh mesh, double spacing, const PartitionOptions& options, Progress& progress) {
  options.validate();
  if (!(spacing > 0 && std::isfinite(spacing))) {
    throw Error(ErrorCode::bad_usage, "must be a positive length in mm",
                {.element = "spacing", .value = fmt::format("{}", spacing)});
  }
  progress.stage("partition");
  const bool by_creases = options.by == PartitionBy::creases || options.by == PartitionBy::both;
  const bool by_axis = options.by == PartitionBy::medial || options.by == PartitionBy::both;
  Partition parts{std::move(mesh), {}, 0};
  const std::vector<char> nowhere(parts.mesh.n_edges(), 0);
  parts.patch_of_face =
      parts_between_cuts(parts.mesh, by_creases ? creases(parts.mesh, options.crease_angle) : nowhere);
  for (const Index patch : parts.patch_of_face) parts.n_patches = std::max(parts.n_patches, patch + 1);
  const auto join = [&] {
    Joiner joiner(parts);
    joiner.join_narrower_than(spacing);
    joiner.relabel(parts);
  };
  join();
  check_count(parts, spacing, options);
  if (by_axis) {
    MedialSplitter(parts, spacing, options.unevenness, progress).run();
    join();
  }
  return parts;
}

}  // namespace isopath
