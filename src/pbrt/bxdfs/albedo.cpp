#include "pbrt/bxdfs/albedo.h"

#include "pbrt/math/low_discrepancy.h"

namespace pbrt {

SampledSpectrum EstimateAlbedo(const Bsdf &given, const Vector3 &wo) {
    // What so few samples find depends on how they are drawn, and should be what stock finds.
    Bsdf bsdf = given;
    bsdf.UseWalks();
    constexpr int kPoints = 16;
    // Where the lobe numbers lie in their strata decides whether a faint coat is sampled at all. As in stock pbrt-v4
    // the smallest is 0.0473, above the reflectance of glass; it is paired with u.x = 1/32, for which the facets of a
    // rough coat are met near normal incidence.
    constexpr Float kOffset = Float(0.757);
    SampledSpectrum sum(0);
    for (int i = 0; i < kPoints; ++i) {
        const auto index = static_cast<uint64_t>(kPoints - i);
        const Point2 u(RadicalInverse(2, index), RadicalInverse(3, index));
        const Float uLobe = (static_cast<Float>(i) + kOffset) / kPoints;
        if (auto s = bsdf.Sample(wo, uLobe, u); s && s->pdf > 0)
            sum += s->f * (AbsDot(s->wi, bsdf.ShadingFrame().z) / s->pdf);
    }
    return sum / kPoints;
}

}  // namespace pbrt
