#pragma once
#include <functional>
#include <limits>
#include <span>
#include <string_view>

#include "pbrt/cameras/camera.h"
#include "pbrt/core/online_model.h"
#include "pbrt/core/team.h"
#include "pbrt/films/film.h"
#include "pbrt/films/filter.h"
#include "pbrt/films/sample_plan.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/samplers/sampler.h"

namespace pbrt {

class DirectionSampling;

/// Addition to a pass of an adaptive render.
struct AdaptivePass {
    const SamplePlan &plan;  ///< RenderPass::first and count are averages
    Film &half;              ///< also receives the samples of SamplePlan::IsInHalf
    /// Of these samples, independent of the others; or RenderPass::samplers, which then continue their sequence.
    std::span<const std::unique_ptr<Sampler>> samplers;
    std::span<uint64_t> cost;  ///< SamplePlan::cost; thread-safe by atomics
};

/// Part of a render: some samples of every film pixel.
struct RenderPass {
    const Camera &camera;
    const Filter &filter;
    Film &film;
    std::span<const std::unique_ptr<Sampler>> samplers;  ///< one per thread, by ThreadIndex()
    int samplesPerPixel = 1;                             ///< per sampler batch
    int samplesBefore = 0;                               ///< RenderSettings::samplesBefore
    int batchFirst = 0;                                  ///< samples per pixel of the render before this batch
    int first = 0, count = 1;                            ///< sample range within the batch
    bool jittersPixels = true;  ///< false: sample pixel centres, lens centre, mid-shutter; full texture footprints
    bool jittersWavelengths = true;
    bool keepsSamples = true;  ///< false: the film already holds these samples; they are traced for learning only
    bool isCounted = true;     ///< every pixel sample counts in `progress`
    /// Null, or progress per chunk of the integrator. On call, completed samples are skipped (empty: none are); on
    /// return everything is done, or what was done until cancellation.
    std::vector<uint32_t> *done = nullptr;
    std::string_view doneFile{};  ///< source file of `done`, for messages
    Progress &progress;
    const AdaptivePass *adaptive = nullptr;  ///< null: all pixels have the same number of samples
    /// Processes that render the pass together, each with its own film; samples are distributed among them. Afterwards
    /// rank 0's `done` covers all processes.
    Team &team = Team::Alone();
};

/// An image produced in addition to the film's.
struct SideImage {
    std::string name;  ///< suffix of the film's file name
    const Film *film = nullptr;
};

/// Adds samples to a film. Every sample is a function of pixel, sample index, and what the OnlineModel learned from
/// fixed earlier samples. So any number of threads and any split into passes give the same image.
class Integrator {
  public:
    virtual ~Integrator() = default;
    /// Called before the first pass; runs the light sampler's prepass.
    virtual void Prepare(PrepareContext &) {}
    /// Returns false if cancelled: some pixels then lack samples of the pass, recorded in RenderPass::done.
    virtual bool Render(const RenderPass &pass) = 0;
    /// Maximum RenderPass::count.
    virtual int MaxPassSamples() const { return std::numeric_limits<int>::max(); }
    /// Model updated between passes; may be null.
    virtual OnlineModel *Model() { return nullptr; }
    /// Writes the state of Prepare and the model, for PrepareContext::learned: of a resumed render, or without
    /// `withLearning` of other renders under the same lights (`learnsOn` false). Not while rays are traced; the writer
    /// may refer to memory of this object.
    virtual void SaveLearned(StateWriter &writer, bool withLearning) const {
        if (const LightSampler *lights = Lights()) lights->SaveLearned(writer, withLearning);
    }
    virtual const LightSampler *Lights() const { return nullptr; }
    /// Light sampler of light path emission; null if none.
    virtual const LightSampler *EmissionSampler() const { return nullptr; }
    /// True if there are side images. They hold only samples of this process since its start.
    virtual bool MakesSideImages() const { return false; }
    /// Valid after the first pass.
    virtual std::vector<SideImage> SideImages() const { return {}; }
    /// Learned direction sampling, or null.
    virtual const DirectionSampling *Directions() const { return nullptr; }
};

/// Chunks of a pass, rendered in any order by threads and processes.
struct PassChunks {
    int64_t count = 0;
    bool splat = false;  ///< samples add splats to the film, for one path each
    std::function<uint32_t(int64_t chunk)> samplesOf;
    /// Renders a chunk with `done` samples done; returns the new count: all, unless cancelled.
    std::function<uint32_t(int64_t chunk, uint32_t done)> render;
};

/// Renders the chunks not completed in RenderPass::done, and updates it. True if all processes have completed the pass.
bool RenderChunks(const RenderPass &pass, const PassChunks &chunks);

/// Adds a splat at a film position (raster space) to all pixels in the filter's support, with the expected value of
/// filter-sampled pixels.
inline void AddFilteredSplat(Film &film, const Filter &filter, const Point2 &pFilm, const SampledSpectrum &L,
                             const SampledWavelengths &lambda) {
    const Bounds2i &bounds = film.PixelBounds();
    const Point2 first = pFilm - filter.Radius() - Float(0.5), last = pFilm + filter.Radius() - Float(0.5);
    // Compared as floats first: distant positions do not fit into integers.
    if (!(last.x >= Float(bounds.low.x) && last.y >= Float(bounds.low.y) && first.x < Float(bounds.high.x) &&
          first.y < Float(bounds.high.y)))
        return;
    const Point2i low = glm::max(Point2i(glm::ceil(first)), bounds.low),
                  high = glm::min(Point2i(glm::floor(last)), bounds.high - 1);
    const Float perIntegral = 1 / filter.Integral();
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
            const Float weight = filter.Evaluate(pFilm - Point2(x, y) - Float(0.5)) * perIntegral;
            if (weight != 0) film.AddSplat({x, y}, L, lambda, weight);
        }
}

}  // namespace pbrt
