#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/core/params.h"
#include "pbrt/shapes/shape.h"

namespace pbrt {

/// Builds the shapes of one Shape directive. A plymesh with triangles and quads yields two. The `alpha` parameter and
/// anything about materials is read by build/. Throws UserError; what stock pbrt-v4 reports and survives goes to
/// `sink`.
std::vector<std::unique_ptr<Shape>> MakeShapes(const std::string &type, const ParamSet &params,
                                               const Transform &renderFromObject, bool reverseOrientation,
                                               const FileResolver &files, DiagnosticSink &sink);

/// Types MakeShapes builds, and those of the format that it does not build yet.
const std::vector<std::string> &SupportedShapes();
const std::vector<std::string> &UnsupportedShapes();

}  // namespace pbrt
