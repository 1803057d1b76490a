#include "isopath/impact/gap.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "isopath/core/error.h"
#include "isopath/field/face_part.h"

namespace isopath {
namespace {

/// Size of the parts that samples stand for, in spacings: the gap, twice a distance, has slope 2, so that in the part
/// around a sample it is off by no more than twice this. Faces of more than 2^`most_halvings` parts have larger ones.
constexpr double sample_radius = 1.0 / 9;
constexpr int most_halvings = 12;
constexpr double covered_limit = 1.02;

struct Sample {
  double gap;
  double area;
};

/// Gaps at the centres of the parts of a face, no farther than `radius` from anything in their part.
void sample_face(const ExactField& field, Index face, double radius, std::vector<Sample>& samples) {
  const TriangleMesh& mesh = field.mesh();
  const double area = mesh.face_area(face);
  const IntrinsicGeometry& geometry = field.geometry();
  const Vec2 apex = geometry.apex(3 * face);
  const FaceCorners corners = {Vec3::Zero(), Vec3(geometry.length(3 * face), 0, 0), Vec3(apex.x(), apex.y(), 0)};
  std::vector<FacePart> parts{FacePart::whole(face)};
  while (!parts.empty()) {
    const FacePart part = parts.back();
    parts.pop_back();
    if (part.depth < most_halvings && radius_of(corners, part) > radius) {
      halve(corners, part, parts);
    } else {
      samples.push_back({2 * field.value({face, part.centre()}), std::ldexp(area, -part.depth)});
    }
  }
}

std::vector<Sample> sample_surface(const ExactField& field, double radius, const Progress& progress) {
  const Index n = field.mesh().n_faces();
  constexpr Index chunk = 4;  // a large face may take as long as thousands of small ones
  std::vector<std::vector<Sample>> parts((n + chunk - 1) / chunk);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t k) {
    const auto first = static_cast<Index>(k) * chunk;
    for (Index f = first; f < std::min(n, first + chunk); ++f) {
      progress.checkpoint();  // a large face that the path crosses many times takes a while
      sample_face(field, f, radius, parts[k]);
    }
  });
  std::vector<Sample> samples;
  for (const auto& part : parts) samples.insert(samples.end(), part.begin(), part.end());
  return samples;
}

void validate_spacing(double spacing) {
  if (spacing > 0 && std::isfinite(spacing)) return;
  throw Error(ErrorCode::bad_usage, "must be a positive length in mm",
              {.element = "spacing", .value = fmt::format("{}", spacing)});
}

}  // namespace

GapReport measure_gap(const TriangleMesh& mesh, const ImpactCurve& curve, double spacing, Progress& progress,
                      const IntrinsicGeometry* metric) {
  validate_spacing(spacing);
  progress.stage("gap");
  return measure_gap(distance_from_cover(mesh, curve, spacing, progress, metric), spacing, progress);
}

GapReport measure_gap(const CoverField& cover, double spacing, Progress& progress) {
  validate_spacing(spacing);
  GapReport report;
  const ExactField& field = cover.field;
  const TriangleMesh& mesh = field.mesh();
  for (const double d : field.vertex_distances()) report.vertex_gap.push_back(2 * d);

  std::vector<Sample> samples = sample_surface(field, sample_radius * spacing, progress);
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.gap < b.gap; });
  report.histogram.assign(41, 0.0);
  double sum = 0;
  double square_sum = 0;
  double covered = 0;
  for (const Sample& s : samples) {
    report.area += s.area;
    sum += s.area * s.gap;
    square_sum += s.area * s.gap * s.gap;
    if (s.gap <= covered_limit * spacing) covered += s.area;
    report.histogram[static_cast<std::size_t>(std::min(40.0, 20 * s.gap / spacing))] += s.area;
  }
  report.max = samples.back().gap;
  for (Index v = 0; v < mesh.n_vertices(); ++v) {
    if (mesh.outgoing(v) != no_index) report.max = std::max(report.max, report.vertex_gap[v]);
  }
  report.mean = sum / report.area;
  report.cv = infinity;
  if (report.mean < infinity)
    report.cv = std::sqrt(std::max(0.0, square_sum / report.area - report.mean * report.mean)) / report.mean;
  report.covered_fraction = covered / report.area;
  double below = 0;
  for (const Sample& s : samples) {
    below += s.area;
    report.p99 = s.gap;
    if (below >= 0.99 * report.area) break;
  }
  for (double& share : report.histogram) share /= report.area;
  return report;
}

}  // namespace isopath
