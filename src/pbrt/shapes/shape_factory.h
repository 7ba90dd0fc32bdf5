#pragma once
#include <memory>
#include <vector>

#include "pbrt/core/factory_table.h"
#include "pbrt/core/files.h"
#include "pbrt/shapes/displacement.h"

namespace pbrt {

/// What the shapes of a Shape directive are made from beside its parameters. Its textures and anything about materials
/// are read by build/.
struct ShapeContext {
    const Transform &renderFromObject;
    bool reverseOrientation = false;
    const FileResolver &files;
    DiagnosticSink &sink;                        ///< also for errors that stock pbrt-v4 reports and survives
    const ParamReader &before;                   ///< the parameters that build/ has read already
    const Displacement *displacement = nullptr;  ///< null: none
    bool opaque = true;                          ///< false: an alpha texture will let some rays through
    Transform renderFromPlaced{};  ///< where an object definition lies, for displacement; the identity elsewhere
};

/// A plymesh with triangles and quads yields two shapes, unless it is displaced.
using ShapeList = std::vector<std::unique_ptr<Shape>>;
using ShapeTable = FactoryTable<ShapeList, const ShapeContext>;
const ShapeTable &Shapes();

}  // namespace pbrt
