#pragma once
#include <span>
#include <string>

#include "pbrt/core/files.h"
#include "pbrt/core/params.h"
#include "pbrt/lights/light.h"
#include "pbrt/spectra/color_space.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// A LightSource directive. `colorSpace` is the one in force (default spectra). `renderFromWorld` is only for
/// parameters given in world space (portals).
std::unique_ptr<Light> MakeLight(const std::string &type, const ParamSet &params, const Transform &renderFromLight,
                                 const Transform &renderFromWorld, const ColorSpace &colorSpace,
                                 const FileResolver &files, DiagnosticSink &sink);

/// An AreaLightSource directive parsed once, then one light for every Shape directive.
class AreaLightMaker {
  public:
    AreaLightMaker(const std::string &type, const ParamSet &params, const ColorSpace &colorSpace,
                   const FileResolver &files, DiagnosticSink &sink);
    ~AreaLightMaker();
    AreaLightMaker(AreaLightMaker &&) noexcept;
    /// `alpha` may be null; a constant alpha of 0 makes a light that only light sampling finds. The shapes must outlive
    /// it; its parts are their primitives.
    std::unique_ptr<Light> Make(std::span<const Shape *const> shapes, const FloatTexture *alpha) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

const std::vector<std::string> &SupportedLights();

}  // namespace pbrt
