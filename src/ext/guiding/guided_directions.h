#pragma once
#include "ext/guiding/path_guide.h"
#include "pbrt/transport/vertex.h"

namespace ext {

/// Directions and continuation probabilities of one camera path (policy of CameraPath). With the guiding probability a
/// direction is drawn from the guide, else from the BSDF; all weights use the density of the mixture, and specular
/// lobes keep their samples. Where the guiding probability is 0, samples are bit-identical to those of the BSDF alone.
/// The path's radiance is recorded for the guide.
///
/// `beta`: throughput of the path; `L`: its radiance so far.
class GuidedDirections {
  public:
    GuidedDirections(PathGuide &guide, Point2i pixel, int sample)
        : guide_(guide), roulette_(guide.Roulette()), pixelImportance_(guide.PixelImportance(guide.InPicture(pixel))),
          path_(guide.PathNumber(pixel, sample)), places_(guide.BeginRecords(path_)) {}

    /// True if a learned continuation probability is available, so roulette happens on arrival (before next-event
    /// estimation) instead of after scattering.
    bool HasLearnedRoulette() const { return roulette_ && roulette_->HasEstimates(); }
    /// Continuation probability at a vertex; 0: no estimate. `beta`: mean over wavelengths.
    Float ContinuationProbability(const PathVertex &vertex, Float beta);
    Float ContinuationProbabilityInMedium(const Point3 &p, Float beta);
    /// The same after next-event estimation at the vertex of the last call of one of these; 1: no estimate.
    Float ContinuationProbabilityAfterNee(Float beta);

    /// A ray of the path has met a surface that scatters, or a point in a medium.
    void RecordHit(const PathVertex &vertex);
    void RecordHitInMedium(const Point3 &p);
    /// Prepares Sample and Pdf at a vertex.
    void PrepareDirections(const PathVertex &vertex, const SampledSpectrum &beta);
    /// Records throughput and radiance before next-event estimation at a vertex.
    void BeginVertex(const PathVertex &vertex, const SampledSpectrum &beta, const SampledSpectrum &L);
    void BeginVertexInMedium(const Point3 &p, const SampledSpectrum &beta, const SampledSpectrum &L);
    /// Records throughput and radiance after next-event estimation at the current vertex.
    void BeginScattering(const SampledSpectrum &beta, const SampledSpectrum &L);
    std::optional<BsdfSample> Sample(const PathVertex &vertex, Float uc, const Point2 &u) const;
    /// Density of the mixture (solid angle), without specular lobes.
    Float Pdf(const PathVertex &vertex, const Vector3 &wi) const;
    /// Records a direction that was not specular. `pdf`: its density (solid angle); `beta`: behind the vertex.
    void RecordScatter(const PathVertex &vertex, const BsdfSample &sample, Float pdf, const SampledSpectrum &L,
                       const SampledSpectrum &beta);
    /// Ends the path and its records. `L`: all its radiance.
    void End(const SampledSpectrum &L);

  private:
    /// A direction whose radiance is still being summed.
    struct PendingBounce {
        GuideRecord record;
        SampledSpectrum L, beta;
    };
    static constexpr size_t kMaxPendingBounces = 5;
    Float ContinuationProbabilityIn(const PathRoulette::Cell &cell, Float beta);
    void BeginVertexAt(const Point3 &p, uint32_t kind, const SampledSpectrum &beta, const SampledSpectrum &L);
    /// Sets where the radiance of the last pending bounce comes from, at this distance.
    void SetSource(Float distance);

    /// A vertex whose estimates are still being summed.
    struct PendingVertex {
        /// The path up to there.
        struct Before {
            SampledSpectrum L;
            Float beta = 0;  ///< 0: the path ended before
            Float cost = 0;
        };
        Point3 p{};
        uint32_t kind = 0;
        Before here, onwards;  ///< before and after next-event estimation
    };
    static constexpr size_t kMaxPendingVertices = 6;

    PathGuide &guide_;
    PathRoulette *roulette_;            ///< or null
    const Float pixelImportance_;       ///< of the pixel
    const std::optional<size_t> path_;  ///< its number, if it is recorded
    PathObserver::PathPlaces places_;
    bool isGuided_ = false;  ///< the vertex's BSDF can be guided
    bool isGlossy_ = false, bothSides_ = false;
    Float guidingProbability_ = 0;  ///< more than 0: directions_ is set
    Float beta_ = 0;                ///< throughput at the vertex, mean over wavelengths
    Vector3 normal_{};
    GuideDirections directions_;
    size_t pendingBounces_ = 0;
    bool seeksSource_ = false;  ///< for the last open bounce, from which the path has come the way `way_` to `at_`
    Float way_ = 0;
    Point3 at_{};
    std::array<PendingBounce, kMaxPendingBounces> bounces_;
    PathRoulette::Cell cell_;         ///< of the last continuation probability
    Float continuationAfterNee_ = 1;  ///< the last ContinuationProbabilityAfterNee
    bool isPending_ = false;          ///< the last vertex is the last of vertices_
    Float cost_ = 0;                  ///< see PathCost
    size_t pendingVertices_ = 0;
    std::array<PendingVertex, kMaxPendingVertices> vertices_;
};

}  // namespace ext
