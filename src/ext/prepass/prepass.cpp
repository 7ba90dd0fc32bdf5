#include "ext/prepass/prepass.h"

#include "pbrt/core/parallel.h"
#include "pbrt/films/filter.h"
#include "pbrt/lights/light_spectrum.h"
#include "pbrt/math/rng.h"
#include "pbrt/paths/path_walk.h"
#include "pbrt/paths/shadow_transmittance.h"

namespace ext {

namespace {

constexpr int kTileSize = 16;
/// Makes the random numbers of the prepass independent of every other use of the seed.
constexpr uint64_t kStream = 0x70726570617373ull;

/// Appends the vertices of one camera path.
void TracePath(const PrepareContext &context, Point2i pixel, int sampleIndex, int depth,
               std::vector<PrepassVertex> &out) {
    Rng rng(Hash(kStream, context.seed, pixel, sampleIndex));
    CameraSample cs;
    cs.pFilm = Point2(pixel) + Point2(0.5f, 0.5f) + context.filter.Sample(rng.Uniform2()).offset;
    cs.time = rng.Uniform();
    cs.pLens = rng.Uniform2();
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(rng.Uniform());
    std::optional<CameraRay> start = context.camera.GenerateRay(cs, lambda);
    if (!start) return;
    const PathContext paths{context.scene, context.camera, context.samplesPerPixel, context.scene.NeedsFootprints()};
    PathWalk walk(paths, *start);
    SpectralWeights weights;
    for (int vertex = 0; vertex < depth;) {
        const PathWalk::Met met = walk.Next();
        if (met == PathWalk::Met::TooManyInterfaces) return;
        if (const Medium *medium = walk.MediumAhead()) {
            const Ray &ray = walk.GetRay();
            const Float u = rng.Uniform();
            const MediumEvent event =
                walk.ThroughMedium(lambda, u, rng, false, weights, [](const SampledSpectrum &, Float) {});
            if (event.kind == MediumEvent::Kind::Absorbed) return;
            if (event.kind == MediumEvent::Kind::Scattered) {
                ++vertex;
                const LightSampleContext at{ray(event.t), {}, {}, {}, ray.time};
                out.push_back({at, -ray.d, true, ray.medium, ray.medium, &medium->Phase()});
                walk.ScatterInMedium(ray(event.t), medium->Phase().SampleP(-ray.d, rng.Uniform2()).wi);
                continue;
            }
        }
        if (met == PathWalk::Met::Nothing) return;
        if (!walk.FindScattering(lambda)) continue;
        ++vertex;
        const auto &[point, bsdf] = walk.Vertex();
        const BxdfFlags flags = bsdf.Flags();
        if (IsNonSpecular(flags))
            out.push_back({LightContextAt(point), point.wo, IsTransmissive(flags), point.insideMedium,
                           point.outsideMedium, nullptr});
        const Float uc = rng.Uniform();
        const std::optional<BsdfSample> sample = bsdf.Sample(point.wo, uc, rng.Uniform2());
        if (!sample || !sample->f) return;
        walk.Scatter(*sample);
    }
}

/// The number of paths through a pixel: the integer part of samplesPerPixel, and one more in a share of the pixels that
/// equals its fractional part.
int PathsOf(Point2i pixel, double samplesPerPixel) {
    int whole = static_cast<int>(samplesPerPixel);
    double fraction = samplesPerPixel - whole;
    return whole + (fraction > 0 && static_cast<double>(HashFloat(kStream, pixel)) < fraction ? 1 : 0);
}

}  // namespace

LightQuery QueryAt(const PrepassVertex &vertex) {
    LightQuery query;
    query.p = vertex.at.p;
    query.wo = vertex.wo;
    query.n = vertex.at.n;
    query.ns = vertex.at.ns;
    query.transmits = vertex.transmits;
    query.time = vertex.at.time;
    query.pError = vertex.at.pError;
    if (vertex.phase) query.medium = vertex.inside;
    query.phase = vertex.phase;
    return query;
}

std::vector<PrepassVertex> TracePrepassPaths(PrepareContext &context, double samplesPerPixel, int depth) {
    const Bounds2i &bounds = context.pixelBounds;
    Vector2i tiles = (bounds.high - bounds.low + (kTileSize - 1)) / kTileSize;
    int64_t tileCount = bounds.IsEmpty() ? 0 : int64_t(tiles.x) * tiles.y;
    std::vector<std::vector<PrepassVertex>> perTile(static_cast<size_t>(tileCount));
    context.progress.BeginPhase("prepass", tileCount);
    ParallelForEach(tileCount, [&](int64_t tile) {
        if (context.progress.Cancelled()) return;
        std::vector<PrepassVertex> &out = perTile[static_cast<size_t>(tile)];
        out.reserve(static_cast<size_t>(kTileSize * kTileSize * samplesPerPixel * depth) + 1);
        Point2i low =
            bounds.low + kTileSize * Point2i(static_cast<int>(tile % tiles.x), static_cast<int>(tile / tiles.x));
        Point2i high = glm::min(low + kTileSize, bounds.high);
        for (int y = low.y; y < high.y; ++y)
            for (int x = low.x; x < high.x; ++x)
                for (int s = 0, count = PathsOf({x, y}, samplesPerPixel); s < count; ++s)
                    TracePath(context, {x, y}, s, depth, out);
        context.progress.Advance();
    });
    size_t total = 0;
    for (const auto &v : perTile) total += v.size();
    std::vector<PrepassVertex> all;
    all.reserve(total);
    for (auto &v : perTile) {
        all.insert(all.end(), v.begin(), v.end());
        v = {};
    }
    context.progress.EndPhase();
    return all;
}

SampledSpectrum VisibleContribution(const Scene &scene, const PrepassVertex &vertex, LightId light, const Point2 &u) {
    static const SampledWavelengths lambda = PowerWavelengths();
    std::optional<LightLiSample> sample = scene.Lights()[light].SampleLi(vertex.at, u, lambda, true);
    if (!sample || !sample->L || !(sample->pdf > 0)) return SampledSpectrum(0);
    const Float cosine = vertex.phase ? Float(1) : Dot(sample->wi, vertex.at.ns);
    if (!vertex.transmits && cosine * Dot(vertex.wo, vertex.at.ns) <= 0) return SampledSpectrum(0);
    // Le G / p by area equals Le cos / p by solid angle.
    const SampledSpectrum value = sample->L * (std::abs(cosine) / sample->pdf);
    if (!(value.Average() > 0) || !std::isfinite(value.Average())) return SampledSpectrum(0);
    if (!scene.HasMedia()) return scene.Occluded(vertex.at, *sample) ? SampledSpectrum(0) : value;
    const MediumId medium = Dot(sample->wi, vertex.at.n) > 0 ? vertex.outside : vertex.inside;
    Rng rng(Hash(vertex.at.p, u));
    const ShadowTransmittance through = TraceShadow(scene, vertex.at, medium, *sample, lambda, rng);
    return value * through.value / through.rl.Average();
}

Float VisibleMean(const SampledSpectrum &s) { return SafeDivide(s, PowerWavelengths().Pdf()).Average(); }

}  // namespace ext
