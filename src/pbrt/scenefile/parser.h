#pragma once
#include <string>
#include <vector>

#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// Parses files in sequence as one scene ("-" = standard input). A syntax error ends the parse of its file and all
/// following ones. Errors and warnings are collected in `sink`; the caller decides with sink.ThrowIfErrors().
SceneDescription ParseSceneFiles(const std::vector<std::string> &paths, DiagnosticSink &sink);

}  // namespace pbrt
