#pragma once
#include "pbrt/integrators/path_guide.h"
#include "pbrt/paths/vertex.h"

namespace pbrt {

/// The bounces of one path, and where it ends. Where the guide has a share, a direction is chosen by it or by
/// the BSDF, with the density of the mixture in all weights; specular lobes keep their samples. A vertex of share 0
/// takes the samples that the BSDF alone would take, bit by bit. What the bounces find is recorded for the guide.
class GuidedBounces {
  public:
    GuidedBounces(PathGuide &guide, Point2i pixel, int sample)
        : guide_(guide),
          roulette_(guide.Roulette()),
          worth_(guide.Worth(guide.InPicture(pixel))),
          path_(guide.PathNumber(pixel, sample)),
          places_(guide.BeginRecords(path_)) {}

    /// True if the path asks for its chance to survive where it arrives, not by its weight after a bounce.
    bool KnowsRoulette() const { return roulette_ && roulette_->Knows(); }
    /// The probability with which the path should go on from the vertex; 0: not known. `beta`: the path's weight, mean
    /// over wavelengths.
    Float Survival(const PathVertex &vertex, Float beta);
    Float SurvivalInMedium(const Point3 &p, Float beta);
    /// The probability with which it should leave the vertex that one of these was asked for last; 1: nothing is known.
    Float SurvivalOnwards(Float beta);
    /// The path goes on from the last vertex, where light was sampled if that can be done there. `beta`: its weight;
    /// `L`: what it found so far.
    void GoesOn(const SampledSpectrum &beta, const SampledSpectrum &L);
    /// Light is about to be sampled at the vertex, and the path to be followed from there. `beta`: its weight; `L`:
    /// what it found so far.
    void Open(const PathVertex &vertex, const SampledSpectrum &beta, const SampledSpectrum &L);
    void OpenInMedium(const Point3 &p, const SampledSpectrum &beta, const SampledSpectrum &L);

    /// The path's ray met a surface that scatters.
    void Reached(const PathVertex &vertex);
    /// The path is scattered in a medium.
    void ReachedInMedium(const Point3 &p);
    /// The path is at a vertex that scatters, and goes on. `beta`: its weight.
    void Begin(const PathVertex &vertex, const SampledSpectrum &beta);
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
    struct OpenBounce {
        GuideRecord record;
        SampledSpectrum L, beta;
    };
    static constexpr size_t kMaxOpen = 5;
    Float SurvivalIn(const PathRoulette::Cell &cell, Float beta);
    void OpenAt(const Point3 &p, uint32_t kind, const SampledSpectrum &beta, const SampledSpectrum &L);
    /// The last bounce's target becomes known: it is so far away.
    void FindTarget(Float distance);

    /// A vertex from which it is not known yet what the path finds.
    struct OpenVertex {
        /// Of the path up to there.
        struct Part {
            SampledSpectrum L;
            Float beta = 0;  ///< 0: it did not come so far
            Float cost = 0;
        };
        Point3 p{};
        uint32_t kind = 0;
        Part here, onwards;  ///< before and after light was sampled there
    };
    static constexpr size_t kMaxOpenVertices = 6;

    PathGuide &guide_;
    PathRoulette *roulette_;            ///< or null
    const Float worth_;                 ///< of the pixel
    const std::optional<size_t> path_;  ///< its number, if it is recorded
    LightLearner::PathPlaces places_;
    bool isGuided_ = false;  ///< the vertex's BSDF can be guided
    bool isGlossy_ = false, bothSides_ = false;
    Float share_ = 0;  ///< more than 0: directions_ is set
    Float beta_ = 0;   ///< the path's weight at the vertex, mean over wavelengths
    Vector3 normal_{};
    GuideDirections directions_;
    size_t open_ = 0;
    bool seeksTarget_ = false;  ///< for the last open bounce, from which the path has come the way `way_` to `at_`
    Float way_ = 0;
    Point3 at_{};
    std::array<OpenBounce, kMaxOpen> bounces_;
    PathRoulette::Cell cell_;  ///< where the probability to survive was asked last
    Float onwards_ = 1;        ///< what SurvivalOnwards said last
    bool isOpen_ = false;      ///< the last vertex is the last of vertices_
    Float cost_ = 0;           ///< see PathCost
    size_t openVertices_ = 0;
    std::array<OpenVertex, kMaxOpenVertices> vertices_;
};

}  // namespace pbrt
