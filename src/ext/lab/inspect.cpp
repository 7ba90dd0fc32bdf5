#include "ext/lab/inspect.h"

#include <algorithm>
#include <cmath>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/tile_statistics.h"
#include "pbrt/core/parallel.h"

namespace ext::lab {
namespace {

constexpr uint64_t kPixelStream = 0x696e7370656374ull;
constexpr int kMaxSpecular = 64;
constexpr int kPaths = 16;  ///< per inspected pixel
constexpr int kPathSeed = 700009;
constexpr int kLongestShown = 12;  ///< colour scale limit for path vertices

std::vector<InspectedLight> NamedGroups(const LightGroups &groups, const LightNames &names) {
    std::vector<InspectedLight> lights(groups.Size());
    for (uint32_t g = 0; g < lights.size(); ++g) {
        InspectedLight &light = lights[g];
        light.first = LightId(groups.FirstOf(g));
        light.count = groups.CountOf(g);
        light.power = double(groups.Candidate(g).power) * groups.Lights().Unit();
        light.label = names.NameOf(light.first, light.count);
        if (light.label.empty()) light.label = fmt::format("light {}", light.first.value);
    }
    return lights;
}

/// First hit of a pixel centre's camera ray that is not purely specular; at smooth glass, by the more probable branch.
struct FirstHit {
    PathVertex vertex;
    SampledWavelengths lambda = SampledWavelengths::WholeRange();
    int depth = 0;
};

std::optional<FirstHit> FindFirstHit(const BuiltScene &built, Point2i pixel) {
    FirstHit hit;
    const CameraSample cs{.pFilm = Point2(pixel) + Point2(0.5f, 0.5f), .pLens = {0.5f, 0.5f}, .time = 0.5f};
    std::optional<CameraRay> start = built.camera->GenerateRay(cs, hit.lambda);
    if (!start) return {};
    const PathContext context{*built.scene, *built.camera, built.samplesPerPixel, true};
    PathWalk walk(context, *start);
    while (hit.depth < kMaxSpecular && walk.NextSurface(hit.lambda)) {
        ++hit.depth;
        hit.vertex = walk.Vertex();
        const auto &[point, bsdf] = hit.vertex;
        if (IsNonSpecular(bsdf.Flags())) return hit;
        std::optional<BsdfSample> sample = bsdf.Sample(point.wo, 0.5f, {0.5f, 0.5f});
        if (!sample || !sample->f) return {};
        walk.Scatter(*sample);
    }
    return {};
}

struct Measured {
    double mean = 0;     ///< contribution
    double second = 0;   ///< its part of the one-light estimator's second moment, under the sampler's probabilities
    double visible = 0;  ///< fraction of unoccluded shadow rays; back-facing primitives get none
};

struct GuideLayer {
    const char *name, *meaning;
    double min, max;
};
constexpr GuideLayer kGuideLayers[] = {
    {"continuationProbability", "continuation probability of a path of half its weight; magenta: no estimate", 0.5, 1},
    {"guidingProbability", "part of the bounces whose direction comes from the guide", 0, 1},
    {"sourceRadiance", "learned radiance of source clusters over the greatest, log10; magenta: none", -3, 0}};

/// Sets what the layer's values in the image determine.
void FindRange(int channel, Inspection *out) {
    InspectedLayer &layer = out->layers[channel];
    double sum = 0;
    ForEachPixel(out->image.Resolution(), [&](int x, int y) {
        const auto v = double(out->image.Get({x, y}, channel));
        if (channel > 0 && out->image.Get({x, y}, 0) == 0) return;
        if (!std::isfinite(v)) {
            ++layer.unknown;
            return;
        }
        layer.min = layer.values ? std::min(layer.min, v) : v;
        layer.max = layer.values ? std::max(layer.max, v) : v;
        sum += v;
        ++layer.values;
    });
    layer.mean = layer.values ? sum / double(layer.values) : 0;
    if (layer.name == "brightest" && layer.IsFlat() && layer.values > 0)
        for (const InspectedLight &light : out->lights)
            if (light.first.value == uint32_t(layer.min)) layer.light = light.label;
    if (layer.shownMax <= layer.shownMin) layer.shownMax = layer.max > layer.shownMin ? layer.max : layer.shownMin + 1;
}

class Inspector {
  public:
    Inspector(const BuiltScene &built, const LightSampler &sampler, const Integrator *integrator,
              const InspectSettings &settings, Progress &progress)
        : built_(built), sampler_(sampler), pass_{.camera = *built.camera,
                                                  .filter = *built.filter,
                                                  .film = *built.film,
                                                  .samplers = {},
                                                  .samplesPerPixel = built.samplesPerPixel,
                                                  .keepsSamples = false,
                                                  .progress = progress},
          paths_(dynamic_cast<const PixelIntegrator *>(integrator)),
          guide_(integrator ? integrator->Directions() : nullptr), settings_(settings),
          groups_(built.scene->Lights().ByLight()), lights_(NamedGroups(groups_, built.lightNames)) {
        // Their samples include paths from the lights.
        if (paths_ && paths_->Splats()) paths_ = nullptr;
    }

    Inspection Run() {
        Inspection out;
        for (size_t g = 0; g < groups_.Size(); ++g) shown_.push_back(g);
        std::ranges::stable_sort(shown_, std::ranges::greater(), [&](size_t g) { return lights_[g].power; });
        shown_.resize(std::min(shown_.size(), size_t(std::max(settings_.shownLights, 0))));
        MakeLayers(out);
        out.structure = sampler_.DescribeStructure();
        out.lights = lights_;

        const Bounds2i pixels = built_.film->PixelBounds();
        const Point2i resolution = pixels.high - pixels.low;
        const double perPixel = double(built_.scene->Lights().Size()) + double(groups_.Size()) * settings_.samples;
        while (perPixel * resolution.x * resolution.y / (out.stride * out.stride) > settings_.maxWork) ++out.stride;

        std::vector<std::string> names;
        for (const InspectedLayer &layer : out.layers) names.push_back(layer.name);
        out.image = Image(PixelFormat::Float, resolution, names);
        const int rows = (resolution.y + out.stride - 1) / out.stride;
        Progress &progress = pass_.progress;
        progress.BeginPhase("inspecting", rows);
        ParallelForEach(rows, [&](int64_t row) {
            std::vector<double> values;
            const std::unique_ptr<Sampler> sampler = built_.sampler->WithSeed(kPathSeed);
            const int y0 = int(row) * out.stride;
            for (int x0 = 0; x0 < resolution.x && !progress.Cancelled(); x0 += out.stride) {
                // The block's centre represents it.
                const Point2i pixel = glm::min(Point2i(x0, y0) + out.stride / 2, resolution - 1) + pixels.low;
                std::optional<FirstHit> hit = FindFirstHit(built_, pixel);
                if (!hit) continue;
                values.clear();
                InspectPixel(*hit, pixel, *sampler, values);
                for (int y = y0; y < std::min(y0 + out.stride, resolution.y); ++y)
                    for (int x = x0; x < std::min(x0 + out.stride, resolution.x); ++x)
                        for (size_t c = 0; c < values.size(); ++c) out.image.Set({x, y}, int(c), Float(values[c]));
            }
            progress.Advance();
        });
        progress.EndPhase();

        for (size_t c = 0; c < out.layers.size(); ++c) FindRange(int(c), &out);
        return out;
    }

  private:
    void MakeLayers(Inspection &out) {
        auto add = [&](std::string name, std::string meaning, double min = 0, double max = 0, bool isId = false,
                       bool ofScene = false) {
            out.layers.push_back({std::move(name), std::move(meaning), isId, ofScene, min, max});
        };
        add("hit", "1 where the first visible surface is not purely specular", 0, 1);
        std::vector<InspectedValue> values;
        sampler_.Inspect(LightQuery(), values);
        samplerLayers_ = values.size();
        for (const InspectedValue &v : values)
            add(SafeFileName("sampler." + v.name, "."), "reported by the sampler: " + v.name, 0, 0, v.isId);
        const double bits = std::log2(double(std::max<size_t>(groups_.Size(), 2)));
        add("entropy", "entropy of the probabilities of the lights, in bits; a mesh or environment light counts as one",
            0, bits);
        add("brightest", "the light that contributes most, by its first id; magenta: no light contributes", 0, 0, true,
            true);
        add("brightest_probability", "probability of the light that contributes most; magenta: no light contributes", 0,
            1);
        add("log10_excess",
            "second moment of the one-light estimator over the least that other probabilities of the lights can reach "
            "(the choice inside a mesh unchanged), log10; without MIS; magenta: no light contributes, or a light that "
            "contributes has probability 0",
            0, 2);
        for (size_t g : shown_) {
            const InspectedLight &light = lights_[g];
            add(fmt::format("visibility.{}", light.first.value),
                fmt::format("share of up to {} shadow rays that arrive from {}", settings_.samples, light.label), 0, 1,
                false, true);
            out.layers.back().light = light.label;
        }
        if (paths_)
            add("path.vertices", fmt::format("mean number of vertices where light is scattered, of {} paths", kPaths),
                0, std::clamp(built_.maxDepth, 1, kLongestShown));
        if (!guide_) return;
        values.clear();
        guide_->Inspect(PathVertex(), {}, values);
        for (const InspectedValue &v : values) {
            const GuideLayer *layer = std::ranges::find(kGuideLayers, v.name, &GuideLayer::name);
            PBRT_CHECK(layer != std::end(kGuideLayers));
            add("guide." + v.name, layer->meaning, layer->min, layer->max);
        }
    }

    /// Mean number of vertices, excluding the camera's.
    double PathLength(Point2i pixel, Sampler &sampler) const {
        const uint64_t before = ThreadCounters().pathVertices;
        for (int i = 0; i < kPaths; ++i) {
            sampler.StartPixelSample(pixel, i);
            SampledWavelengths lambda = built_.film->SampleWavelengths(sampler.Get1D());
            CameraSample cs;
            cs.pFilm = Point2(pixel) + sampler.GetPixel2D();
            cs.time = sampler.Get1D();
            cs.pLens = sampler.Get2D();
            if (const std::optional<CameraRay> ray = built_.camera->GenerateRay(cs, lambda)) {
                // Beyond all samples used for learning.
                const PathStart start{{*ray, pixel, std::numeric_limits<int>::max() - kPaths + i}, pass_};
                paths_->Li(start, lambda, sampler);
            }
        }
        return double(ThreadCounters().pathVertices - before) / kPaths;
    }

    Measured Measure(const FirstHit &hit, const LightSampleContext &from, uint32_t group, Rng &rng,
                     std::span<const Float> pmf) const {
        const Scene &scene = *built_.scene;
        Measured m;
        int traced = 0;
        const double shift[3] = {double(rng.Uniform()), double(rng.Uniform()), double(rng.Uniform())};
        for (int i = 0; i < settings_.samples; ++i) {
            // Additive recurrence: evenly distributed for any number of samples.
            auto at = [&](int dimension, double step) {
                double v = shift[dimension] + i * step;
                return std::min(Float(v - std::floor(v)), OneMinusEpsilon);
            };
            const LightId light = groups_.SampleLight(group, at(0, 0.5497004779019703));
            const auto share = double(groups_.ShareOf(light));
            std::optional<LightLiSample> s = scene.Lights()[light].SampleLi(
                from, {at(1, 0.8191725133961645), at(2, 0.6710436067037893)}, hit.lambda, true);
            if (!s || !s->L || !(s->pdf > 0)) continue;
            ++traced;
            if (scene.Occluded(from, *s)) continue;
            ++m.visible;
            SampledSpectrum f =
                hit.vertex.bsdf.F(hit.vertex.point.wo, s->wi) * AbsDot(s->wi, hit.vertex.point.shading.n);
            double value = double(SafeDivide(s->L * f, hit.lambda.Pdf()).Average()) / (share * double(s->pdf));
            if (!(value > 0)) continue;
            m.mean += value;
            const auto chosen = double(pmf[light.value]);
            m.second += chosen > 0 ? value * value * share / chosen : std::numeric_limits<double>::infinity();
        }
        const double n = settings_.samples;
        return {m.mean / n, m.second / n, m.visible / std::max(traced, 1)};
    }

    void InspectPixel(const FirstHit &hit, Point2i pixel, Sampler &sampler, std::vector<double> &values) const {
        const LightQuery query = LightQueryAt(hit.vertex, hit.lambda, hit.depth);
        const LightSampleContext from = LightContextAt(hit.vertex.point);
        values.push_back(1);

        std::vector<InspectedValue> own;
        sampler_.Inspect(query, own);
        PBRT_CHECK(own.size() == samplerLayers_);
        for (const InspectedValue &v : own) values.push_back(v.value);

        std::vector<Float> pmf(built_.scene->Lights().Size());
        LightMemory memory;
        const LightDistribution lights = sampler_.At(query, memory);
        for (size_t l = 0; l < pmf.size(); ++l) pmf[l] = lights.PMF(LightId(l));

        double entropy = 0, greatest = 0, probability = 0, second = 0, root = 0;
        const InspectedLight *brightest = nullptr;
        std::vector<double> visible(groups_.Size());
        Rng rng(Hash(kPixelStream, pixel));
        for (uint32_t g = 0; g < groups_.Size(); ++g) {
            const InspectedLight &light = lights_[g];
            double p = 0;
            for (size_t l = light.first.value; l < light.first.value + light.count; ++l) p += double(pmf[l]);
            if (p > 0) entropy -= p * std::log2(p);
            Measured m = Measure(hit, from, g, rng, pmf);
            visible[g] = m.visible;
            second += m.second;
            // If the group were always selected, its second moment would be second * p.
            root += std::sqrt(m.second * p);
            if (m.mean > greatest) {
                greatest = m.mean;
                brightest = &lights_[g];
                probability = p;
            }
        }
        const double none = std::numeric_limits<double>::quiet_NaN();
        values.push_back(std::max(entropy, 0.0));
        values.push_back(brightest ? double(brightest->first.value) : none);
        values.push_back(brightest ? probability : none);
        values.push_back(brightest ? std::log10(second / (root * root)) : none);
        for (size_t g : shown_) values.push_back(visible[g]);
        if (paths_) values.push_back(PathLength(pixel, sampler));
        own.clear();
        if (guide_) guide_->Inspect(hit.vertex, pixel, own);
        for (const InspectedValue &v : own) values.push_back(v.value);
    }

    const BuiltScene &built_;
    const LightSampler &sampler_;
    const RenderPass pass_;           ///< of the traced paths
    const PixelIntegrator *paths_;    ///< null: path lengths are not shown
    const DirectionSampling *guide_;  ///< may be null
    const InspectSettings &settings_;
    const LightGroups &groups_;
    std::vector<InspectedLight> lights_;  ///< per group
    std::vector<size_t> shown_;           ///< groups with visibility layers, in order of power
    size_t samplerLayers_ = 0;
};

}  // namespace

Inspection InspectLights(const BuiltScene &built, const LightSampler &sampler, const Integrator *integrator,
                         const InspectSettings &settings, Progress &progress) {
    return Inspector(built, sampler, integrator, settings, progress).Run();
}

}  // namespace ext::lab
