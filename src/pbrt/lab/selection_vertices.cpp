#include "pbrt/lab/selection_vertices.h"

#include <cmath>
#include <iterator>

#include "pbrt/core/parallel.h"
#include "pbrt/lab/selection_verdict.h"
#include "pbrt/lightsamplers/light_query.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "pbrt/paths/path_walk.h"

namespace pbrt::lab {

namespace {

constexpr uint64_t kStream = 0x73656c656374ull;
constexpr int kRegions = kSelectionSide * kSelectionSide;
constexpr int kMinPaths = 256, kMaxPaths = 4096;  ///< per region
constexpr int kBlock = 16;                        ///< paths per task
constexpr double kEnoughEffective = 60;  ///< tracing ends when half of the lit regions have this many effective paths
constexpr size_t kMaxMeasured = 2048;    ///< most lights measured at a vertex

/// Follows paths as the render makes them and measures the lights at their vertices.
class Measurer {
  public:
    Measurer(const BuiltScene &built)
        : built_(built),
          scene_(*built.scene),
          context_{*built.scene, *built.camera, built.samplesPerPixel, true},
          stride_((scene_.Lights().Size() + kMaxMeasured - 1) / kMaxMeasured) {}

    void Follow(Point2i low, Point2i high, uint64_t stream, std::vector<SelectionVertices::Vertex> &out) {
        Rng rng(stream);
        const size_t before = out.size();
        CameraSample cs;
        cs.pFilm = Point2(low) + Point2(high - low) * rng.Uniform2();
        cs.time = rng.Uniform();
        cs.pLens = rng.Uniform2();
        SampledWavelengths lambda = SampledWavelengths::SampleVisible(rng.Uniform());
        if (std::optional<CameraRay> start = built_.camera->GenerateRay(cs, lambda)) Walk(*start, lambda, rng, out);
        if (out.size() > before) out.back().endsPath = true;
    }

  private:
    void Walk(const CameraRay &start, SampledWavelengths &lambda, Rng &rng,
              std::vector<SelectionVertices::Vertex> &out) {
        PathWalk walk(context_, start);
        SampledSpectrum beta = start.weight;
        Float etaScale = 1;
        for (int depth = 0; depth < built_.maxDepth && walk.Next() == PathWalk::Met::Surface;) {
            if (!walk.FindScattering(lambda)) continue;
            ++depth;
            const auto &[point, bsdf] = walk.Vertex();
            if (IsNonSpecular(bsdf.Flags())) {
                Measure(walk.Vertex(), beta, lambda, rng);
                if (!lights_.empty()) {
                    out.push_back({LightQueryAt(walk.Vertex(), lambda, depth), bsdf, lambda, lights_, false});
                    out.back().query.bsdf = nullptr;
                    out.back().query.lambda = nullptr;
                }
            }
            const Float uc = rng.Uniform();
            std::optional<BsdfSample> sample = bsdf.Sample(point.wo, uc, rng.Uniform2());
            if (!sample) return;
            beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
            if (!beta) return;
            if (IsTransmissive(sample->flags)) etaScale *= Sqr(sample->eta);
            walk.Scatter(*sample);
            const Float survive = (beta * etaScale).MaxComponent();
            if (survive < 1 && depth > 1) {
                if (rng.Uniform() >= survive) return;
                beta /= survive;
            }
        }
    }

    void Measure(const PathVertex &vertex, const SampledSpectrum &beta, const SampledWavelengths &lambda, Rng &rng) {
        const auto &[point, bsdf] = vertex;
        lights_.clear();
        const LightSampleContext from = ScatteringContextAt(scene_, point, bsdf);
        const LightTable &table = scene_.Lights();
        for (auto l = static_cast<size_t>(rng.Uniform() * static_cast<Float>(stride_)); l < table.Size();
             l += stride_) {
            const LightPart light = table[LightId(l)];
            const Point2 u = rng.Uniform2();
            // All directions of a sky, also those that the render leaves to BSDF sampling: tiles may hold them.
            std::optional<LightLiSample> sample = light.SampleLi(from, u, lambda, false);
            if (!sample || !sample->L || !(sample->pdf > 0)) continue;
            const SampledSpectrum f = bsdf.F(point.wo, sample->wi) * AbsDot(sample->wi, point.shading.n);
            if (!f) continue;
            const Float c = SafeDivide(beta * f * sample->L, lambda.Pdf()).Average() / sample->pdf;
            if (!(c > 0) || !std::isfinite(c) || scene_.Occluded(LightContextAt(point), *sample)) continue;
            lights_.push_back({static_cast<uint32_t>(l), c, sample->pdf, bsdf.Pdf(point.wo, sample->wi),
                               IsDelta(light.Kind()), light.Kind() == LightKind::Infinite, sample->pLight, sample->wi});
        }
    }

    const BuiltScene &built_;
    const Scene &scene_;
    PathContext context_;
    size_t stride_;
    std::vector<SelectionVertices::MeasuredLight> lights_;
};

/// True: half of the regions that receive light have enough effective paths.
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

SelectionVertices::SelectionVertices(const BuiltScene &built, int seed, Progress &progress)
    : lights_(built.scene->Lights()) {
    const Bounds2i pixels = built.film->PixelBounds();
    const Vector2i size = pixels.high - pixels.low;
    auto corner = [&](int x, int y) {
        return pixels.low + Point2i(x * size.x / kSelectionSide, y * size.y / kSelectionSide);
    };
    regions_.resize(kRegions);
    progress.BeginPhase("measuring lights", 0);
    for (int done = 0, target = kMinPaths; target <= kMaxPaths && !progress.Cancelled(); done = target, target *= 2) {
        const int blocks = (target - done) / kBlock;
        std::vector<std::vector<Vertex>> found(static_cast<size_t>(kRegions * blocks));
        ParallelForEach(static_cast<int64_t>(found.size()), [&](int64_t task) {
            if (progress.Cancelled()) return;
            Measurer measurer(built);
            const int region = static_cast<int>(task) / blocks, first = done + static_cast<int>(task) % blocks * kBlock;
            const int x = region % kSelectionSide, y = region / kSelectionSide;
            for (int i = first; i < first + kBlock; ++i)
                measurer.Follow(corner(x, y), corner(x + 1, y + 1), Hash(kStream, seed, region, i),
                                found[static_cast<size_t>(task)]);
        });
        for (size_t t = 0; t < found.size(); ++t)
            std::move(found[t].begin(), found[t].end(), std::back_inserter(regions_[t / static_cast<size_t>(blocks)]));
        if (HaveEnough(regions_)) break;
    }
    progress.EndPhase();
}

size_t SelectionVertices::VertexCount() const {
    size_t count = 0;
    for (const auto &region : regions_) count += region.size();
    return count;
}

}  // namespace pbrt::lab
