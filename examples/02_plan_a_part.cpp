// The whole chain in one call: from a part in a file to a folder with figures, path, program and report.
//   02_plan_a_part PART FOLDER
#include <cstdio>

#include "isopath/core/error.h"
#include "isopath/plan/plan_outputs.h"
#include "isopath/plan/run_plan.h"

using namespace isopath;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s PART FOLDER\n", argv[0]);
    return 2;
  }
  try {
    Job job;
    job.mesh = argv[1];
    job.sources = {parse_source_spec("boundary")};  // what `--source boundary` means on the command line
    job.pattern = Pattern::spiral;
    job.spacing = 4;  // mm between neighbouring passes
    job.tool.process = Process::grind;
    job.tool.ball_diameter = 12;

    const PlanResult result = run_plan(job);
    for (const std::string& warning : result.warnings) std::printf("note: %s\n", warning.c_str());
    std::printf("%.1f %% of %.6g mm2 covered by %.6g mm of passes; widest gap %.3f spacings; %d lifts\n",
                100 * result.gap.covered_fraction, result.gap.area, result.figures.cover_length,
                result.gap.max / result.spacing, result.figures.lifts);
    write_outputs(result, argv[2]);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
