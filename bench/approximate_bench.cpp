// Methods for approximate distances: vertices a second, and true errors against the exact field.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "bumpy_ball.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/fast_marching.h"
#include "isopath/field/graph_field.h"
#include "isopath/field/virtual_source.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

using Method = std::function<std::vector<double>(const TriangleMesh&, const SourceSet&)>;

std::vector<double> virtual_sources(const TriangleMesh& mesh, const SourceSet& sources) {
  return virtual_source_distances(mesh, sources);
}
std::vector<double> fast_marching(const TriangleMesh& mesh, const SourceSet& sources) {
  return fast_marching_distances(mesh, sources);
}
std::vector<double> graph(const TriangleMesh& mesh, const SourceSet& sources) {
  return graph_distances(mesh, sources, {.virtual_vertices = 0, .across_pairs = true});
}

TriangleMesh wavy(std::int64_t cells) { return test::wavy_sheet(static_cast<int>(cells), 1, 0.1, 6, 5, 1); }
TriangleMesh ball(std::int64_t level) { return bumpy_ball(static_cast<int>(level)); }
TriangleMesh blade(std::int64_t cells) { return test::lofted_blade(static_cast<int>(cells), static_cast<int>(cells)); }

/// Errors are measured on meshes of up to this many triangles; on larger ones exact distances take too long to compare.
constexpr Index most_compared = 100'000;

void count_errors(benchmark::State& state, const std::vector<double>& distances, const ExactField& exact) {
  double sum = 0;
  double largest = 0;
  std::size_t n = 0;
  for (std::size_t v = 0; v < distances.size(); ++v) {
    const double truth = exact.vertex_distances()[v];
    if (!(truth > 0) || truth == infinity) continue;
    const double error = std::abs(distances[v] - truth) / truth;
    sum += error;
    largest = std::max(largest, error);
    ++n;
  }
  state.counters["mean_error_%"] = 100 * sum / static_cast<double>(n);
  state.counters["max_error_%"] = 100 * largest;
}

void run(benchmark::State& state, const Method& method, const TriangleMesh& mesh, const SourceSet& sources) {
  std::vector<double> distances;
  for (auto _ : state) distances = method(mesh, sources);
  state.counters["triangles"] = mesh.n_faces();
  state.counters["vertices/s"] = benchmark::Counter(mesh.n_vertices(), benchmark::Counter::kIsIterationInvariantRate);
  if (mesh.n_faces() > most_compared) return;
  count_errors(state, distances, ExactField::compute(mesh, sources, {.accuracy = 1e-7 * mesh.size()}));
}

void from_vertex(benchmark::State& state, const Method& method, TriangleMesh (*make)(std::int64_t)) {
  const TriangleMesh mesh = make(state.range(0));
  SourceSet source;
  source.add_vertex(mesh, mesh.n_vertices() / 2);
  run(state, method, mesh, source);
}

void from_boundary(benchmark::State& state, const Method& method, TriangleMesh (*make)(std::int64_t)) {
  const TriangleMesh mesh = make(state.range(0));
  run(state, method, mesh, boundary_source(mesh));
}

/// With the mesh prepared before.
void from_vertex_prepared(benchmark::State& state, TriangleMesh (*make)(std::int64_t)) {
  const TriangleMesh mesh = make(state.range(0));
  const VirtualSourceSolver solver(mesh);
  SourceSet source;
  source.add_vertex(mesh, mesh.n_vertices() / 2);
  run(
      state, [&](const TriangleMesh&, const SourceSet& sources) { return solver.distances(sources); }, mesh, source);
}

void from_boundary_prepared(benchmark::State& state, TriangleMesh (*make)(std::int64_t)) {
  const TriangleMesh mesh = make(state.range(0));
  const VirtualSourceSolver solver(mesh);
  run(
      state, [&](const TriangleMesh&, const SourceSet& sources) { return solver.distances(sources); }, mesh,
      boundary_source(mesh));
}

#define ISOPATH_APPROXIMATE(method)                                                                                 \
  BENCHMARK_CAPTURE(from_vertex, method##_wavy, method, wavy)->Arg(200)->Arg(500)->Unit(benchmark::kMillisecond);   \
  BENCHMARK_CAPTURE(from_boundary, method##_wavy, method, wavy)->Arg(200)->Arg(500)->Unit(benchmark::kMillisecond); \
  BENCHMARK_CAPTURE(from_vertex, method##_blade, method, blade)->Arg(100)->Unit(benchmark::kMillisecond);           \
  BENCHMARK_CAPTURE(from_boundary, method##_blade, method, blade)->Arg(100)->Unit(benchmark::kMillisecond)

ISOPATH_APPROXIMATE(virtual_sources);
ISOPATH_APPROXIMATE(fast_marching);
ISOPATH_APPROXIMATE(graph);
BENCHMARK_CAPTURE(from_vertex, virtual_sources_wavy, virtual_sources, wavy)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_boundary, virtual_sources_wavy, virtual_sources, wavy)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_vertex, virtual_sources_ball, virtual_sources, ball)->Arg(6)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_vertex_prepared, wavy, wavy)->Arg(200)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_boundary_prepared, wavy, wavy)->Arg(200)->Arg(500)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_vertex_prepared, blade, blade)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_boundary_prepared, blade, blade)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_vertex_prepared, ball, ball)->Arg(6)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isopath
