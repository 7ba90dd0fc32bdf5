// Measures whether tracing the rays of a tile together would be faster. The rays are those of a render by "path" with
// light sampler bvh, --quick and maximum depth 5. A wave is what paths traced side by side would have at once: all rays
// of a tile of 16 x 16 pixels, of one step of its paths, and of one kind. Each wave is traced
//
//   single   one by one, as Accel does
//   packets  in packets of 8
//   sorted   in packets of 8 after sorting by the octant of the direction
//   stream   by rtcIntersect1M and rtcOccluded1M
//
// Times are CPU nanoseconds per ray on one thread, the best of 5 repetitions in turns, and include conversions and
// sorting, but no shading between the rays. "differ" counts rays whose hit is not the render's.
//
//     bench_ray_packets scene.pbrt ...
//
// Callbacks take one ray at a time also in packets (wave_tracer.h). Scenes with moving shapes are errors.
#include <array>
#include <cstdio>
#include <ctime>

#include "pbrt/build/built_scene.h"
#include "pbrt/core/counters.h"
#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/progress.h"
#include "pbrt/integrators/pixel_integrator.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/scenefile/parser.h"
#include "pbrt/transport/direct_light.h"
#include "plugins.h"
#include "wave_tracer.h"

namespace pbrt {
namespace {

constexpr int kTileSize = 16, kMaxDepth = 5, kRepetitions = 5;
/// Fraction of rays that may hit something else than in the render, at silhouettes or by rounding.
constexpr double kMaxDiffering = 1e-3;

/// All waves of one kind of ray, tile by tile.
struct RayKind {
    const char *name;
    bool isShadow, isCoherent;
    std::vector<Ray> rays{};
    std::vector<Float> distances{};  ///< in the render, as Found::t
    std::vector<size_t> waveEnds{};

    void ForEachWave(auto &&visit) const {
        size_t begin = 0;
        for (size_t end : waveEnds) {
            visit(Wave{std::span(rays).subspan(begin, end - begin), isShadow, isCoherent}, begin);
            begin = end;
        }
    }
};
using RayKinds = std::array<RayKind, 3>;  ///< camera, bounce, shadow

/// Collects the rays of CameraPath with BsdfDirections, for the first sample of every pixel.
class RayCollector {
  public:
    explicit RayCollector(const BuiltScene &built)
        : built_(built), context_{*built.scene, *built.camera, built.samplesPerPixel,
                                  built.integratorRequest.needsFootprints},
          lights_(*built.integrator->Lights()), sampler_(built.sampler->Clone()) {}

    RayKinds Collect() {
        const Bounds2i bounds = built_.film->PixelBounds();
        for (int y = bounds.low.y; y < bounds.high.y; y += kTileSize)
            for (int x = bounds.low.x; x < bounds.high.x; x += kTileSize) CollectTile({x, y}, bounds.high);
        return std::move(kinds_);
    }

  private:
    struct TracedRay {
        Ray ray;
        Float distance;
    };
    using Steps = std::vector<std::vector<TracedRay>>;

    /// Each 8 consecutive paths are of a block of 4 x 2 pixels.
    void CollectTile(Point2i low, Point2i end) {
        constexpr int kBlockWidth = 4, kBlockHeight = 2, kBlocksPerRow = kTileSize / kBlockWidth;
        for (int i = 0; i < kTileSize * kTileSize; ++i) {
            const int block = i / int(kLanes), lane = i % int(kLanes);
            const Point2i pixel = low + Vector2i(block % kBlocksPerRow * kBlockWidth + lane % kBlockWidth,
                                                 block / kBlocksPerRow * kBlockHeight + lane / kBlockWidth);
            if (pixel.x < end.x && pixel.y < end.y) Follow(pixel);
        }
        for (size_t step = 0; step < closest_.size(); ++step) AddWave(kinds_[step == 0 ? 0 : 1], closest_[step]);
        for (std::vector<TracedRay> &rays : shadow_) AddWave(kinds_[2], rays);
    }
    static void AddWave(RayKind &kind, std::vector<TracedRay> &wave) {
        if (wave.empty()) return;
        for (const auto &[ray, distance] : wave) {
            kind.rays.push_back(ray);
            kind.distances.push_back(distance);
        }
        kind.waveEnds.push_back(kind.rays.size());
        wave.clear();
    }
    /// Leaves out rays that Accel does not trace (IsRay in accel.cpp).
    static void Record(Steps &steps, size_t step, const Ray &ray, Float distance) {
        constexpr Float kReach = 1.844e18f;
        bool isTraced = ray.tMax > 0;
        for (int c = 0; c < 3; ++c) isTraced = isTraced && std::abs(ray.o[c]) <= kReach && std::abs(ray.d[c]) <= kReach;
        if (steps.size() <= step) steps.resize(step + 1);
        if (isTraced) steps[step].push_back({ray, distance});
    }

    void Follow(Point2i pixel) {
        sampler_->StartPixelSample(pixel, 0);
        SampledWavelengths lambda = built_.film->SampleWavelengths(sampler_->Get1D());
        const CameraSample cs = SampleCamera(*built_.filter, pixel, *sampler_);
        const std::optional<CameraRay> start = built_.camera->GenerateRay(cs, lambda);
        if (!start) return;
        PathWalk walk(context_, *start);
        SampledSpectrum beta(1);
        Float etaScale = 1;
        int depth = 0;
        for (size_t step = 0;; ++step) {
            const Ray ray = walk.GetRay();
            const PathWalk::Met met = walk.Next();
            Record(closest_, step, ray, met == PathWalk::Met::Nothing ? Infinity : walk.Vertex().point.t);
            if (met != PathWalk::Met::Surface) return;
            if (!walk.FindScattering(lambda)) continue;
            if (depth++ == built_.maxDepth) return;
            const auto &[point, bsdf] = walk.Vertex();
            if (IsNonSpecular(bsdf.Flags())) SampleLight(walk.Vertex(), lambda, depth, step);
            const Float uComponent = sampler_->Get1D();
            const std::optional<BsdfSample> sample = bsdf.Sample(point.wo, uComponent, sampler_->Get2D());
            if (!sample) return;
            beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
            if (!beta) return;
            if (IsTransmissive(sample->flags)) etaScale *= Sqr(sample->eta);
            walk.Scatter(*sample);
            if (depth > 1 && !Continues(beta, (beta * etaScale).MaxComponent())) return;
        }
    }
    void SampleLight(const PathVertex &vertex, const SampledWavelengths &lambda, int depth, size_t step) {
        selection_.Prepare(lights_, vertex, lambda, depth);
        const Float uLight = sampler_->Get1D();
        ObservedPath unobserved;
        SampleDirectLight(*built_.scene, vertex, selection_.lights, lambda, true, uLight, sampler_->Get2D(), unobserved,
                          [&](const LightLiSample &to, const Point2 &) {
                              const Ray ray = Scene::ShadowRay(selection_.from, to);
                              const bool isBlocked = built_.scene->Occluded(ray);
                              Record(shadow_, step, ray, isBlocked ? 0 : Infinity);
                              ShadowTransmittance through;
                              if (!isBlocked) through.value = SampledSpectrum(1);
                              return through;
                          });
    }
    bool Continues(SampledSpectrum &beta, Float probability) {
        if (!(probability < 1)) return true;
        if (sampler_->Get1D() >= probability) return false;
        beta /= probability;
        return true;
    }

    const BuiltScene &built_;
    PathContext context_;
    const LightSampler &lights_;
    std::unique_ptr<Sampler> sampler_;
    VertexSelection selection_;
    Steps closest_, shadow_;  ///< of the tile, by step of the path
    RayKinds kinds_{RayKind{"camera", false, true}, RayKind{"bounce", false, false}, RayKind{"shadow", true, false}};
};

/// Numbers of rays of a kind, by way.
struct Measurement {
    PerWay nanoseconds{};  ///< per ray, CPU time
    std::array<size_t, kWayCount> differing{};

    double Fastest() const { return *std::min_element(nanoseconds.begin(), nanoseconds.end()); }
};

bool IsSameHit(Float t, Float expected) {
    if (t == Infinity || expected == Infinity) return t == expected;
    return std::abs(t - expected) <= 1e-5f * expected;
}

/// Throws UserError if a way finds other hits than the render.
Measurement Measure(WaveTracer &tracer, const RayKind &kind) {
    Measurement result;
    if (kind.rays.empty()) return result;
    const auto rays = double(kind.rays.size());
    result.nanoseconds.fill(double(Infinity));
    std::vector<Found> found(kind.rays.size());
    for (int repetition = 0; repetition < kRepetitions; ++repetition)
        for (size_t way = 0; way < kWayCount; ++way) {
            const double start = ClockSeconds(CLOCK_THREAD_CPUTIME_ID);
            kind.ForEachWave(
                [&](const Wave &wave, size_t first) { tracer.Trace(Way(way), wave, found.data() + first); });
            const double seconds = ClockSeconds(CLOCK_THREAD_CPUTIME_ID) - start;
            result.nanoseconds[way] = std::min(result.nanoseconds[way], seconds / rays * 1e9);
            if (repetition > 0) continue;
            for (size_t i = 0; i < found.size(); ++i)
                result.differing[way] += IsSameHit(found[i].t, kind.distances[i]) ? 0 : 1;
            // One by one is what the render does, so its hits are identical.
            if (double(result.differing[way]) > (way == kSingle ? 0 : kMaxDiffering * rays))
                throw UserError("Way {} finds other hits than the render, for {} of {} {} rays.", way,
                                result.differing[way], kind.rays.size(), kind.name);
        }
    return result;
}

struct RenderCost {
    double seconds = Infinity;  ///< CPU
    RenderCounters counters;
};

/// The whole render of the collected paths; the fastest of kRepetitions.
RenderCost RenderOnce(const BuiltScene &built, Progress &progress) {
    ThreadLimit limit(1);
    RenderSettings settings;
    settings.samplesPerPixel = built.samplesPerPixel;
    RenderCost cost;
    for (int i = 0; i < kRepetitions; ++i) {
        ResetCounters();
        const double start = ClockSeconds(CLOCK_PROCESS_CPUTIME_ID);
        RenderWaves(built.Rendering(progress), settings);
        cost.seconds = std::min(cost.seconds, ClockSeconds(CLOCK_PROCESS_CPUTIME_ID) - start);
    }
    cost.counters = SumCounters();
    return cost;
}

void PrintSupport(RTCScene scene) {
    RTCDevice device = rtcGetSceneDevice(scene);
    const auto has = [&](RTCDeviceProperty property) { return rtcGetDeviceProperty(device, property) ? "yes" : "no"; };
    std::printf("native packets of 8: %s, streams: %s\n", has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED),
                has(RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED));
    rtcReleaseDevice(device);
}

/// Prints nanoseconds per ray of each kind and way. Then the render's time, and its speed-up if each kind took the time
/// of its fastest way: an estimate, because shading evicts the scene from caches, and waves have costs of their own.
void Report(const RayKinds &kinds, WaveTracer &tracer, const RenderCost &render) {
    double single = 0, fastest = 0;
    size_t closest = 0, shadow = 0;
    std::printf("%-8s %9s %9s %9s %9s %9s %9s   differ: packets, sorted, stream\n", "rays", "number", "per wave",
                "single", "packets", "sorted", "stream");
    for (const RayKind &kind : kinds) {
        const Measurement m = Measure(tracer, kind);
        const size_t count = kind.rays.size();
        single += m.nanoseconds[kSingle] * 1e-9 * double(count);
        fastest += m.Fastest() * 1e-9 * double(count);
        (kind.isShadow ? shadow : closest) += count;
        std::printf("%-8s %9zu %9.1f %9.1f %9.1f %9.1f %9.1f   %zu, %zu, %zu\n", kind.name, count,
                    double(count) / double(std::max<size_t>(1, kind.waveEnds.size())), m.nanoseconds[kSingle],
                    m.nanoseconds[kPackets], m.nanoseconds[kSorted], m.nanoseconds[kStream], m.differing[kPackets],
                    m.differing[kSorted], m.differing[kStream]);
    }
    std::printf("render: %.3f s; rays one by one: %.3f s; each kind in its fastest way: %.3f s; speed-up: %.3f\n",
                render.seconds, single, fastest, render.seconds / (render.seconds - single + fastest));
    std::printf("closest-hit rays: %zu collected, %zu rendered; shadow rays: %zu collected, %zu rendered\n\n", closest,
                size_t(render.counters.closestHitRays), shadow, size_t(render.counters.shadowRays));
}

void Run(const char *file) {
    std::printf("%s\n", file);
    PluginRegistry registry;
    RegisterPlugins(registry);
    DiagnosticSink sink;
    SceneDescription description = ParseSceneFiles({file}, sink);
    sink.ThrowIfErrors();
    BuildOptions options;
    options.film.filename = "bench.exr";  // never written
    options.quick = options.uniform = true;
    options.integrator = "path";
    options.maxDepth = kMaxDepth;
    options.lightSampler = "bvh";
    Progress progress;
    BuiltScene built = BuildScene(description, options, registry, sink, progress);
    description = {};
    built.integrator = MakePlainIntegrator(built);  // never guided
    built.Prepare(progress);

    const RenderCost render = RenderOnce(built, progress);
    const RayKinds kinds = RayCollector(built).Collect();
    const RTCScene scene = ReplaceCallbacks(built.scene->Acceleration());
    PrintSupport(scene);
    WaveTracer tracer(scene);
    Report(kinds, tracer, render);
}

}  // namespace
}  // namespace pbrt

int main(int argc, char **argv) {
    if (argc < 2) {
        std::fprintf(stderr, "bench_ray_packets scene.pbrt ...\n");
        return 1;
    }
    try {
        for (int i = 1; i < argc; ++i) pbrt::Run(argv[i]);
    } catch (const pbrt::UserError &e) {
        std::fprintf(stderr, "%s", pbrt::FormatAll(e).c_str());
        return 1;
    } catch (const std::exception &e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
