#include "pbrt/lights/light_table.h"

#include "pbrt/core/error.h"
#include "pbrt/lights/environment_light.h"

namespace pbrt {

namespace {
/// Minimum power of an emitting light, relative to the maximum.
constexpr double kMinShare = 1e-30;
/// Limits powers so that image sums stay finite.
constexpr double kMaxPower = 1e100;
}  // namespace

LightId LightTable::Add(std::unique_ptr<Light> light) {
    PBRT_CHECK(light && !byComponent_);
    const LightId first(lightOf_.size());
    if (light->Kind() == LightKind::Infinite) infinite_.push_back(first);
    lightOf_.insert(lightOf_.end(), light->ComponentCount(), uint32_t(lights_.size()));
    lights_.push_back({std::move(light), first.value});
    return first;
}

void LightTable::Finish(const Point3 &sceneCenter, Float sceneRadius) {
    PBRT_CHECK(!byComponent_);
    for (const Entry &entry : lights_) entry.light->Preprocess(sceneCenter, sceneRadius);
    std::vector<double> power(Size());
    double least = kMaxPower, most = 0;
    for (uint32_t i = 0; i < Size(); ++i) {
        const double phi = (*this)[LightId(i)].Phi(SampledWavelengths::WholeRange()).Average();
        if (!(phi > 0)) continue;
        power[i] = std::min(phi, kMaxPower);
        least = std::min(least, power[i]);
        most = std::max(most, power[i]);
    }
    if (most > 0) {
        const double radius = sceneRadius > 0 ? double(sceneRadius) : 1;
        unit_ = std::exp2(
            std::round(std::log2(std::max(least, kMinShare * most)) / 2 + std::log2(most) / 2 - std::log2(radius)));
    }
    power_.resize(Size());
    for (uint32_t i = 0; i < Size(); ++i)
        power_[i] = Float(power[i] > 0 ? std::max(power[i], kMinShare * most) / unit_ : 0);
    for (LightId id : infinite_)
        if (const EnvironmentLight *light = (*this)[id].Parent().AsEnvironment(); light && !light->Opening())
            environments_.push_back(id);
    byComponent_ = std::make_unique<LightGroups>(*this, false);
    byLight_ = std::make_unique<LightGroups>(*this, true);
}

LightCandidate LightTable::Candidate(LightId id) const {
    const LightComponent light = (*this)[id];
    LightCandidate c;
    c.power = power_[id.value];
    c.infinite = light.Kind() == LightKind::Infinite || light.Kind() == LightKind::DeltaDirection;
    c.bounds = light.Bounds();
    if (c.bounds) c.bounds->phi /= unit_;
    return c;
}

}  // namespace pbrt
