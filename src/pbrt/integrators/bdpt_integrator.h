#pragma once
#include "pbrt/integrators/bdpt_path.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/lightsamplers/light_learner.h"

namespace pbrt {

/// Bidirectional path tracing: a path from a light and one from the camera, and every connection between a vertex of
/// one and a vertex of the other, weighted by the balance heuristic (Veach 1997, chapter 10). Surfaces only.
class BdptIntegrator final : public PixelIntegrator {
  public:
    /// The camera can connect (Camera::CanConnect). Subpaths have at most kMaxSubpath surfaces.
    static constexpr int kMaxSubpath = 1000;
    /// `connecting` chooses the light that a vertex of the camera path is connected to, `gate` whether the shadow ray
    /// is traced; null: by power, and always. `shooting` chooses the lights that light paths begin at, with
    /// probabilities that are the same everywhere; null: by power.
    BdptIntegrator(const PathContext &context, int maxDepth, bool regularize,
                   std::unique_ptr<LightSampler> connecting = nullptr, std::unique_ptr<ShadowRayGate> gate = nullptr,
                   std::unique_ptr<LightSampler> shooting = nullptr);
    void Prepare(PrepareContext &prepare) override;
    LightLearner *Learner() override { return learner_; }
    const LightSampler *Lights() const override { return connecting_.get(); }
    const LightSampler *ShootingLights() const override { return shooting_.get(); }
    const ShadowRayGate *Gate() const override { return gate_.get(); }
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

    /// Where the numbers for the light subpath, the camera subpath, and the connections of both come from.
    struct Samplers {
        Sampler &light, &camera, &connections;
    };
    /// Light that a connection to the camera brings to a place of the film, in pixels' measure (CameraConnection).
    struct SeenLight {
        Point2 pFilm{};
        SampledSpectrum L{0};
    };
    /// One pair of subpaths, where camera rays are spread evenly over so many pixels. Returns the radiance along the
    /// camera ray and adds to `seen` what is seen elsewhere. The first is to be counted for each camera ray of a pixel,
    /// the second for each light path of the whole film.
    SampledSpectrum TracePair(const PathStart &start, SampledWavelengths &lambda, const Samplers &samplers,
                              Float pixels, std::vector<SeenLight> &seen) const;

  protected:
    bool Splats() const override { return true; }

  private:
    /// The vertices of one pair of subpaths; every thread has its own.
    struct Subpaths {
        std::vector<BdptVertex> light, camera;
        std::vector<const BdptVertex *> path;  ///< memory for WeightOf
        std::vector<SeenLight> seen;           ///< memory for Li
        int lightCount = 0, cameraCount = 0;
    };
    struct Sample;
    void TraceLight(Sample &sample) const;
    SampledSpectrum TraceCamera(Sample &sample) const;
    /// Follows a walk whose next ray has this density by solid angle (or, beyond the scene, by area across it).
    /// `emitted` is called for every light that it meets.
    template <class Emitted>
    void Follow(PathWalk &walk, std::span<BdptVertex> vertices, int *count, Float pdf, TransportMode mode,
                Sampler &sampler, Sample &sample, Emitted &&emitted) const;
    SampledSpectrum ConnectToLight(Sample &sample, int cameraVertices) const;
    SampledSpectrum ConnectSubpaths(Sample &sample, int lightVertices, int cameraVertices) const;
    void ConnectToCamera(Sample &sample, int lightVertices, std::vector<SeenLight> &seen) const;
    /// The weight of the path of the first `lightVertices` and `cameraVertices` vertices of both subpaths; `hit`: in
    /// place of the first, what the camera path met, or the light that was sampled.
    Float WeightOf(Sample &sample, int lightVertices, int cameraVertices, const BdptVertex *end, Float cameraPdf) const;

    PathContext context_;
    int maxDepth_;
    bool regularize_;
    std::unique_ptr<LightSampler> shooting_, connecting_;
    std::unique_ptr<ShadowRayGate> gate_;
    LightLearner *learner_ = nullptr;
    BdptWeights weights_;
    mutable std::vector<Subpaths> subpaths_;  ///< by ThreadIndex()
};

}  // namespace pbrt
