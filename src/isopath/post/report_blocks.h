#pragma once

#include <string>

#include "isopath/post/report.h"

namespace isopath {

/// The report's data as script elements that the viewer reads: one JSON block "meta", and numbers in base64 blocks
/// named by their id (web/src/data.js reads them back).
std::string report_blocks(const ReportData& data);

}  // namespace isopath
