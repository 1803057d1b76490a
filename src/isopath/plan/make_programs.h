#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "isopath/plan/job.h"
#include "isopath/plan/output_folder.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

/// The file name that a program in this format gets: `program_FORMAT` with the format's suffix.
std::string program_name(std::string_view format);

/// The path as a program in each format the job names, `program_FORMAT` with the format's suffix. Where it names none:
/// 5-axis G-code, or, with a warning, poses when the machine's table cannot reach all axes.
/// Throws Error(no_plan) when a format that the job names cannot hold the path.
std::vector<OutputFile> make_programs(const ToolPath& path, const Job& job, std::vector<std::string>& warnings);

}  // namespace isopath
