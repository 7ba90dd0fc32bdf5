#pragma once
#include <string>

namespace pbrt {

/// Runs charts.py and report.py on a finished campaign. Returns one sentence if something is missing or fails; the
/// results are not touched. Empty: all went well.
std::string RunReportScripts(const std::string &outFolder, bool quiet);

}  // namespace pbrt
