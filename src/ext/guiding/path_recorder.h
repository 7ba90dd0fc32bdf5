#pragma once
#include "ext/guiding/path_guide.h"
#include "pbrt/transport/vertex.h"

namespace ext {

/// Records of one camera path for PathGuide: radiance and cost after each of its events, known at its end.
///
/// `beta`: path throughput; `L`: radiance accumulated so far.
class PathRecorder {
  public:
    /// `path`: number of the path (PathGuide::PathNumber).
    PathRecorder(PathGuide &guide, size_t path)
        : guide_(guide), roulette_(guide.Roulette()), path_(path), places_(guide.BeginRecords(path)) {}

    /// Called when a path ray reaches a scattering surface or medium point.
    void Hit(const PathVertex &vertex);
    void HitInMedium(const Point3 &p) {
        if (seeksSource_) SetSource(way_ + Distance(at_, p));
    }
    /// Called when the path leaves a vertex by non-specular scattering: radiance of the last bounce comes from here.
    void FinishSource() {
        if (seeksSource_) SetSource(way_);
    }
    bool HasPlaceForBounce() const {
        return places_.next + pendingBounces_ < places_.end && pendingBounces_ < kMaxPendingBounces;
    }
    /// Adds a bounce without its target, radiance and contribution. Requires HasPlaceForBounce(). `beta`: after it.
    void AddBounce(const GuideRecord &record, const SampledSpectrum &L, const SampledSpectrum &beta);
    /// Records throughput and radiance before next-event estimation at a vertex. `kind`: PathRoulette::KindOf.
    void BeginVertex(const Point3 &p, uint32_t kind, const SampledSpectrum &beta, const SampledSpectrum &L);
    /// Records throughput and radiance after next-event estimation at the current vertex.
    void BeginScattering(const SampledSpectrum &beta, const SampledSpectrum &L);
    /// Stores the records. `L`: total radiance.
    void End(const SampledSpectrum &L);

  private:
    /// A direction whose radiance is still accumulating.
    struct PendingBounce {
        GuideRecord record;
        SampledSpectrum L, beta;
    };
    static constexpr size_t kMaxPendingBounces = 5;
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

    /// Sets the source position of the last pending bounce, at this distance.
    void SetSource(Float distance);

    PathGuide &guide_;
    PathRoulette *roulette_;  ///< may be null
    const size_t path_;
    PathObserver::PathPlaces places_;
    size_t pendingBounces_ = 0;
    /// The last pending bounce has no source yet; the path has covered `way_` to `at_` since.
    bool seeksSource_ = false;
    Float way_ = 0;
    Point3 at_{};
    std::array<PendingBounce, kMaxPendingBounces> bounces_;
    bool isPending_ = false;  ///< the last vertex is the last of vertices_
    Float cost_ = 0;          ///< see PathCost
    size_t pendingVertices_ = 0;
    std::array<PendingVertex, kMaxPendingVertices> vertices_;
};

}  // namespace ext
