#include "pbrt/lights/light_table.h"

#include "pbrt/core/error.h"
#include "pbrt/lights/light_spectrum.h"

namespace pbrt {

namespace {
/// Phi, averaged over the visible wavelengths.
Float PowerOf(const LightPart &light) {
    const SampledWavelengths lambda = PowerWavelengths();
    return SafeDivide(light.Phi(lambda), lambda.Pdf()).Average();
}
}  // namespace

LightId LightTable::Add(std::unique_ptr<Light> light) {
    PBRT_CHECK(light && !parts_);
    const LightId first(wholeOf_.size());
    if (light->Kind() == LightKind::Infinite) infinite_.push_back(first);
    wholeOf_.insert(wholeOf_.end(), light->PartCount(), static_cast<uint32_t>(wholes_.size()));
    wholes_.push_back({std::move(light), first.value});
    return first;
}

void LightTable::Finish(const Point3 &sceneCenter, Float sceneRadius) {
    PBRT_CHECK(!parts_);
    for (const Whole &whole : wholes_) whole.light->Preprocess(sceneCenter, sceneRadius);
    power_.resize(Size());
    for (uint32_t i = 0; i < Size(); ++i) {
        const Float power = PowerOf((*this)[LightId(i)]);
        if (!std::isfinite(power)) overflowed_.emplace_back(i);
        power_[i] = power > 0 && std::isfinite(power) ? power : 0;
    }
    for (LightId sky : infinite_)
        if ((*this)[sky].Whole().HasTiles() && skies_.size() < (LightId::kNone - Size()) / SkyPart::kCount)
            skies_.push_back(sky);
    parts_ = std::make_unique<LightGroups>(*this, false);
    groupsOfWholes_ = std::make_unique<LightGroups>(*this, true);
}

LightCandidate LightTable::Candidate(LightId id) const {
    const LightPart light = (*this)[id];
    LightCandidate c;
    c.power = power_[id.value];
    c.infinite = light.Kind() == LightKind::Infinite || light.Kind() == LightKind::DeltaDirection;
    c.bounds = light.Bounds();
    return c;
}

}  // namespace pbrt
