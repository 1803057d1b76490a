#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

#include "isopath/plan/run_plan.h"
#include "support/test_meshes.h"

namespace isopath::test {

/// The plan of a mesh, by way of a file named after the running test; without a report.
inline PlanResult plan_spiral(const TriangleMesh& mesh, std::optional<Pattern> pattern, Blending blend,
                              double spacing) {
  Job job;
  job.pattern = pattern;
  job.blend = blend;
  job.spacing = spacing;
  const auto folder = std::filesystem::path(testing::TempDir());
  job.mesh = folder / (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".off");
  write_off(mesh, job.mesh);
  job.report = false;
  return run_plan(job);
}

}  // namespace isopath::test
