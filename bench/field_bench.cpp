// Distance fields on a wavy open sheet (saddles everywhere: many windows) and a hemisphere (none), by triangles and
// bound on the error.
#include <benchmark/benchmark.h>

#include "isopath/contour/contour_graph.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/fast_marching.h"
#include "isopath/field/graph_field.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

/// Two triangles a cell; 100 mm wide, waves 10 mm high.
TriangleMesh wavy(std::int64_t cells) { return test::wavy_sheet(static_cast<int>(cells), 100, 10, 0.06, 0.05, 1); }

SourceSet one_vertex(const TriangleMesh& mesh) {
  SourceSet source;
  source.add_vertex(mesh, 0);
  return source;
}

void run_exact(benchmark::State& state, const TriangleMesh& mesh, const SourceSet& source, double accuracy) {
  std::size_t kept = 0;
  std::size_t propagated = 0;
  for (auto _ : state) {
    const ExactField field = ExactField::compute(mesh, source, {.accuracy = accuracy * mesh.size()});
    kept = field.windows_kept();
    propagated = field.windows_propagated();
  }
  state.counters["triangles"] = mesh.n_faces();
  state.counters["windows"] = static_cast<double>(kept);
  state.counters["windows/edge"] = static_cast<double>(kept) / mesh.n_edges();
  state.counters["ns/window"] =
      benchmark::Counter(1e-9 * static_cast<double>(propagated),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Arguments: cells a side; the bound on the error as a power of ten of the size, 0 for exact.
double accuracy_of(std::int64_t exponent) { return exponent == 0 ? 0 : std::pow(10.0, static_cast<double>(exponent)); }

void exact_from_boundary(benchmark::State& state) {
  const TriangleMesh mesh = wavy(state.range(0));
  run_exact(state, mesh, boundary_source(mesh), accuracy_of(state.range(1)));
}
BENCHMARK(exact_from_boundary)->ArgsProduct({{71, 158, 224}, {0, -8, -7, -6}})->Unit(benchmark::kMillisecond);

void exact_from_vertex(benchmark::State& state) {
  const TriangleMesh mesh = wavy(state.range(0));
  run_exact(state, mesh, one_vertex(mesh), accuracy_of(state.range(1)));
}
BENCHMARK(exact_from_vertex)->ArgsProduct({{71, 158}, {0, -7, -6}})->Unit(benchmark::kMillisecond);

void exact_on_hemisphere(benchmark::State& state) {
  const TriangleMesh mesh =
      test::hemisphere(static_cast<int>(state.range(0)), static_cast<int>(2 * state.range(0)), 60);
  run_exact(state, mesh, boundary_source(mesh), 0);
}
BENCHMARK(exact_on_hemisphere)->Arg(80)->Arg(160)->Unit(benchmark::kMillisecond);

void graph_from_vertex(benchmark::State& state) {
  const TriangleMesh mesh = wavy(state.range(0));
  const SourceSet source = one_vertex(mesh);
  for (auto _ : state) benchmark::DoNotOptimize(graph_distances(mesh, source));
}
BENCHMARK(graph_from_vertex)->Arg(158)->Unit(benchmark::kMillisecond);

void fast_marching_from_vertex(benchmark::State& state) {
  const TriangleMesh mesh = wavy(state.range(0));
  const SourceSet source = one_vertex(mesh);
  for (auto _ : state) benchmark::DoNotOptimize(fast_marching_distances(mesh, source));
}
BENCHMARK(fast_marching_from_vertex)->Arg(158)->Unit(benchmark::kMillisecond);

void fifty_isolines(benchmark::State& state) {
  const TriangleMesh mesh = wavy(state.range(0));
  const ExactField field = ExactField::compute(mesh, boundary_source(mesh), {.accuracy = 1e-7 * mesh.size()});
  std::vector<double> levels;
  for (int k = 1; k <= 50; ++k) levels.push_back(k * field.max_vertex_distance() / 51);
  for (auto _ : state) benchmark::DoNotOptimize(contour_set(mesh, field, levels));
}
BENCHMARK(fifty_isolines)->Arg(158)->Arg(224)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isopath
