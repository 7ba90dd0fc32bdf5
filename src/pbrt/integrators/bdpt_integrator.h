#pragma once
#include <utility>

#include "pbrt/integrators/bdpt_path.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/integrators/strategy_images.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/transport/shadow_transmittance.h"

namespace pbrt {

/// Bidirectional path tracing: connects every vertex of a light subpath with every vertex of a camera subpath, weighted
/// by the balance heuristic (Veach 1997, chapter 10). Subpaths scatter in media, and connections pass media and
/// interfaces. Medium emission is sampled by camera paths only, with full weight.
class BdptIntegrator final : public PixelIntegrator {
  public:
    /// The camera must support Camera::CanConnect. Subpaths scatter at most kMaxSubpath times.
    static constexpr int kMaxSubpath = 1000;
    /// `connecting` selects lights for connections to camera vertices; null: by power. `shooting` selects lights for
    /// light paths, with position-independent probabilities; null: by power. `strategies`, if not null, records every
    /// strategy's contribution, for all depths up to maxDepth.
    BdptIntegrator(const PathContext &context, int maxDepth, bool regularize,
                   std::unique_ptr<LightSampler> connecting = nullptr, std::unique_ptr<LightSampler> shooting = nullptr,
                   std::unique_ptr<StrategyImages> strategies = nullptr);
    bool Render(const RenderPass &pass) override {
        if (strategies_) strategies_->Begin(pass.film);
        const bool isWhole = PixelIntegrator::Render(pass);
        if (strategies_)
            for (Subpaths &s : subpaths_) strategies_->AddSplatPaths(std::exchange(s.pairs, 0));
        return isWhole;
    }
    void Prepare(PrepareContext &prepare) override {
        if (connecting_) connecting_->Prepare(prepare);
        shooting_->Prepare(prepare);
    }
    OnlineModel *Model() override { return observer_ ? connecting_->Model() : nullptr; }
    /// Stops training of `connecting`, which keeps its probabilities fixed.
    void StopLearning() { observer_ = nullptr; }
    const LightSampler *Lights() const override { return connecting_.get(); }
    const LightSampler *EmissionSampler() const override { return shooting_.get(); }
    bool MakesSideImages() const override { return strategies_ != nullptr; }
    std::vector<SideImage> SideImages() const override {
        return strategies_ ? strategies_->Images() : std::vector<SideImage>();
    }
    SampledSpectrum Li(const PathStart &start, SampledWavelengths &lambda, Sampler &sampler) const override;

    /// Samplers of the light subpath, the camera subpath and their connections.
    struct Samplers {
        Sampler &light, &camera, &connections;
    };
    /// Light from a connection to the camera, at a film position, in the unit of Film::AddSplat.
    struct CameraSplat {
        Point2 pFilm{};
        SampledSpectrum L{0};
    };
    /// Traces one pair of subpaths, with camera rays uniform over this many pixels; `splatUnit`: Film::SplatUnit.
    /// Returns the radiance along the camera ray and appends connections to the camera to `splats`. The former counts
    /// per camera ray of a pixel, the latter per light path of the whole film.
    SampledSpectrum TracePair(const PathStart &start, SampledWavelengths &lambda, const Samplers &samplers,
                              Float pixels, Float splatUnit, std::vector<CameraSplat> &splats) const;
    bool Splats() const override { return true; }

  private:
    /// Vertices of one pair of subpaths; one instance per thread.
    struct Subpaths {
        std::vector<BdptVertex> light, camera;
        std::vector<const BdptVertex *> path;  ///< scratch of WeightOf
        std::vector<CameraSplat> splats;       ///< scratch of Li
        // For strategy images: contributions, and the number of pairs since the last pass.
        std::vector<StrategyImages::Contribution> contributions;
        uint64_t pairs = 0;
        int lightCount = 0, cameraCount = 0;
    };
    struct Sample;
    void TraceLight(Sample &sample) const;
    SampledSpectrum TraceCamera(Sample &sample) const;
    /// A subpath during tracing, up to the last complete vertex.
    struct Subpath;
    void Follow(PathWalk &walk, Subpath &subpath, Sample &sample) const;
    /// Adds the emission hit by a camera subpath's ray.
    void AddEmission(const PathWalk &walk, Subpath &subpath, Sample &sample) const;
    /// Returns false if the subpath ends in the medium. `scattered`: it continues from there.
    bool PassMedium(PathWalk &walk, Subpath &subpath, const Sample &sample, bool *scattered) const;
    /// Adds the surface hit as a vertex and leaves it. Returns false if the subpath ends.
    bool ScatterAtSurface(PathWalk &walk, Subpath &subpath) const;
    /// Transmittance to `from` from a point on a light, the lens or another vertex.
    ShadowTransmittance Passing(const Sample &sample, const BdptVertex &from, const LightLiSample &to) const;
    /// Transmitted light of a connection between subpaths with these spectral densities, divided by their mean.
    SampledSpectrum Passed(const Sample &sample, const SampledSpectrum &L, const ShadowTransmittance &through,
                           const SampledSpectrum &densities) const;
    SampledSpectrum ConnectToLight(Sample &sample, int cameraVertices) const;
    SampledSpectrum ConnectSubpaths(Sample &sample, int lightVertices, int cameraVertices) const;
    void ConnectToCamera(Sample &sample, int lightVertices, std::vector<CameraSplat> &splats) const;
    /// MIS weight of the path of the first `lightVertices` and `cameraVertices` vertices of both subpaths. `end`
    /// replaces the first vertex: the emission hit by the camera path, or the sampled light.
    Float WeightOf(Sample &sample, int lightVertices, int cameraVertices, const BdptVertex *end, Float cameraPdf) const;

    PathContext context_;
    int maxDepth_;
    bool regularize_;
    std::unique_ptr<LightSampler> shooting_, connecting_;
    bool hasMedia_;
    PathObserver *observer_ = nullptr;
    BdptWeights weights_;
    std::unique_ptr<StrategyImages> strategies_;
    mutable std::vector<Subpaths> subpaths_;  ///< by ThreadIndex()
};

}  // namespace pbrt
