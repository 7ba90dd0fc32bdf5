#pragma once
#include <functional>
#include <string>

#include "pbrt/materials/material.h"
#include "pbrt/textures/texture_factory.h"

namespace pbrt {

/// Builds one material. `named` resolves the operands of mix (throws or returns nullptr if unknown).
MaterialPtr MakeMaterial(const std::string &type, const ParamSet &params, TextureLibrary &textures,
                         const FileResolver &files, DiagnosticSink &sink,
                         const std::function<MaterialPtr(const std::string &)> &named);

const std::vector<std::string> &SupportedMaterials();

}  // namespace pbrt
