#pragma once
#include <functional>
#include <memory>
#include <span>

#include "pbrt/core/factory_table.h"
#include "pbrt/core/files.h"
#include "pbrt/lights/light.h"
#include "pbrt/spectra/color_space.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

struct LightContext {
    const Transform &renderFromLight;
    const Transform &renderFromWorld;  ///< only for parameters in world space (portals)
    const ColorSpace &colorSpace;      ///< current colour space; its illuminant is the default emission
    const FileResolver &files;
    DiagnosticSink &sink;
};

using LightFactories = FactoryTable<std::unique_ptr<Light>, const LightContext>;
const LightFactories &Lights();

/// A parsed AreaLightSource directive: makes one light per Shape directive. `alpha` may be null; a constant alpha of 0
/// makes a light that only light sampling reaches. The shapes, whose primitives are its components, must outlive the
/// light.
using AreaLightMaker =
    std::function<std::unique_ptr<Light>(std::span<const Shape *const> shapes, const FloatTexture *alpha)>;

/// Factories of AreaLightSource directives. They ignore the context's transformations.
using AreaLightFactories = FactoryTable<AreaLightMaker, const LightContext>;
const AreaLightFactories &AreaLights();

}  // namespace pbrt
