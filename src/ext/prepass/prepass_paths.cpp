#include "ext/prepass/prepass_paths.h"

#include "pbrt/core/parallel.h"
#include "pbrt/films/filter.h"

namespace ext {

namespace {

Vector2i TilesOf(const Bounds2i &pixels) {
    return (pixels.high - pixels.low + (kPrepassTileSize - 1)) / kPrepassTileSize;
}

/// Paths of a pixel: the integer part of pathsPerPixel, plus one in a fraction of pixels equal to its fractional part.
int PathsOf(Point2i pixel, uint64_t stream, double pathsPerPixel) {
    const int whole = static_cast<int>(pathsPerPixel);
    const double fraction = pathsPerPixel - whole;
    return whole + (fraction > 0 && static_cast<double>(HashFloat(stream, pixel)) < fraction ? 1 : 0);
}

std::optional<PrepassPath> Start(const PrepareContext &context, uint64_t stream, Point2i pixel, int sampleIndex) {
    Rng rng(Hash(stream, context.seed, pixel, sampleIndex));
    CameraSample cs;
    cs.pFilm = Point2(pixel) + Point2(0.5f, 0.5f) + context.filter.Sample(rng.Uniform2()).offset;
    cs.time = rng.Uniform();
    cs.pLens = rng.Uniform2();
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(rng.Uniform());
    const std::optional<CameraRay> ray = context.camera.GenerateRay(cs, lambda);
    if (!ray) return {};
    return PrepassPath{rng, lambda, *ray};
}

}  // namespace

int64_t PrepassTileCount(const Bounds2i &pixels) {
    const Vector2i tiles = TilesOf(pixels);
    return pixels.IsEmpty() ? 0 : int64_t(tiles.x) * tiles.y;
}

void ForEachPrepassPath(PrepareContext &context, const char *phase, uint64_t stream, double pathsPerPixel,
                        const std::function<void(int64_t tile, PrepassPath &path)> &follow) {
    const Bounds2i &bounds = context.pixelBounds;
    const Vector2i tiles = TilesOf(bounds);
    const int64_t tileCount = PrepassTileCount(bounds);
    context.progress.BeginPhase(phase, tileCount);
    ParallelForEach(tileCount, [&](int64_t tile) {
        if (context.progress.Cancelled()) return;
        const Point2i low =
            bounds.low + kPrepassTileSize * Point2i(static_cast<int>(tile % tiles.x), static_cast<int>(tile / tiles.x));
        const Point2i high = glm::min(low + kPrepassTileSize, bounds.high);
        for (int y = low.y; y < high.y; ++y)
            for (int x = low.x; x < high.x; ++x)
                for (int s = 0, count = PathsOf({x, y}, stream, pathsPerPixel); s < count; ++s)
                    if (std::optional<PrepassPath> path = Start(context, stream, {x, y}, s)) follow(tile, *path);
        context.progress.Advance();
    });
    context.progress.EndPhase();
}

}  // namespace ext
