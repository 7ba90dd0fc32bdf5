#pragma once
#include "pbrt/integrators/bdpt_path.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/integrators/strategy_pictures.h"
#include "pbrt/lightsamplers/path_observer.h"
#include "pbrt/transport/shadow_transmittance.h"

namespace pbrt {

/// Bidirectional path tracing: a path from a light and one from the camera, and every connection between a vertex of
/// one and a vertex of the other, weighted by the balance heuristic (Veach 1997, chapter 10). Both scatter in media,
/// too, and connections pass media and the interfaces between them. Light that media emit is found by camera paths
/// only, and so it counts fully there.
class BdptIntegrator final : public PixelIntegrator {
  public:
    /// The camera can connect (Camera::CanConnect). Subpaths scatter at most kMaxSubpath times.
    static constexpr int kMaxSubpath = 1000;
    /// `connecting` chooses the light that a vertex of the camera path is connected to; null: by power. `shooting`
    /// chooses the lights that light paths begin at, with probabilities that are the same everywhere; null: by power.
    /// `strategies`, if not null, shows what every strategy finds; they know of all depths up to maxDepth.
    BdptIntegrator(const PathContext &context, int maxDepth, bool regularize,
                   std::unique_ptr<LightSampler> connecting = nullptr, std::unique_ptr<LightSampler> shooting = nullptr,
                   std::unique_ptr<StrategyPictures> strategies = nullptr);
    bool Render(const RenderPass &pass) override;
    void Prepare(PrepareContext &prepare) override;
    OnlineModel *Model() override { return observer_ ? connecting_->Model() : nullptr; }
    /// From now on samples do not teach the sampler that `connecting` is, so that it always chooses alike.
    void StopLearning() { observer_ = nullptr; }
    const LightSampler *Lights() const override { return connecting_.get(); }
    const LightSampler *EmissionSampler() const override { return shooting_.get(); }
    bool MakesSidePictures() const override { return strategies_ != nullptr; }
    std::vector<SidePicture> SidePictures() const override {
        return strategies_ ? strategies_->Pictures() : std::vector<SidePicture>();
    }
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

    /// Where the numbers for the light subpath, the camera subpath, and the connections of both come from.
    struct Samplers {
        Sampler &light, &camera, &connections;
    };
    /// Light that a connection to the camera brings to a place of the film, in the unit of Film::AddSplat.
    struct CameraSplat {
        Point2 pFilm{};
        SampledSpectrum L{0};
    };
    /// One pair of subpaths, where camera rays are spread evenly over so many pixels; `splatUnit`: Film::SplatUnit.
    /// Returns the radiance along the camera ray and adds connections to the camera to `splats`. The first is to be
    /// counted for each camera ray of a pixel, the second for each light path of the whole film.
    SampledSpectrum TracePair(const PathStart &start, SampledWavelengths &lambda, const Samplers &samplers,
                              Float pixels, Float splatUnit, std::vector<CameraSplat> &splats) const;
    bool Splats() const override { return true; }

  private:
    /// The vertices of one pair of subpaths; every thread has its own.
    struct Subpaths {
        std::vector<BdptVertex> light, camera;
        std::vector<const BdptVertex *> path;  ///< memory for WeightOf
        std::vector<CameraSplat> splats;       ///< memory for Li
        // For the pictures of strategies: their contributions, and the number of pairs since the last pass.
        std::vector<StrategyPictures::Contribution> contributions;
        uint64_t pairs = 0;
        int lightCount = 0, cameraCount = 0;
    };
    struct Sample;
    void TraceLight(Sample &sample) const;
    SampledSpectrum TraceCamera(Sample &sample) const;
    /// A subpath that is being traced, up to the vertex before the next one.
    struct Subpath;
    void Follow(PathWalk &walk, Subpath &subpath, Sample &sample) const;
    /// Adds to a subpath from the camera the light that its ray meets.
    void AddEmission(const PathWalk &walk, Subpath &subpath, Sample &sample) const;
    /// False: the subpath ends in the medium. `scattered`: it continues from there.
    bool PassMedium(PathWalk &walk, Subpath &subpath, const Sample &sample, bool *scattered) const;
    /// Makes the surface that was met the next vertex, and leaves it. False: the subpath ends.
    bool ScatterAtSurface(PathWalk &walk, Subpath &subpath) const;
    /// Returns the transmittance from a point on a light, the lens or another vertex to `from`.
    ShadowTransmittance Passing(const Sample &sample, const BdptVertex &from, const LightLiSample &to) const;
    /// A connection's light, of subpaths with these spectral densities, that passes; divided by the mean of densities.
    SampledSpectrum Passed(const Sample &sample, const SampledSpectrum &L, const ShadowTransmittance &through,
                           const SampledSpectrum &densities) const;
    SampledSpectrum ConnectToLight(Sample &sample, int cameraVertices) const;
    SampledSpectrum ConnectSubpaths(Sample &sample, int lightVertices, int cameraVertices) const;
    void ConnectToCamera(Sample &sample, int lightVertices, std::vector<CameraSplat> &splats) const;
    /// For the pictures of strategies.
    void Record(const Sample &sample, const StrategyPictures::Contribution &contribution) const;
    /// The weight of the path of the first `lightVertices` and `cameraVertices` vertices of both subpaths; `end`: in
    /// place of the first, what the camera path met, or the light that was sampled.
    Float WeightOf(Sample &sample, int lightVertices, int cameraVertices, const BdptVertex *end, Float cameraPdf) const;

    PathContext context_;
    int maxDepth_;
    bool regularize_;
    std::unique_ptr<LightSampler> shooting_, connecting_;
    bool hasMedia_;
    PathObserver *observer_ = nullptr;
    BdptWeights weights_;
    std::unique_ptr<StrategyPictures> strategies_;
    mutable std::vector<Subpaths> subpaths_;  ///< by ThreadIndex()
};

}  // namespace pbrt
