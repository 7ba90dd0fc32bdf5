#pragma once
#include "pbrt/lightsamplers/light_sampler.h"

namespace pbrt {

/// Decides whether a shadow ray is worth tracing. The integrator traces it with probability TraceProbability and
/// divides by it, so no gate changes the expected value. Const after Prepare. Works with every light sampler.
class ShadowRayGate {
  public:
    virtual ~ShadowRayGate() = default;
    virtual void Prepare(PrepareContext &) {}
    /// In (0, 1]. `onLight`: end of the shadow segment.
    virtual Float TraceProbability(const LightQuery &query, LightId light, const Point3 &onLight) const = 0;
    virtual void Report(nlohmann::ordered_json &) const {}
};

}  // namespace pbrt
