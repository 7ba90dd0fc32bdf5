#pragma once
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

struct AreaEmission;

/// A parsed AreaLightSource directive: makes one light per Shape directive.
class AreaLightMaker {
  public:
    explicit AreaLightMaker(std::shared_ptr<const AreaEmission> emission) : emission_(std::move(emission)) {}
    /// `alpha` may be null; a constant alpha of 0 makes a light that only light sampling reaches. The shapes, whose
    /// primitives are its components, must outlive the light.
    std::unique_ptr<Light> Make(std::span<const Shape *const> shapes, const FloatTexture *alpha) const;

  private:
    std::shared_ptr<const AreaEmission> emission_;
};

/// Factories of AreaLightSource directives. They ignore the context's transformations.
using AreaLightFactories = FactoryTable<AreaLightMaker, const LightContext>;
const AreaLightFactories &AreaLights();

}  // namespace pbrt
