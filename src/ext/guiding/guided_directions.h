#pragma once
#include "ext/guiding/path_guide.h"
#include "pbrt/transport/vertex.h"

namespace ext {

/// Directions and continuation probabilities of one camera path (policy of CameraPath). Directions are drawn from the
/// guide with the guiding probability, else from the BSDF. All weights use the mixture density; specular lobes keep
/// their samples. With guiding probability 0, samples are bit-identical to BSDF sampling. Records the path's radiance
/// for the guide.
///
/// `beta`: path throughput; `L`: radiance accumulated so far.
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
    /// Continuation probability after next-event estimation, at the vertex of the previous call; 1: no estimate.
    Float ContinuationProbabilityAfterNee(Float beta);

    /// Called when a path ray reaches a scattering surface or medium point.
    void RecordHit(const PathVertex &vertex);
    void RecordHitInMedium(const Point3 &p);
    /// Selects the guide's cell. Its directions are prepared by the first Sample or Pdf at the vertex.
    void PrepareDirections(const PathVertex &vertex, const SampledSpectrum &beta);
    /// Records throughput and radiance before next-event estimation at a vertex.
    void BeginVertex(const PathVertex &vertex, const SampledSpectrum &beta, const SampledSpectrum &L);
    void BeginVertexInMedium(const Point3 &p, const SampledSpectrum &beta, const SampledSpectrum &L);
    /// Records throughput and radiance after next-event estimation at the current vertex.
    void BeginScattering(const SampledSpectrum &beta, const SampledSpectrum &L);
    std::optional<BsdfSample> Sample(const PathVertex &vertex, Float uc, const Point2 &u);
    /// Mixture density (solid angle), excluding specular lobes.
    Float Pdf(const PathVertex &vertex, const Vector3 &wi);
    /// Records a non-specular direction. `pdf`: its density (solid angle); `beta`: throughput after the vertex.
    void RecordScatter(const PathVertex &vertex, const BsdfSample &sample, Float pdf, const SampledSpectrum &L,
                       const SampledSpectrum &beta);
    /// Ends the path and its records. `L`: total radiance.
    void End(const SampledSpectrum &L);

  private:
    /// A direction whose radiance is still accumulating.
    struct PendingBounce {
        GuideRecord record;
        SampledSpectrum L, beta;
    };
    static constexpr size_t kMaxPendingBounces = 5;
    /// Prepares directions_ and completes guidingProbability_, at the first call at a vertex. Paths that end first save
    /// the work, and light sampling overlaps the cache misses of the cell.
    void PrepareOnce(const PathVertex &vertex);
    Float ContinuationProbabilityIn(const PathRoulette::Cell &cell, Float beta);
    void BeginVertexAt(const Point3 &p, uint32_t kind, const SampledSpectrum &beta, const SampledSpectrum &L);
    /// Sets the source position of the last pending bounce, at this distance.
    void SetSource(Float distance);

    /// A vertex whose estimates are still accumulating.
    struct PendingVertex {
        /// Path state at that point.
        struct Before {
            SampledSpectrum L;
            Float beta = 0;  ///< 0: the path ended earlier
            Float cost = 0;
        };
        Point3 p{};
        uint32_t kind = 0;
        Before here, onwards;  ///< before and after next-event estimation
    };
    static constexpr size_t kMaxPendingVertices = 6;

    PathGuide &guide_;
    PathRoulette *roulette_;  ///< may be null
    const Float pixelImportance_;
    const std::optional<size_t> path_;  ///< recorded path number; empty: not recorded
    PathObserver::PathPlaces places_;
    bool isGuided_ = false;  ///< BSDF at the vertex can be guided
    bool isGlossy_ = false, bothSides_ = false;
    Float guidingProbability_ = 0;                  ///< positive: directions_ is prepared, or unprepared_ is not null
    const PerSourceCluster *unprepared_ = nullptr;  ///< cluster radiances for directions_; null: prepared or unused
    Float beta_ = 0;                                ///< throughput at the vertex, mean over wavelengths
    Vector3 normal_{};
    GuideDirections directions_;
    size_t pendingBounces_ = 0;
    bool seeksSource_ =
        false;  ///< the last pending bounce has no source yet; the path has covered `way_` to `at_` since
    Float way_ = 0;
    Point3 at_{};
    std::array<PendingBounce, kMaxPendingBounces> bounces_;
    PathRoulette::Cell cell_;         ///< of the last ContinuationProbability
    Float continuationAfterNee_ = 1;  ///< the last ContinuationProbabilityAfterNee
    bool isPending_ = false;          ///< the last vertex is vertices_.back()
    Float cost_ = 0;                  ///< see PathCost
    size_t pendingVertices_ = 0;
    std::array<PendingVertex, kMaxPendingVertices> vertices_;
};

}  // namespace ext
