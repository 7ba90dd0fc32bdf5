#pragma once
#include <memory>
#include <vector>

#include "pbrt/core/factory_table.h"
#include "pbrt/core/files.h"
#include "pbrt/shapes/mesh_sources.h"

namespace pbrt {

/// Context of shape creation besides the directive's parameters. Textures and materials are read by build/.
struct ShapeContext {
    const Transform &renderFromObject;
    bool reverseOrientation = false;
    const FileResolver &files;
    DiagnosticSink &sink;                        ///< also for errors that stock pbrt-v4 reports without failing
    const ParamReader &before;                   ///< parameters already read by build/
    const Displacement *displacement = nullptr;  ///< null: none
    bool opaque = true;                          ///< false: an alpha texture lets some rays pass
    Transform renderFromPlaced{};                ///< of objects and moving shapes, for displacement; else identity
};

/// A plymesh with triangles and quads yields two shapes, unless displaced.
using ShapeList = std::vector<std::unique_ptr<Shape>>;
struct ShapeTraits {
    bool isDisplaceable = false;  ///< by a texture (ShapeContext::displacement)
};
using ShapeTable = FactoryTable<ShapeList, const ShapeContext, ShapeTraits>;
const ShapeTable &Shapes();

}  // namespace pbrt
