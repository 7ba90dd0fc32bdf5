#include "pbrt/lights/light_table.h"

#include "pbrt/core/error.h"
#include "pbrt/lights/light_spectrum.h"

namespace pbrt {

LightId LightTable::Add(std::unique_ptr<Light> light, ShapeId mesh, uint32_t primitive) {
    PBRT_CHECK(light && candidates_.empty());
    LightId id(lights_.size());
    if (light->Kind() == LightKind::Infinite) infinite_.push_back(id);
    lights_.push_back(std::move(light));
    meshes_.push_back(mesh);
    primitives_.push_back(primitive);
    return id;
}

void LightTable::Finish(const Point3 &sceneCenter, Float sceneRadius) {
    PBRT_CHECK(candidates_.empty());
    SampledWavelengths lambda = PowerWavelengths();
    candidates_.reserve(lights_.size());
    for (const std::unique_ptr<Light> &light : lights_) {
        light->Preprocess(sceneCenter, sceneRadius);
        LightCandidate c;
        Float power = SafeDivide(light->Phi(lambda), lambda.Pdf()).Average();
        c.power = power > 0 && std::isfinite(power) ? power : 0;
        if (!std::isfinite(power)) overflowed_.emplace_back(candidates_.size());
        c.infinite = light->Kind() == LightKind::Infinite || light->Kind() == LightKind::DeltaDirection;
        c.bounds = light->Bounds();
        candidates_.push_back(std::move(c));
    }
}

}  // namespace pbrt
