#pragma once
#include <string>
#include <vector>

#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// Parses files one after the other as one scene ("-" = standard input). A syntax error ends the parse of its file and
/// of all that follow. All errors and warnings are collected in `sink`; the caller decides with sink.ThrowIfErrors().
SceneDescription ParseSceneFiles(const std::vector<std::string> &paths, DiagnosticSink &sink);

/// Parses text as if it were a file called `name` in directory `directory`, for tests.
SceneDescription ParseSceneText(const std::string &text, DiagnosticSink &sink, const std::string &name = "<text>",
                                const std::string &directory = "");

}  // namespace pbrt
