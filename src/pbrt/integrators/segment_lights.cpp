#include "pbrt/integrators/segment_lights.h"

#include "pbrt/lights/light_table.h"

namespace pbrt {

SegmentDistances::SegmentDistances(const LightTable &lights) : places_(lights.Size()) {
    for (size_t i = 0; i < places_.size(); ++i)
        if (const std::optional<LightBounds> bounds = lights[LightId(i)].Bounds())
            places_[i] = {bounds->Centroid(), Length(bounds->bounds.Diagonal()) / 2};
}

const SegmentDistances::Place *SegmentDistances::PlaceOf(LightId light) const {
    if (light.value >= places_.size() || places_[light.value].radius < 0) return nullptr;
    return &places_[light.value];
}

SegmentDistances::Sample SegmentDistances::Draw(const MediumStretch &stretch, LightId light, Float u) const {
    const TransmittanceDistance byTransmittance(stretch.meanExtinction, stretch.tMax);
    if (!byTransmittance.IsValid()) return {};
    Float t = byTransmittance.Sample(u);
    if (const Place *place = PlaceOf(light)) {
        const EquiangularDistance byAngle(stretch.ray, stretch.tMax, place->center, place->radius);
        if (byAngle.IsValid()) t = u < 0.5f ? byAngle.Sample(2 * u) : byTransmittance.Sample(2 * u - 1);
    }
    return {t, Pdf(stretch, light, t)};
}

Float SegmentDistances::Pdf(const MediumStretch &stretch, LightId light, Float t) const {
    const TransmittanceDistance byTransmittance(stretch.meanExtinction, stretch.tMax);
    if (!byTransmittance.IsValid()) return 0;
    if (const Place *place = PlaceOf(light)) {
        const EquiangularDistance byAngle(stretch.ray, stretch.tMax, place->center, place->radius);
        if (byAngle.IsValid()) return (byAngle.Pdf(t) + byTransmittance.Pdf(t)) / 2;
    }
    return byTransmittance.Pdf(t);
}

}  // namespace pbrt
