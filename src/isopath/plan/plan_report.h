#pragma once

#include <string>

#include "isopath/plan/plan_result.h"

namespace isopath {

/// The run as one HTML page. It holds no times and no memory, so that the same job gives the same bytes.
std::string plan_report(const PlanResult& result);

}  // namespace isopath
