#pragma once
#include <memory>
#include <span>

#include "pbrt/core/factory_table.h"
#include "pbrt/core/files.h"
#include "pbrt/lights/light.h"
#include "pbrt/spectra/color_space.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// What a light is made from beside its parameters.
struct LightContext {
    const Transform &renderFromLight;
    const Transform &renderFromWorld;  ///< only for parameters in world space (portals)
    const ColorSpace &colorSpace;      ///< the current one; its illuminant is the default emission
    const FileResolver &files;
    DiagnosticSink &sink;
};

/// The factories of LightSource directives.
using LightFactories = FactoryTable<std::unique_ptr<Light>, const LightContext>;
const LightFactories &Lights();

struct AreaEmission;

/// An AreaLightSource directive, read once: makes one light for every Shape directive.
class AreaLightMaker {
  public:
    explicit AreaLightMaker(std::shared_ptr<const AreaEmission> emission) : emission_(std::move(emission)) {}
    /// `alpha` may be null; a constant alpha of 0 makes a light that only light sampling finds. The shapes must outlive
    /// it; its parts are their primitives.
    std::unique_ptr<Light> Make(std::span<const Shape *const> shapes, const FloatTexture *alpha) const;

  private:
    std::shared_ptr<const AreaEmission> emission_;
};

/// The factories of AreaLightSource directives. They ignore the transformations of the context.
using AreaLightFactories = FactoryTable<AreaLightMaker, const LightContext>;
const AreaLightFactories &AreaLights();

}  // namespace pbrt
