// Stage by stage, with a function of your own in place of the distance: passes are its isolines. Here it is the
// distance from an axis through the part, so that the passes are rings around the axis.
//   04_your_own_function PART OUT.vtp
#include <cmath>
#include <cstdio>
#include <vector>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"
#include "isopath/field/vertex_field.h"
#include "isopath/impact/gap.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/mesh/read_mesh.h"
#include "isopath/post/path_vtp.h"
#include "isopath/tool/make_tool_path.h"

using namespace isopath;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s PART OUT.vtp\n", argv[0]);
    return 2;
  }
  try {
    const TriangleMesh mesh(read_mesh(argv[1]).soup);

    const Vec3 centre = mesh.bounds().center();
    std::vector<double> values;
    for (Index v = 0; v < mesh.n_vertices(); ++v) {
      values.push_back(std::hypot(mesh.position(v).x() - centre.x(), mesh.position(v).y() - centre.y()));
    }
    const VertexField around_axis(mesh, std::move(values));

    // Isolines, contour graph, spirals and links: where the function is not a distance, the gap tells how even it is.
    const double spacing = 5;
    const ImpactPlan plan = plan_impact(mesh, around_axis, {.pattern = Pattern::contour, .spacing = spacing});
    const GapReport gap = measure_gap(mesh, plan.curve, spacing);
    std::printf("widest gap %.2f spacings, 99 %% of the area below %.2f\n", gap.max / spacing, gap.p99 / spacing);

    const ToolPath path = make_tool_path(plan.curve, {.process = Process::spray, .stand_off = 200});
    write_file_atomically(argv[2], path_vtp(path));
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
