#pragma once
#include <functional>
#include <string>

#include "pbrt/core/factory_table.h"
#include "pbrt/materials/material.h"
#include "pbrt/textures/texture_factory.h"

namespace pbrt {

struct MaterialContext {
    TextureLibrary &textures;
    const FileResolver &files;
    DiagnosticSink &sink;
    std::function<MaterialPtr(const std::string &)> named;  ///< operands of mix; throws or returns nullptr if unknown
    bool usesFootprint = false;  ///< set during creation if one of the material's textures uses the filter footprint
};

using MaterialTable = FactoryTable<MaterialPtr, MaterialContext>;
const MaterialTable &Materials();

/// Creates a material of the table; the deprecated names "" and "none" mean "interface".
MaterialPtr MakeMaterial(const std::string &type, const ParamSet &params, MaterialContext &context);

/// Diffuse replacement with the estimated reflectance and transmittance of `material`, for --force-diffuse. Interfaces
/// and mixtures are kept; a mixture's operands are replaced themselves.
MaterialPtr ForceDiffuse(MaterialPtr material);

}  // namespace pbrt
