#include "pbrt/integrators/pixel_integrator.h"

#include "pbrt/core/parallel.h"
#include "pbrt/core/work_distributor.h"

namespace pbrt {
namespace {

/// Gathers the progress of all processes on rank 0. `whole`: number of chunks this process finished. `before`:
/// RenderPass::done at the start. Returns, everywhere, whether all chunks are complete; if not, cancels `progress`
/// everywhere.
bool ReducePass(const RenderPass &pass, int64_t chunks, int64_t whole, int64_t unreported,
                const std::vector<uint32_t> &before) {
    struct Sums {
        int64_t whole, unreported;
    } sums{whole, unreported};
    pass.team.Reduce([&](StateWriter &out) { out.Value(sums); },
                     [&](StateReader &in) {
                         const auto theirs = in.Value<Sums>();
                         sums.whole += theirs.whole;
                         sums.unreported += theirs.unreported;
                     });
    if (pass.isCounted && pass.team.IsRank0()) pass.progress.Advance(sums.unreported);
    if (pass.team.BroadcastValue(sums.whole == chunks)) return true;
    // A process cancelled after its last request could not report it.
    pass.progress.Cancel();
    if (!pass.done) return false;
    struct Done {
        uint32_t chunk, samples;
    };
    std::vector<Done> changed;
    for (size_t i = 0; i < before.size(); ++i)
        if ((*pass.done)[i] != before[i]) changed.push_back({uint32_t(i), (*pass.done)[i]});
    pass.team.Reduce([&](StateWriter &out) { out(changed); },
                     [&](StateReader &in) {
                         std::vector<Done> also;
                         in(also);
                         changed.insert(changed.end(), also.begin(), also.end());
                     });
    for (const Done &d : changed) (*pass.done)[d.chunk] = d.samples;
    return false;
}

constexpr int kTileSize = 16;
/// Minimum strips per thread if several processes render a pass, for load balance.
constexpr int64_t kStripsPerThread = 64;

class PassRenderer {
  public:
    PassRenderer(const PixelIntegrator &integrator, const RenderPass &pass, std::optional<CommonNumbers> common)
        : integrator_(integrator), pass_(pass), cells_(pass.film.PixelBounds()), common_(common),
          splats_(integrator.Splats()),
          alternates_(pass.adaptive && pass.adaptive->samplers.data() != pass.samplers.data()),
          needsVisible_(pass.film.NeedsVisibleSurface()),
          differentialScale_(pass.jittersPixels ? std::max(Float(0.125), 1 / std::sqrt(Float(pass.samplesPerPixel)))
                                                : Float(1)) {}

    /// Consecutive pixels of a tile in row order.
    struct Strip {
        Bounds2i tile;
        uint32_t firstPixel = 0, pixels = 0;

        Point2i PixelAt(uint32_t i) const {
            const auto width = uint32_t(tile.Width());
            return tile.low + Vector2i((firstPixel + i) % width, (firstPixel + i) / width);
        }
    };
    /// Traces the samples of a strip, pixel by pixel, starting at number `done`. Returns the number done:
    /// SamplesOf(strip), unless cancelled.
    uint32_t RenderStrip(const Strip &strip, uint32_t done) {
        const int thread = ThreadIndex();
        uint32_t before = 0;  // samples of the pixels before
        for (uint32_t i = 0; i < strip.pixels; ++i) {
            const Point2i pixel = strip.PixelAt(i);
            const SampleRange range = RangeOf(pixel);
            const uint64_t cost = Cost();
            // Cancellation is tested per sample, because a single one may take a tenth of a second.
            for (; done < before + range.count && !pass_.progress.Cancelled(); ++done)
                TraceSample(pixel, range.first + int(done - before), thread);
            before += range.count;
            if (pass_.adaptive && pass_.keepsSamples)
                std::atomic_ref(pass_.adaptive->cost[cells_.IndexOf(pixel)])
                    .fetch_add(Cost() - cost, std::memory_order_relaxed);
            if (done < before) break;
        }
        return done;
    }
    uint32_t SamplesOf(const Strip &strip) const {
        if (!pass_.adaptive) return strip.pixels * uint32_t(pass_.count);
        uint32_t samples = 0;
        for (uint32_t i = 0; i < strip.pixels; ++i) samples += RangeOf(strip.PixelAt(i)).count;
        return samples;
    }
    /// Number of light paths behind the splats of the half film.
    uint64_t HalfPaths() const { return halfPaths_; }

  private:
    struct SampleRange {
        int first;
        uint32_t count;
    };
    SampleRange RangeOf(Point2i pixel) const {
        if (!pass_.adaptive) return {pass_.first, uint32_t(pass_.count)};
        const size_t cell = cells_.IndexOf(pixel);
        const int first = pass_.adaptive->plan.CountAt(cell, pass_.first);
        return {first, uint32_t(pass_.adaptive->plan.CountAt(cell, pass_.first + pass_.count) - first)};
    }
    /// Of this thread so far.
    static uint64_t Cost() {
        const RenderCounters &c = ThreadCounters();
        return c.closestHitRays + c.shadowRays + c.mediumLookups;
    }
    void TraceSample(Point2i pixel, int index, int thread) {
        const AdaptivePass *const adaptive = pass_.adaptive;
        Film *const half = adaptive && adaptive->plan.IsInHalf(pixel, index) ? &adaptive->half : nullptr;
        Sampler &sampler = *(half ? adaptive->samplers : pass_.samplers)[thread];
        FilmSample sample;
        sample.pixel = pixel;
        sampler.StartPixelSample(pixel, alternates_ ? AdaptiveSampleIndex(index, sampler.SamplesPerPixel()) : index);
        const Float uOwn = sampler.Get1D(), uLambda = common_ ? common_->wavelengths : uOwn;
        sample.lambda = pass_.film.SampleWavelengths(pass_.jittersWavelengths ? uLambda : Float(0.5));
        CameraSample cs = SampleCamera(pass_.filter, pixel, sampler);
        if (common_) cs.time = common_->time;
        if (!pass_.jittersPixels) cs = {Point2(pixel) + Point2(0.5f, 0.5f), {0.5f, 0.5f}, 0.5f, 1};
        sample.weight = cs.filterWeight;
        if (std::optional<CameraRay> ray = pass_.camera.GenerateRay(cs, sample.lambda)) {
            const SampledSpectrum weight = ray->weight;
            ray->differential.Scale(ray->ray, differentialScale_);
            auto *const visible = needsVisible_ ? &sample.visible : nullptr;
            const CameraPathStart camera{*ray, pixel, pass_.batchFirst + index, visible};
            const PathStart start{camera, pass_, sample.weight, half};
            sample.L = weight * integrator_.Li(start, sample.lambda, sampler);
        } else {
            sample.hasRay = false;
        }
        if (!pass_.keepsSamples) return;
        pass_.film.AddSample(sample);
        if (half) half->AddSample(sample);
        if (half && splats_) halfPaths_.fetch_add(1, std::memory_order_relaxed);
    }

    const PixelIntegrator &integrator_;
    const RenderPass &pass_;
    const PixelCells cells_;
    const std::optional<CommonNumbers> common_;
    const bool splats_, alternates_, needsVisible_;
    const Float differentialScale_;
    std::atomic<uint64_t> halfPaths_ = 0;
};

/// Chunks of a pass: its tiles, or several strips per tile.
class PassStrips {
  public:
    explicit PassStrips(const RenderPass &pass) : bounds_(pass.film.PixelBounds()) {
        const Vector2i tiles = (bounds_.high - bounds_.low + (kTileSize - 1)) / kTileSize;
        tilesPerRow_ = tiles.x;
        const int64_t count = bounds_.IsEmpty() ? 0 : int64_t{tiles.x} * tiles.y;
        // A resumed pass keeps its strips; RenderChunks validates their number.
        if (pass.done && !pass.done->empty()) {
            perTile_ = int64_t(pass.done->size()) / std::max(count, int64_t{1});
        } else if (pass.team.Size() > 1 && count > 0) {
            const int64_t wanted = kStripsPerThread * pass.team.TotalThreads();
            perTile_ = std::clamp((wanted + count - 1) / count, int64_t{1}, int64_t{kTileSize} * kTileSize);
        }
        count_ = count * perTile_;
    }
    int64_t Count() const { return count_; }
    PassRenderer::Strip operator[](int64_t i) const {
        const int64_t tile = i / perTile_, strip = i % perTile_;
        const Point2i at(int(tile % tilesPerRow_), int(tile / tilesPerRow_));
        const Point2i low = bounds_.low + kTileSize * at;
        PassRenderer::Strip p{{low, glm::min(low + kTileSize, bounds_.high)}};
        const int64_t pixels = p.tile.Area();
        p.firstPixel = uint32_t(pixels * strip / perTile_);
        p.pixels = uint32_t(pixels * (strip + 1) / perTile_) - p.firstPixel;
        return p;
    }

  private:
    Bounds2i bounds_;
    int64_t tilesPerRow_ = 1, perTile_ = 1, count_ = 0;
};

}  // namespace

bool RenderChunks(const RenderPass &pass, const PassChunks &chunks) {
    if (pass.done && pass.done->empty()) pass.done->assign(size_t(chunks.count), 0);
    const auto doneBefore = [&](int64_t i) { return pass.done ? (*pass.done)[i] : 0; };
    for (int64_t i = 0; pass.done && i < chunks.count; ++i)
        if (pass.done->size() != size_t(chunks.count) || doneBefore(i) > chunks.samplesOf(i))
            throw UserError("{}: what is left of a pass does not fit the image.", pass.doneFile);
    if (chunks.splat) pass.film.ExpectSplats();
    std::atomic<int64_t> whole = 0;
    std::atomic<uint64_t> paths = 0;
    // Returns the samples added to a chunk that is now complete.
    const auto render = [&](int64_t i) {
        const uint32_t before = doneBefore(i);
        const uint32_t done = chunks.render(i, before);
        if (pass.done) (*pass.done)[i] = done;
        paths.fetch_add(done - before, std::memory_order_relaxed);
        if (done < chunks.samplesOf(i)) return int64_t{0};
        whole.fetch_add(1, std::memory_order_relaxed);
        return int64_t{done} - int64_t{before};
    };
    const std::vector<uint32_t> before = pass.done ? *pass.done : std::vector<uint32_t>();
    const int64_t unreported = DistributeWork(pass.team, chunks.count, pass.progress, [&](int64_t i) {
        const int64_t added = render(i);
        return pass.isCounted ? added : 0;
    });
    if (chunks.splat && pass.keepsSamples) pass.film.AddSplatPaths(paths);
    return ReducePass(pass, chunks.count, whole, unreported, before);
}

bool PixelIntegrator::Render(const RenderPass &pass) {
    PassRenderer renderer(*this, pass, Common());
    const PassStrips strips(pass);
    if (pass.adaptive && Splats()) pass.adaptive->half.ExpectSplats();
    const bool isComplete =
        RenderChunks(pass, {.count = strips.Count(),
                            .splat = Splats(),
                            .samplesOf = [&](int64_t i) { return renderer.SamplesOf(strips[i]); },
                            .render = [&](int64_t i, uint32_t done) { return renderer.RenderStrip(strips[i], done); }});
    if (pass.adaptive) pass.adaptive->half.AddSplatPaths(renderer.HalfPaths());
    return isComplete;
}

}  // namespace pbrt
