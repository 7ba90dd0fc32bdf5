#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/core/params.h"
#include "pbrt/shapes/displacement.h"

namespace pbrt {

/// Builds the shapes of one Shape directive. A plymesh with triangles and quads yields two, unless it is displaced. The
/// parameters `alpha` and `displacement` and anything about materials are read by build/. Throws UserError; what stock pbrt-v4 reports and survives goes to
/// `sink`. `opaque` false: an alpha texture will let some rays through.
std::vector<std::unique_ptr<Shape>> MakeShapes(const std::string &type, const ParamSet &params,
                                               const Transform &renderFromObject, bool reverseOrientation,
                                               const FileResolver &files, DiagnosticSink &sink,
                                               const Displacement *displacement = nullptr, bool opaque = true);

/// Types MakeShapes builds, and those of the format that it does not build yet.
const std::vector<std::string> &SupportedShapes();
const std::vector<std::string> &UnsupportedShapes();

}  // namespace pbrt
