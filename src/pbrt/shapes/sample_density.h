#pragma once
#include "pbrt/shapes/shape.h"

namespace pbrt {

/// Density by solid angle at `from` of a point that was drawn with `pdfArea` by area; wi unit towards it. 0 if the
/// surface is seen edge-on.
inline Float SolidAngleDensity(Float pdfArea, const Point3 &from, const Vector3 &wi, const Point3 &p,
                               const Normal3 &n) {
    Float pdf = pdfArea * DistanceSquared(from, p) / AbsDot(n, wi);
    return std::isfinite(pdf) ? pdf : 0;
}

/// A sample drawn by area, with its density turned to solid angle at `from`; empty if that is 0 or infinite.
inline std::optional<ShapeSample> WithSolidAngleDensity(std::optional<ShapeSample> s, const Point3 &from) {
    if (!s) return {};
    Vector3 wi = s->p - from;
    Float distance = Length(wi);
    if (!(distance > 0)) return {};
    s->pdf = SolidAngleDensity(s->pdf, from, wi / distance, s->p, s->n);
    if (!(s->pdf > 0)) return {};
    return s;
}

}  // namespace pbrt
