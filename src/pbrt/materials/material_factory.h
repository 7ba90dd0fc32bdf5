#pragma once
#include <functional>
#include <string>

#include "pbrt/core/factory_table.h"
#include "pbrt/materials/material.h"
#include "pbrt/textures/texture_factory.h"

namespace pbrt {

/// What materials are made from beside their parameters.
struct MaterialContext {
    TextureLibrary &textures;
    const FileResolver &files;
    DiagnosticSink &sink;
    std::function<MaterialPtr(const std::string &)> named;  ///< operands of mix; throws or returns nullptr if unknown
    bool usesFootprint = false;  ///< set while a material is made: one of its textures uses the filter footprint
};

using MaterialTable = FactoryTable<MaterialPtr, MaterialContext>;
const MaterialTable &Materials();

/// Makes a material of the table; the deprecated names "" and "none" stand for "interface".
MaterialPtr MakeMaterial(const std::string &type, const ParamSet &params, MaterialContext &context);

}  // namespace pbrt
