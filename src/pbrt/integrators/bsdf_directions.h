#pragma once
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// Directions of the BSDF alone, and roulette by throughput: policy of CameraPath, which documents the functions.
struct BsdfDirections {
    static constexpr bool HasLearnedRoulette() { return false; }
    static constexpr Float ContinuationProbability(const PathVertex &, Float) { return 0; }
    static constexpr Float ContinuationProbabilityInMedium(const Point3 &, Float) { return 0; }
    static constexpr Float ContinuationProbabilityAfterNee(Float) { return 1; }
    void BeginScattering(const SampledSpectrum &, const SampledSpectrum &) {}
    void BeginVertex(const PathVertex &, const SampledSpectrum &, const SampledSpectrum &) {}
    void BeginVertexInMedium(const Point3 &, const SampledSpectrum &, const SampledSpectrum &) {}
    void RecordHit(const PathVertex &) {}
    void RecordHitInMedium(const Point3 &) {}
    void PrepareDirections(const PathVertex &, const SampledSpectrum &) {}
    std::optional<BsdfSample> Sample(const PathVertex &vertex, Float uc, const Point2 &u) const {
        return vertex.bsdf.Sample(vertex.point.wo, uc, u);
    }
    Float Pdf(const PathVertex &vertex, const Vector3 &wi) const { return vertex.bsdf.Pdf(vertex.point.wo, wi); }
    void RecordScatter(const PathVertex &, const BsdfSample &, Float, const SampledSpectrum &,
                       const SampledSpectrum &) {}
    void End(const SampledSpectrum &) {}
};

}  // namespace pbrt
