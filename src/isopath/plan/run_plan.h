#pragma once

#include "isopath/core/progress.h"
#include "isopath/plan/job.h"
#include "isopath/plan/plan_result.h"

namespace isopath {

/// Runs the whole chain: reads and repairs the part, warps it where a scallop is asked for, computes the field of the
/// sources, connects its isolines to an impact curve, measures the gap and lifts the curve to a tool path. Depends on
/// nothing but the job and its files: the same job gives the same result, but for times and memory. Throws
/// Error(bad_usage) for a job that cannot be run (also one of more than 20000 passes, or with lifts higher than 1000
/// times the part's size), Error(bad_input) for a file, Error(no_plan) with the reason when nothing can be covered
/// (also when the spacing exceeds the part's size), Error(cancelled) on request.
PlanResult run_plan(const Job& job, Progress& progress = Progress::none());

}  // namespace isopath
