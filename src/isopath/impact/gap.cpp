#include "isopath/impact/gap.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "isopath/core/error.h"
#include "isopath/impact/cover_field.h"

namespace isopath {
namespace {

/// Distance between samples, in spacings: the gap, twice a distance, has slope 2, so that in the part around a sample
/// it is off by no more than 4/3 of this. Faces with sides of more than `most_divisions` parts have coarser ones.
constexpr double sample_distance = 1.0 / 6;
constexpr double most_divisions = 64;  ///< of a side
constexpr double covered_limit = 1.02;

struct Sample {
  double gap;
  double area;
};

/// Gaps at the centres of the parts of an evenly divided face.
void sample_face(const ExactField& field, Index face, double step, std::vector<Sample>& samples) {
  const TriangleMesh& mesh = field.mesh();
  double longest = 0;
  for (Index h = 3 * face; h < 3 * face + 3; ++h) longest = std::max(longest, field.geometry().length(h));
  const int n = static_cast<int>(std::clamp(std::ceil(longest / step), 1.0, most_divisions));
  const double area = mesh.face_area(face) / (n * n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n - i; ++j) {
      for (const double third : {1.0 / 3, 2.0 / 3}) {
        const Vec3 b((i + third) / n, (j + third) / n, 1 - (i + j + 2 * third) / n);
        if (b.minCoeff() < 0) continue;  // the downward part at the end of a row
        samples.push_back({2 * field.value({face, b}), area});
      }
    }
  }
}

std::vector<Sample> sample_surface(const ExactField& field, double step, const Progress& progress) {
  const Index n = field.mesh().n_faces();
  constexpr Index chunk = 64;
  std::vector<std::vector<Sample>> parts((n + chunk - 1) / chunk);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t k) {
    const auto first = static_cast<Index>(k) * chunk;
    for (Index f = first; f < std::min(n, first + chunk); ++f) {
      progress.checkpoint();  // a large face that the path crosses many times takes a while
      sample_face(field, f, step, parts[k]);
    }
  });
  std::vector<Sample> samples;
  for (const auto& part : parts) samples.insert(samples.end(), part.begin(), part.end());
  return samples;
}

}  // namespace

GapReport measure_gap(const TriangleMesh& mesh, const ImpactCurve& curve, double spacing, Progress& progress,
                      const IntrinsicGeometry* metric) {
  if (!(spacing > 0 && std::isfinite(spacing))) {
    throw Error(ErrorCode::bad_usage, "must be a positive length in mm",
                {.element = "spacing", .value = fmt::format("{}", spacing)});
  }
  progress.stage("gap");
  GapReport report;
  const CoverField cover = distance_from_cover(mesh, curve, spacing, progress, metric);
  const ExactField& field = cover.field;
  for (const double d : field.vertex_distances()) report.vertex_gap.push_back(2 * d);

  std::vector<Sample> samples = sample_surface(field, sample_distance * spacing, progress);
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
