#include "ext/lab/selection_check.h"

#include <cmath>
#include <iterator>

#include "pbrt/core/parallel.h"
#include "pbrt/math/rng.h"
#include "pbrt/transport/path_walk.h"
#include "pbrt/transport/shadow_transmittance.h"
#include "pbrt/transport/vertex.h"

namespace ext::lab {
namespace {

constexpr uint64_t kVertexStream = 0x73656c656374ull;
constexpr int kRegions = kSelectionSide * kSelectionSide;
constexpr int kMinPaths = 256, kMaxPaths = 4096;  ///< per region
constexpr int kBlock = 16;                        ///< paths per task
constexpr double kEnoughEffective = 60;  ///< tracing ends when half of the lit regions have this many effective paths
constexpr size_t kMaxMeasured = 2048;    ///< maximum lights measured per vertex
constexpr Float kAllInMedium = 8;        ///< vertices in media up to this depth are all measured

/// Traces paths as in the render and measures the lights at their vertices.
class Measurer {
  public:
    explicit Measurer(const BuiltScene &built) : built_(built) {}

    void Follow(Point2i low, Point2i high, uint64_t stream, std::vector<SelectionVertices::Vertex> &out) {
        Rng rng(stream);
        const size_t before = out.size();
        CameraSample cs;
        cs.pFilm = Point2(low) + Point2(high - low) * rng.Uniform2();
        cs.time = rng.Uniform();
        cs.pLens = rng.Uniform2();
        const SampledWavelengths lambda = SampledWavelengths::SampleVisible(rng.Uniform());
        if (std::optional<CameraRay> start = built_.camera->GenerateRay(cs, lambda)) {
            Path path{PathWalk(context_, *start), lambda, rng, out};
            path.weights.beta = start->weight;
            Walk(path);
        }
        if (out.size() > before) out.back().endsPath = true;
    }

  private:
    struct Path {
        PathWalk walk;
        SampledWavelengths lambda;
        Rng rng;
        std::vector<SelectionVertices::Vertex> &out;
        SpectralWeights weights{};
        int depth = 0;
    };
    /// f times cosine, or phase function, and the scattering density (solid angle).
    struct ScatteringValue {
        SampledSpectrum f;
        Float pdf = 0;
    };

    void Walk(Path &path) {
        auto &[walk, lambda, rng, out, weights, depth] = path;
        Float etaScale = 1;
        while (depth < built_.maxDepth) {
            const std::optional<ReachedVertex> reached = walk.NextVertex(lambda, weights, rng);
            if (!reached) return;
            ++depth;
            if (reached->phase) {
                ScatterInMedium(path, *reached->phase, reached->p);
                continue;
            }
            const auto &[point, bsdf] = walk.Vertex();
            if (IsNonSpecular(bsdf.Flags())) {
                Measure(
                    path, ScatteringContextAt(scene_, point, bsdf),
                    [&](const Vector3 &wi) { return point.MediumTowards(wi); },
                    [&](const Vector3 &wi) {
                        const SampledSpectrum f = bsdf.F(point.wo, wi) * AbsDot(wi, point.shading.n);
                        return ScatteringValue{f, f ? bsdf.Pdf(point.wo, wi) : 0};
                    });
                Keep({LightQueryAt(walk.Vertex(), lambda, depth), bsdf, {}, lambda, lights_}, out);
            }
            const std::optional<BsdfSample> sample = walk.SampleScattering(rng);
            if (!sample) return;
            weights.beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
            if (!weights.beta) return;
            if (IsTransmissive(sample->flags)) etaScale *= Sqr(sample->eta);
            const Float continuation = (weights.beta * etaScale / weights.Mean(weights.ru)).MaxComponent();
            if (depth > 1 && EndsByRoulette(continuation, rng, weights.beta)) return;
        }
    }

    static void Keep(SelectionVertices::Vertex &&vertex, std::vector<SelectionVertices::Vertex> &out) {
        if (vertex.lights.empty()) return;
        vertex.query.bsdf = nullptr;
        vertex.query.phase = nullptr;
        vertex.query.lambda = nullptr;
        out.push_back(std::move(vertex));
    }

    /// Measures the lights at p in the medium ahead and scatters the path there.
    void ScatterInMedium(Path &path, const HenyeyGreenstein &phase, const Point3 &p) {
        auto &[walk, lambda, rng, out, weights, depth] = path;
        const Ray ray = walk.GetRay();
        // A path in a dense medium has a hundred vertices: of the later ones some are measured and represent all.
        const Float share = std::min(Float(1), kAllInMedium / Float(depth));
        if (share == 1 || rng.Uniform() < share) {
            Measure(
                path, {p, {}, {}, {}, ray.time}, [&](const Vector3 &) { return ray.medium; },
                [&](const Vector3 &wi) {
                    const Float value = phase.P(-ray.d, wi);
                    return ScatteringValue{SampledSpectrum(value / share), value};
                });
            const LightQuery query = LightQueryInMedium(p, -ray.d, ray.medium, phase, ray.time, lambda, depth);
            Keep({query, {}, phase, lambda, lights_}, out);
        }
        walk.ScatterInMedium(p, phase.SampleP(-ray.d, rng.Uniform2()).wi);
    }

    /// Writes lights_. `from`: receiver of light sampling.
    void Measure(Path &path, const LightSampleContext &from, auto &&mediumTowards, auto &&scatter) {
        lights_.clear();
        const LightTable &table = scene_.Lights();
        const SpectralWeights &weights = path.weights;
        auto strength = [&](const SampledSpectrum &s) { return SafeDivide(s, path.lambda.Pdf()).Average(); };
        for (auto l = size_t(path.rng.Uniform() * Float(stride_)); l < table.Size(); l += stride_) {
            const LightComponent light = table[LightId(l)];
            const Point2 u = path.rng.Uniform2();
            // All directions of an environment light, also those that the render leaves to BSDF sampling.
            std::optional<LightLiSample> sample = light.SampleLi(from, u, path.lambda, false);
            if (!sample || !sample->L || !(sample->pdf > 0)) continue;
            const ScatteringValue to = scatter(sample->wi);
            if (!to.f) continue;
            const ShadowTransmittance through =
                TraceShadow(scene_, from, mediumTowards(sample->wi), *sample, path.lambda, path.rng);
            if (!through.value) continue;
            const SampledSpectrum contribution = weights.beta * to.f * sample->L * through.value;
            const Float c = strength(contribution) / (sample->pdf * weights.Mean(weights.ru * through.rl));
            if (!(c > 0) || !std::isfinite(c)) continue;
            lights_.push_back({uint32_t(l), c, sample->pdf, to.pdf, IsDelta(light.Kind()),
                               light.Kind() == LightKind::Infinite, sample->wi});
        }
    }

    const BuiltScene &built_;
    const Scene &scene_ = *built_.scene;
    PathContext context_{scene_, *built_.camera, built_.samplesPerPixel, true};
    size_t stride_ = (scene_.Lights().Size() + kMaxMeasured - 1) / kMaxMeasured;
    std::vector<SelectionVertices::MeasuredLight> lights_;
};

/// True if half of the regions that receive light have enough effective paths.
bool HaveEnough(std::span<const std::vector<SelectionVertices::Vertex>> regions) {
    int lit = 0, enough = 0;
    for (const auto &region : regions) {
        std::vector<VertexFinding> light;
        for (const auto &v : region) {
            light.push_back({.endsPath = v.endsPath});
            for (const auto &m : v.lights) light.back().light += m.c;
        }
        lit += !light.empty();
        enough += EffectivePaths(light) >= kEnoughEffective;
    }
    return 2 * enough >= lit && lit > 0;
}

}  // namespace

SelectionVertices SelectionVertices::Measure(const BuiltScene &built, int seed, Progress &progress) {
    SelectionVertices measured(built.scene->Lights());
    const Bounds2i pixels = built.film->PixelBounds();
    const Vector2i size = pixels.high - pixels.low;
    auto corner = [&](int x, int y) {
        return pixels.low + Point2i(x * size.x / kSelectionSide, y * size.y / kSelectionSide);
    };
    measured.regions_.resize(kRegions);
    progress.BeginPhase("measuring lights", 0);
    for (int done = 0, target = kMinPaths; target <= kMaxPaths && !progress.Cancelled(); done = target, target *= 2) {
        const int blocks = (target - done) / kBlock;
        std::vector<std::vector<Vertex>> found(kRegions * blocks);
        ParallelForEach(found.size(), [&](int64_t task) {
            if (progress.Cancelled()) return;
            Measurer measurer(built);
            const int region = int(task) / blocks, first = done + int(task) % blocks * kBlock;
            const int x = region % kSelectionSide, y = region / kSelectionSide;
            for (int i = first; i < first + kBlock; ++i)
                measurer.Follow(corner(x, y), corner(x + 1, y + 1), Hash(kVertexStream, seed, region, i), found[task]);
        });
        for (size_t t = 0; t < found.size(); ++t)
            std::move(found[t].begin(), found[t].end(), std::back_inserter(measured.regions_[t / blocks]));
        measured.paths_ = target;
        if (HaveEnough(measured.regions_)) break;
    }
    progress.EndPhase();
    return measured;
}

}  // namespace ext::lab
