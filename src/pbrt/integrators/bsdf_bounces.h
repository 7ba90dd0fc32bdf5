#pragma once
#include "pbrt/paths/vertex.h"

namespace pbrt {

/// Bounces that the BSDF chooses, of paths that end by their weight. GuidedBounces has the same functions.
struct BsdfBounces {
    static constexpr bool KnowsRoulette() { return false; }
    static constexpr Float Survival(const PathVertex &, Float) { return 0; }
    static constexpr Float SurvivalInMedium(const Point3 &, Float) { return 0; }
    static constexpr Float SurvivalOnwards(Float) { return 1; }
    void GoesOn(const SampledSpectrum &, const SampledSpectrum &) {}
    void Open(const PathVertex &, const SampledSpectrum &, const SampledSpectrum &) {}
    void OpenInMedium(const Point3 &, const SampledSpectrum &, const SampledSpectrum &) {}
    void Reached(const PathVertex &) {}
    void ReachedInMedium(const Point3 &) {}
    void Begin(const PathVertex &, const SampledSpectrum &) {}
    std::optional<BsdfSample> Sample(const PathVertex &vertex, Float uc, const Point2 &u) const {
        return vertex.bsdf.Sample(vertex.point.wo, uc, u);
    }
    Float Pdf(const PathVertex &vertex, const Vector3 &wi) const { return vertex.bsdf.Pdf(vertex.point.wo, wi); }
    void Left(const PathVertex &, const BsdfSample &, Float, const SampledSpectrum &, const SampledSpectrum &) {}
    void End(const SampledSpectrum &) {}
};

}  // namespace pbrt
