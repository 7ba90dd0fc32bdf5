#pragma once
#include <memory>

#include "pbrt/core/factory_table.h"
#include "pbrt/core/files.h"
#include "pbrt/lights/light.h"
#include "pbrt/spectra/color_space.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// What a light is made for.
struct LightContext {
    const Transform &renderFromLight;
    const Transform &renderFromWorld;  ///< only for what is given in world space (portals)
    const ColorSpace &colorSpace;      ///< the one in force: of spectra that are not given
    const FileResolver &files;
    DiagnosticSink &sink;
};

/// LightSource directives.
using LightFactories = FactoryTable<std::unique_ptr<Light>, const LightContext>;
const LightFactories &Lights();

struct AreaEmission;

/// An AreaLightSource directive, read once: makes one light for each primitive of the shapes that it applies to.
class AreaLightMaker {
  public:
    explicit AreaLightMaker(std::shared_ptr<const AreaEmission> emission) : emission_(std::move(emission)) {}
    /// `alpha` may be null; a constant alpha of 0 makes a light that only light sampling finds. `shape` must outlive
    /// it.
    std::unique_ptr<Light> Make(const Shape &shape, uint32_t primitive, const FloatTexture *alpha) const;

  private:
    std::shared_ptr<const AreaEmission> emission_;
};

/// AreaLightSource directives. The transformations of the context do not count.
using AreaLightFactories = FactoryTable<AreaLightMaker, const LightContext>;
const AreaLightFactories &AreaLights();

}  // namespace pbrt
