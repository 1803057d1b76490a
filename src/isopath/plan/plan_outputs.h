#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/plan/output_folder.h"
#include "isopath/plan/plan_result.h"

namespace isopath {

/// The figures of a run as one JSON object: `area`, `spacing`, `pattern`, `cover_length`, `length_ratio`, `pieces`,
/// `lifts`, `links_length`, `gap` (`max`, `p99`, `mean`, `cv`, all over the spacing), `covered_fraction`, `min_radius`
/// (null where the path is straight), `sharp_corners`, `tight_turns`, `path_time_s`, `time_s` per stage,
/// `peak_memory_mb`, `warnings`; with a partition `patches` in the order of work (`pattern`, `area`, `cover_length`,
/// `pieces`, `gap` of each by itself); where the planner chose between spirals `spiral` (`blended`, `why`, and what
/// `by_distance`, `by_blend` and `by_two_way` cost, of those that were tried); with smoothing `smoothing` (`width`,
/// `gap_before_repair` over the spacing, `repair`, and what all `ways` to close gaps cost); where the job asks for a
/// smallest radius `tight_places`, those with less (`at`, `radius`). Only `time_s` and `peak_memory_mb` differ from run
/// to run.
std::string summary_json(const PlanResult& result);

/// All files of a run: summary.json, impact.csv, tool.csv, path.vtp, the programs, job.yaml (with paths relative to
/// `folder`) and report.html.
std::vector<OutputFile> plan_outputs(const PlanResult& result, const std::filesystem::path& folder);

/// Names of programs in the folder that this run did not write and that the planner's own naming shows to be of an
/// earlier run: nobody should take one of them for the program of this run. They stay, as all other files do.
std::vector<std::string> earlier_programs(const std::filesystem::path& folder, const std::vector<OutputFile>& programs);

/// Writes them, all or none. Throws Error(bad_input) naming the folder when it cannot be written.
void write_outputs(const PlanResult& result, const std::filesystem::path& folder,
                   Progress& progress = Progress::none());

}  // namespace isopath
