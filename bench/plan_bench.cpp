// The stages of a plan on the wavy sheet: the curve, and the proof of its gaps.
#include <benchmark/benchmark.h>

#include "isopath/field/exact_field.h"
#include "isopath/impact/gap.h"
#include "isopath/impact/impact_plan.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

constexpr double spacing = 2;  // mm, on a sheet of 100 mm

TriangleMesh wavy(std::int64_t cells) { return test::wavy_sheet(static_cast<int>(cells), 100, 10, 0.06, 0.05, 1); }

ExactField field_of(const TriangleMesh& mesh) {
  return ExactField::compute(mesh, boundary_source(mesh), {.accuracy = 1e-7 * mesh.size()});
}

void spiral_plan(benchmark::State& state) {
  const TriangleMesh mesh = wavy(state.range(0));
  const ExactField field = field_of(mesh);
  for (auto _ : state)
    benchmark::DoNotOptimize(plan_impact(mesh, field, {.pattern = Pattern::spiral, .spacing = spacing}));
  state.counters["triangles"] = mesh.n_faces();
}
BENCHMARK(spiral_plan)->Arg(71)->Arg(158)->Arg(224)->Unit(benchmark::kMillisecond);

void gap_proof(benchmark::State& state) {
  const TriangleMesh mesh = wavy(state.range(0));
  const ImpactPlan plan = plan_impact(mesh, field_of(mesh), {.pattern = Pattern::spiral, .spacing = spacing});
  for (auto _ : state) benchmark::DoNotOptimize(measure_gap(mesh, plan.curve, spacing));
  state.counters["triangles"] = mesh.n_faces();
}
BENCHMARK(gap_proof)->Arg(71)->Arg(158)->Arg(224)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isopath
