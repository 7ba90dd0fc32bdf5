#include "pbrt/integrators/pixel_integrator.h"

#include "pbrt/core/parallel.h"

namespace pbrt {

namespace {

constexpr int kTileSize = 16;

/// Traces the samples of a pass.
class PassRenderer {
  public:
    PassRenderer(const PixelIntegrator &integrator, const RenderPass &pass)
        : integrator_(integrator),
          pass_(pass),
          wantsVisible_(pass.film.WantsVisibleSurface()),
          differentialScale_(pass.jittersPixels
                                 ? std::max(Float(0.125), 1 / std::sqrt(static_cast<Float>(pass.samplesPerPixel)))
                                 : Float(1)) {}

    /// Traces the samples of a tile, pixel by pixel, from the one with this number on. Returns how many are done then:
    /// SamplesOf(tile), unless cancelled.
    uint32_t RenderTile(const Bounds2i &tile, uint32_t done, Sampler &sampler) const {
        const uint32_t all = SamplesOf(tile), count = static_cast<uint32_t>(pass_.count);
        const auto width = static_cast<uint32_t>(tile.Width());
        for (; done < all; ++done) {
            // Checked before every sample, because a single one may take a tenth of a second.
            if (pass_.progress.Cancelled()) break;
            const uint32_t pixel = done / count;
            TraceSample(tile.low + Vector2i(pixel % width, pixel / width), pass_.first + static_cast<int>(done % count),
                        sampler);
        }
        return done;
    }
    uint32_t SamplesOf(const Bounds2i &tile) const { return static_cast<uint32_t>(tile.Area() * pass_.count); }

  private:
    void TraceSample(Point2i pixel, int index, Sampler &sampler) const {
        FilmSample sample;
        sample.pixel = pixel;
        sampler.StartPixelSample(pixel, index);
        const Float uLambda = sampler.Get1D();
        sample.lambda = pass_.film.SampleWavelengths(pass_.jittersWavelengths ? uLambda : Float(0.5));
        const FilterSample offset = pass_.filter.Sample(sampler.GetPixel2D());
        CameraSample cs;
        cs.pFilm = Point2(pixel) + Point2(0.5f, 0.5f) + offset.offset;
        cs.time = sampler.Get1D();
        cs.pLens = sampler.Get2D();
        cs.filterWeight = offset.weight;
        if (!pass_.jittersPixels) cs = {Point2(pixel) + Point2(0.5f, 0.5f), {0.5f, 0.5f}, 0.5f, 1};
        sample.weight = cs.filterWeight;
        if (std::optional<CameraRay> ray = pass_.camera.GenerateRay(cs, sample.lambda)) {
            const SampledSpectrum weight = ray->weight;
            ray->differential.Scale(ray->ray, differentialScale_);
            const PathStart start{*ray, pixel, pass_.batchFirst + index, wantsVisible_ ? &sample.visible : nullptr,
                                  &pass_};
            sample.L = weight * integrator_.Li(start, sample.lambda, sampler);
        }
        if (pass_.keepsSamples) pass_.film.AddSample(sample);
    }

    const PixelIntegrator &integrator_;
    const RenderPass &pass_;
    const bool wantsVisible_;
    const Float differentialScale_;
};

}  // namespace

bool PixelIntegrator::Render(const RenderPass &pass) {
    const PassRenderer renderer(*this, pass);
    const Bounds2i &bounds = pass.film.PixelBounds();
    const Vector2i tiles = (bounds.high - bounds.low + (kTileSize - 1)) / kTileSize;
    const int64_t count = bounds.IsEmpty() ? 0 : int64_t{tiles.x} * tiles.y;
    if (pass.done && pass.done->empty()) pass.done->assign(static_cast<size_t>(count), 0);
    if (Splats()) pass.film.ExpectSplats();
    std::atomic<uint64_t> paths = 0;
    std::atomic<bool> isWhole = true;
    ParallelForEach(count, [&](int64_t i) {
        const Point2i at(static_cast<int>(i % tiles.x), static_cast<int>(i / tiles.x));
        const Point2i low = bounds.low + kTileSize * at;
        const Bounds2i tile{low, glm::min(low + kTileSize, bounds.high)};
        const uint32_t before = pass.done ? (*pass.done)[static_cast<size_t>(i)] : 0;
        // Which thread takes which tile does not matter.
        const uint32_t done = renderer.RenderTile(tile, before, *pass.samplers[static_cast<size_t>(ThreadIndex())]);
        if (pass.done) (*pass.done)[static_cast<size_t>(i)] = done;
        paths.fetch_add(done - before, std::memory_order_relaxed);
        if (done < renderer.SamplesOf(tile))
            isWhole.store(false, std::memory_order_relaxed);
        else if (pass.isCounted)
            pass.progress.Advance(int64_t{done} - int64_t{before});
    });
    if (Splats() && pass.keepsSamples) pass.film.AddSplatPaths(paths);
    return isWhole;
}

}  // namespace pbrt
