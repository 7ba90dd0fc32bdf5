#include "ext/prepass/prepass.h"

#include "pbrt/core/parallel.h"
#include "pbrt/films/filter.h"
#include "pbrt/transport/path_walk.h"
#include "pbrt/transport/shadow_transmittance.h"

namespace ext {
namespace {

constexpr uint64_t kStream = 0x70726570617373ull;  ///< decorrelates the prepass from other uses of the seed

Vector2i TilesOf(const Bounds2i &pixels) {
    return (pixels.high - pixels.low + (kPrepassTileSize - 1)) / kPrepassTileSize;
}

/// Paths of a pixel: the integer part of pathsPerPixel, plus one in a fraction of pixels equal to its fractional part.
int PathsOf(Point2i pixel, uint64_t stream, double pathsPerPixel) {
    const int whole = int(pathsPerPixel);
    const double fraction = pathsPerPixel - whole;
    return whole + (fraction > 0 && double(HashFloat(stream, pixel)) < fraction ? 1 : 0);
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
        const Point2i low = bounds.low + kPrepassTileSize * Point2i(int(tile % tiles.x), int(tile / tiles.x));
        const Point2i high = glm::min(low + kPrepassTileSize, bounds.high);
        for (int y = low.y; y < high.y; ++y)
            for (int x = low.x; x < high.x; ++x)
                for (int s = 0, count = PathsOf({x, y}, stream, pathsPerPixel); s < count; ++s)
                    if (std::optional<PrepassPath> path = Start(context, stream, {x, y}, s)) follow(tile, *path);
        context.progress.Advance();
    });
    context.progress.EndPhase();
}

LightQuery QueryAt(const PrepassVertex &vertex) {
    const auto &[p, pError, n, ns, time] = vertex.at;
    LightQuery query{.p = p, .wo = vertex.wo, .n = n, .ns = ns, .transmits = vertex.transmits, .time = time};
    query.pError = pError;
    query.phase = vertex.phase;
    if (vertex.phase) query.medium = vertex.inside;
    return query;
}

std::vector<PrepassVertex> TracePrepassPaths(PrepareContext &context, double samplesPerPixel, int depth) {
    std::vector<std::vector<PrepassVertex>> perTile(PrepassTileCount(context.pixelBounds));
    ForEachPrepassPath(context, "prepass", kStream, samplesPerPixel, [&](int64_t tile, PrepassPath &path) {
        std::vector<PrepassVertex> &out = perTile[tile];
        if (out.empty()) out.reserve(size_t(kPrepassTileSize * kPrepassTileSize * samplesPerPixel * depth) + 1);
        const PathContext paths{context.scene, context.camera, context.samplesPerPixel,
                                context.scene.NeedsFootprints()};
        auto &[rng, lambda, start] = path;
        PathWalk walk(paths, start);
        SpectralWeights weights;
        for (int vertex = 0; vertex < depth; ++vertex) {
            const std::optional<ReachedVertex> reached = walk.NextVertex(lambda, weights, rng);
            if (!reached) return;
            if (const HenyeyGreenstein *phase = reached->phase) {
                const Ray &ray = walk.GetRay();
                out.push_back({{reached->p, {}, {}, {}, ray.time}, -ray.d, true, ray.medium, ray.medium, phase});
                walk.ScatterInMedium(reached->p, phase->SampleP(-ray.d, rng.Uniform2()).wi);
                continue;
            }
            const auto &[point, bsdf] = walk.Vertex();
            const BxdfFlags flags = bsdf.Flags();
            if (IsNonSpecular(flags))
                out.push_back({LightContextAt(point), point.wo, IsTransmissive(flags), point.insideMedium,
                               point.outsideMedium, nullptr});
            const std::optional<BsdfSample> sample = walk.SampleScattering(rng);
            if (!sample || !sample->f) return;
        }
    });
    size_t total = 0;
    for (const auto &v : perTile) total += v.size();
    std::vector<PrepassVertex> all;
    all.reserve(total);
    for (auto &v : perTile) {
        all.insert(all.end(), v.begin(), v.end());
        v = {};
    }
    return all;
}

double VisibleContribution(const Scene &scene, const PrepassVertex &vertex, const LightComponent &light,
                           const Point2 &u) {
    const SampledWavelengths &lambda = SampledWavelengths::WholeRange();
    std::optional<LightLiSample> sample = light.SampleLi(vertex.at, u, lambda, true);
    if (!sample || !sample->L || !(sample->pdf > 0)) return 0;
    const Float cosine = vertex.phase ? Float(1) : Dot(sample->wi, vertex.at.ns);
    if (!vertex.transmits && cosine * Dot(vertex.wo, vertex.at.ns) <= 0) return 0;
    // Le G / p (area) equals Le cos / p (solid angle).
    const double value =
        RootMeanSquare(sample->L) * double(std::abs(cosine)) / double(sample->pdf) / scene.Lights().Unit();
    if (!(value > 0) || !std::isfinite(value)) return 0;
    if (!scene.HasMedia()) return scene.Occluded(vertex.at, *sample) ? 0 : value;
    const MediumId medium = Dot(sample->wi, vertex.at.n) > 0 ? vertex.outside : vertex.inside;
    Rng rng(Hash(vertex.at.p, u));
    const ShadowTransmittance through = TraceShadow(scene, vertex.at, medium, *sample, lambda, rng);
    return value * RootMeanSquare(through.value / through.rl.Average());
}

}  // namespace ext
