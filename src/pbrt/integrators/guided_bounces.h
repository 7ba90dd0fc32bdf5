#pragma once
#include "pbrt/integrators/path_guide.h"
#include "pbrt/paths/vertex.h"

namespace pbrt {

/// The bounces of one path. Where the guide has a share, a direction is chosen by it or by the BSDF, with the density
/// of the mixture in all weights; specular lobes keep their samples. A vertex of share 0 takes the samples that the
/// BSDF alone would take, bit by bit. What the bounces find is recorded for the guide.
class GuidedBounces {
  public:
    GuidedBounces(PathGuide &guide, Point2i pixel, int sample)
        : guide_(guide), places_(guide.BeginRecords(pixel, sample)) {}

    /// The path is at a vertex that scatters.
    void Begin(const PathVertex &vertex);
    std::optional<BsdfSample> Sample(const PathVertex &vertex, Float uc, const Point2 &u) const;
    /// Density of all samples together, by solid angle, without specular lobes.
    Float Pdf(const PathVertex &vertex, const Vector3 &wi) const;
    /// The path left the vertex by a sample that was not specular. `pdf`: its density. `L`: what the path found so far;
    /// `beta`: its weight behind the vertex.
    void Left(const PathVertex &vertex, const BsdfSample &sample, Float pdf, const SampledSpectrum &L,
              const SampledSpectrum &beta);
    /// The path ended; `L` is all that it found.
    void End(const SampledSpectrum &L);

  private:
    /// A bounce whose end is not known yet.
    struct Open {
        GuideRecord record;
        SampledSpectrum L, beta;
    };
    static constexpr size_t kMaxOpen = 5;

    PathGuide &guide_;
    LightLearner::PathPlaces places_;
    bool isGuided_ = false;  ///< the vertex's BSDF can be guided
    bool isGlossy_ = false, bothSides_ = false;
    Float share_ = 0;  ///< more than 0: directions_ is set
    Vector3 normal_{};
    GuideDirections directions_;
    size_t open_ = 0;
    std::array<Open, kMaxOpen> bounces_;
};

}  // namespace pbrt
