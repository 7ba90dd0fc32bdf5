#pragma once
#include "pbrt/lights/light.h"

namespace pbrt {

/// The one sample of a light that is a point. `intensity(w)`: what leaves along w (render space, not unit), any unit.
template <class Intensity>
std::optional<LightLiSample> SampleFromPoint(const Point3 &position, const LightSampleContext &from,
                                             Intensity intensity) {
    Vector3 d = position - from.p;
    Float d2 = LengthSquared(d);
    if (!(d2 > 0)) return {};
    LightLiSample s;
    s.L = intensity(-d) / d2;
    if (!s.L) return {};
    s.wi = d / std::sqrt(d2);
    s.pdf = 1;
    s.pLight = position;
    return s;
}

}  // namespace pbrt
