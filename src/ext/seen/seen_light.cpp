#include "ext/seen/seen_light.h"

#include "pbrt/core/parallel.h"
#include "pbrt/films/filter.h"
#include "pbrt/lightsamplers/light_query.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "pbrt/paths/path_walk.h"
#include "pbrt/paths/shadow_transmittance.h"

namespace ext {

namespace {

constexpr int kTileSize = 16;
/// Makes the random numbers of this prepass independent of every other use of the seed.
constexpr uint64_t kStream = 0x7365656eull;
/// Paths have at most so many vertices, whatever the render's may have.
constexpr int kMaxDepth = 8;
constexpr double kLargest = 100;
/// How much a tile counts: one over the square of its mean and this part of the picture's.
constexpr double kPlain = 0.1;

struct Find {
    uint32_t group;
    Float value;
};

/// One camera path, and what it finds.
class SeenPath {
  public:
    SeenPath(const PrepareContext &context, const GroupLightSampler &chooser, Point2i pixel, int sample,
             std::vector<Find> &finds)
        : context_(context),
          scene_(context.scene),
          chooser_(chooser),
          finds_(finds),
          rng_(Hash(kStream, context.seed, pixel, sample)) {
        CameraSample cs;
        cs.pFilm = Point2(pixel) + Point2(0.5f, 0.5f) + context.filter.Sample(rng_.Uniform2()).offset;
        cs.time = rng_.Uniform();
        cs.pLens = rng_.Uniform2();
        lambda_ = SampledWavelengths::SampleVisible(rng_.Uniform());
        if (const std::optional<CameraRay> start = context.camera.GenerateRay(cs, lambda_)) Follow(*start);
    }

  private:
    void Follow(const CameraRay &start) {
        const PathContext paths{scene_, context_.camera, context_.samplesPerPixel, scene_.NeedsFootprints()};
        PathWalk walk(paths, start);
        const int most = std::min(context_.maxDepth, kMaxDepth);
        SpectralWeights weights;
        bool anyNonSpecular = false;
        for (int depth = 0;;) {
            const PathWalk::Met met = walk.Next();
            if (met == PathWalk::Met::TooManyInterfaces) return;
            if (const Medium *medium = walk.MediumAhead()) {
                const Ray &ray = walk.GetRay();
                const Float u = rng_.Uniform();
                const MediumEvent event =
                    walk.ThroughMedium(lambda_, u, rng_, false, weights, [](const SampledSpectrum &, Float) {});
                if (event.kind == MediumEvent::Kind::Absorbed) return;
                if (event.kind == MediumEvent::Kind::Scattered) {
                    if (depth++ == most) return;
                    const HenyeyGreenstein &phase = medium->Phase();
                    const Point3 p = ray(event.t);
                    const Vector3 wo = -ray.d;
                    query_ = LightQueryInMedium(p, wo, ray.medium, phase, ray.time, lambda_, depth);
                    from_ = {p, {}, {}, {}, ray.time};
                    SampleLight(
                        from_, [&](const Vector3 &wi) { return SampledSpectrum(phase.P(wo, wi)); },
                        [&](const Vector3 &wi) { return phase.P(wo, wi); },
                        [&](const Vector3 &) { return ray.medium; });
                    const auto scattered = phase.SampleP(wo, rng_.Uniform2());
                    pdf_ = scattered.p;
                    anyNonSpecular = true;
                    walk.ScatterInMedium(p, scattered.wi);
                    continue;
                }
            }
            if (anyNonSpecular)
                walk.ForEachEmission(lambda_, [&](const SampledSpectrum &Le, LightId id, const Point3 &p,
                                                  const Normal3 &n) { Hit(beta_ * Le, id, walk.GetRay().d, p, n); });
            if (met == PathWalk::Met::Nothing) return;
            if (!walk.FindScattering(lambda_)) continue;
            if (depth++ == most) return;
            const auto &[point, bsdf] = walk.Vertex();
            if (IsNonSpecular(bsdf.Flags())) {
                query_ = LightQueryAt(walk.Vertex(), lambda_, depth);
                from_ = LightContextAt(point);
                SampleLight(
                    ScatteringContextAt(scene_, point, bsdf),
                    [&](const Vector3 &wi) { return bsdf.F(point.wo, wi) * AbsDot(wi, point.shading.n); },
                    [&](const Vector3 &wi) { return bsdf.Pdf(point.wo, wi); },
                    [&](const Vector3 &wi) { return Dot(wi, point.n) > 0 ? point.outsideMedium : point.insideMedium; });
            }
            const Float uc = rng_.Uniform();
            const std::optional<BsdfSample> sample = bsdf.Sample(point.wo, uc, rng_.Uniform2());
            if (!sample) return;
            beta_ *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
            if (!beta_) return;
            pdf_ = IsSpecular(sample->flags)   ? 0
                   : sample->pdfIsProportional ? bsdf.Pdf(point.wo, sample->wi)
                                               : sample->pdf;
            anyNonSpecular = anyNonSpecular || pdf_ > 0;
            walk.Scatter(*sample);
            if (depth > 1) {
                const Float survive = beta_.MaxComponent();
                if (survive < 1) {
                    if (rng_.Uniform() >= survive) return;
                    beta_ /= survive;
                }
            }
        }
    }

    void Add(const SampledSpectrum &L, LightId light) {
        const Float value = SafeDivide(L, lambda_.Pdf()).Average();
        if (value > 0 && std::isfinite(value)) finds_.push_back({chooser_.Groups().GroupOf(light), value});
    }

    /// `scattered(wi)`: what the vertex scatters from a direction, with the cosine; `pdf(wi)`: with which density it
    /// is sampled.
    template <class Scattered, class Pdf, class MediumTowards>
    void SampleLight(const LightSampleContext &at, Scattered &&scattered, Pdf &&pdf, MediumTowards &&mediumTowards) {
        lights_ = chooser_.At(query_, memory_);
        const Float u = rng_.Uniform();
        const Point2 uLight = rng_.Uniform2();
        const std::optional<SampledLight> chosen = lights_.Sample(u);
        if (!chosen || !(chosen->pmf > 0)) return;
        const LightPart light = scene_.Lights()[chosen->light];
        const std::optional<LightLiSample> found = light.SampleLi(at, uLight, lambda_, true);
        if (!found || !found->L || !(found->pdf > 0)) return;
        const Float density = chosen->pmf * found->pdf;
        SampledSpectrum L = beta_ * scattered(found->wi) * found->L / density;
        if (!L) return;
        if (scene_.HasMedia()) {
            const ShadowTransmittance through =
                TraceShadow(scene_, from_, mediumTowards(found->wi), *found, lambda_, rng_);
            L *= through.value / through.rl.Average();
        } else if (scene_.Occluded(from_, *found)) {
            return;
        }
        if (!IsDelta(light.Kind())) L *= PowerHeuristic(density, pdf(found->wi));
        Add(L, chosen->light);
    }

    void Hit(const SampledSpectrum &L, LightId light, const Vector3 &wi, const Point3 &p, const Normal3 &n) {
        Float weight = 1;
        if (pdf_ > 0) {
            const Float density = lights_.PMF(light) * scene_.Lights()[light].PdfLi(from_, wi, p, n, true);
            weight = PowerHeuristic(pdf_, density);
        }
        Add(L * weight, light);
    }

    const PrepareContext &context_;
    const Scene &scene_;
    const GroupLightSampler &chooser_;
    std::vector<Find> &finds_;
    Rng rng_;
    SampledWavelengths lambda_;
    SampledSpectrum beta_{1};
    // The last vertex that is not specular. A `pdf_` of 0: the path left the last vertex by a specular sample.
    LightQuery query_;
    LightMemory memory_;
    LightDistribution lights_;
    LightSampleContext from_;
    Float pdf_ = 0;
};

}  // namespace

std::vector<SeenLight> FindSeenLight(PrepareContext &context, const GroupLightSampler &chooser, double paths) {
    const Bounds2i &bounds = context.pixelBounds;
    const Vector2i tiles = (bounds.high - bounds.low + (kTileSize - 1)) / kTileSize;
    const int64_t tileCount = bounds.IsEmpty() ? 0 : int64_t(tiles.x) * tiles.y;
    const double pathsPerPixel = tileCount > 0 ? paths / static_cast<double>(bounds.Area()) : 0;
    const int whole = static_cast<int>(pathsPerPixel);
    const double fraction = pathsPerPixel - whole;
    struct Tile {
        std::vector<Find> finds;
        int64_t paths = 0;
        double sum = 0;
    };
    std::vector<Tile> perTile(static_cast<size_t>(tileCount));
    context.progress.BeginPhase("light seen", tileCount);
    ParallelForEach(tileCount, [&](int64_t tile) {
        if (context.progress.Cancelled()) return;
        const Point2i low =
            bounds.low + kTileSize * Point2i(static_cast<int>(tile % tiles.x), static_cast<int>(tile / tiles.x));
        const Point2i high = glm::min(low + kTileSize, bounds.high);
        Tile &to = perTile[static_cast<size_t>(tile)];
        for (int y = low.y; y < high.y; ++y)
            for (int x = low.x; x < high.x; ++x) {
                const Point2i pixel(x, y);
                const bool oneMore = static_cast<double>(HashFloat(kStream, context.seed, pixel)) < fraction;
                const int count = whole + (oneMore ? 1 : 0);
                for (int s = 0; s < count; ++s) SeenPath(context, chooser, pixel, s, to.finds);
                to.paths += count;
            }
        for (const Find &f : to.finds) to.sum += static_cast<double>(f.value);
        context.progress.Advance();
    });
    double sum = 0, count = 0, all = 0;
    for (const Tile &t : perTile) {
        sum += t.sum;
        count += static_cast<double>(t.finds.size());
        all += static_cast<double>(t.paths);
    }
    std::vector<SeenLight> seen(chooser.Groups().Size());
    if (sum > 0)
        for (const Tile &t : perTile) {
            const double largest = kLargest * sum / count;
            const double brightness = t.sum / std::max(1.0, static_cast<double>(t.paths)) / (sum / all) + kPlain;
            for (const Find &f : t.finds) {
                seen[f.group].sum += std::min(static_cast<double>(f.value), largest) / (brightness * brightness);
                ++seen[f.group].count;
            }
        }
    context.progress.EndPhase();
    return seen;
}

}  // namespace ext
