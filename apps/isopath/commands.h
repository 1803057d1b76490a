#pragma once

#include "console.h"

namespace isopath::app {

/// Each adds its command to the program. Once the command line is parsed, the command that was given has set `action`.
void add_check(CLI::App& app, CommonFlags& flags, Action& action);
void add_contours(CLI::App& app, CommonFlags& flags, Action& action);
void add_export(CLI::App& app, CommonFlags& flags, Action& action);
void add_field(CLI::App& app, CommonFlags& flags, Action& action);
void add_medial_axis(CLI::App& app, CommonFlags& flags, Action& action);
void add_plan(CLI::App& app, CommonFlags& flags, Action& action);

}  // namespace isopath::app
