#pragma once
#include "ext/guiding/path_recorder.h"
#include "pbrt/transport/vertex.h"

namespace ext {

/// Directions and continuation probabilities of one camera path (policy of CameraPath). Directions are drawn from the
/// guide with the guiding probability, else from the BSDF. All weights use the mixture density; specular lobes keep
/// their samples. With guiding probability 0, samples are bit-identical to BSDF sampling. Passes the events of recorded
/// paths to a PathRecorder.
///
/// `beta`: path throughput; `L`: radiance accumulated so far.
class GuidedDirections {
  public:
    GuidedDirections(PathGuide &guide, Point2i pixel, int sample)
        : guide_(guide), roulette_(guide.Roulette()), hasLearnedRoulette_(roulette_ && roulette_->HasEstimates()),
          pixelImportance_(guide.PixelImportance(guide.InImage(pixel))) {
        if (const std::optional<size_t> path = guide.PathNumber(pixel, sample)) recorder_.emplace(guide, *path);
    }

    /// True if a learned continuation probability is available, so roulette happens on arrival (before next-event
    /// estimation) instead of after scattering.
    bool HasLearnedRoulette() const { return hasLearnedRoulette_; }
    /// Continuation probability at a vertex; 0: no estimate. `beta`: mean over wavelengths.
    Float ContinuationProbability(const PathVertex &vertex, Float beta);
    Float ContinuationProbabilityInMedium(const Point3 &p, Float beta);
    /// Continuation probability after next-event estimation, at the vertex of the previous call; 1: no estimate.
    Float ContinuationProbabilityAfterNee(Float beta);

    /// Called when a path ray reaches a scattering surface or medium point.
    void RecordHit(const PathVertex &vertex) {
        if (recorder_) recorder_->Hit(vertex);
    }
    void RecordHitInMedium(const Point3 &p) {
        if (recorder_) recorder_->HitInMedium(p);
    }
    /// Selects the guide's cell. Its directions are prepared by the first Sample or Pdf at the vertex.
    void PrepareDirections(const PathVertex &vertex, const SampledSpectrum &beta);
    /// Records throughput and radiance before next-event estimation at a vertex.
    void BeginVertex(const PathVertex &vertex, const SampledSpectrum &beta, const SampledSpectrum &L) {
        if (recorder_) recorder_->BeginVertex(vertex.point.p, PathRoulette::KindOf(vertex), beta, L);
    }
    void BeginVertexInMedium(const Point3 &p, const SampledSpectrum &beta, const SampledSpectrum &L) {
        if (recorder_) recorder_->BeginVertex(p, PathRoulette::kInMedium, beta, L);
    }
    /// Records throughput and radiance after next-event estimation at the current vertex.
    void BeginScattering(const SampledSpectrum &beta, const SampledSpectrum &L) {
        if (recorder_) recorder_->BeginScattering(beta, L);
    }
    std::optional<BsdfSample> Sample(const PathVertex &vertex, Float uc, const Point2 &u);
    /// Mixture density (solid angle), excluding specular lobes.
    Float Pdf(const PathVertex &vertex, const Vector3 &wi);
    /// Records a non-specular direction. `pdf`: its density (solid angle); `beta`: throughput after the vertex.
    void RecordScatter(const PathVertex &vertex, const BsdfSample &sample, Float pdf, const SampledSpectrum &L,
                       const SampledSpectrum &beta);
    /// Ends the path and its records. `L`: total radiance.
    void End(const SampledSpectrum &L) {
        if (recorder_) recorder_->End(L);
    }

  private:
    /// Prepares directions_ and completes guidingProbability_, at the first call at a vertex. Paths that end first save
    /// the work, and light sampling overlaps the cache misses of the cell.
    void PrepareOnce(const PathVertex &vertex);
    Float ContinuationProbabilityIn(const PathRoulette::Cell &cell, Float beta);

    PathGuide &guide_;
    PathRoulette *roulette_;  ///< may be null
    const bool hasLearnedRoulette_;
    const Float pixelImportance_;
    bool isGuided_ = false;  ///< BSDF at the vertex can be guided
    bool isGlossy_ = false, bothSides_ = false;
    Float guidingProbability_ = 0;                  ///< positive: directions_ is prepared, or unprepared_ is not null
    const PerSourceCluster *unprepared_ = nullptr;  ///< cluster radiances for directions_; null: prepared or unused
    Float beta_ = 0;                                ///< throughput at the vertex, mean over wavelengths
    Vector3 normal_{};
    GuideDirections directions_;
    PathRoulette::Cell cell_;               ///< of the last ContinuationProbability
    Float continuationAfterNee_ = 1;        ///< the last ContinuationProbabilityAfterNee
    std::optional<PathRecorder> recorder_;  ///< empty: the path is not recorded
};

}  // namespace ext
