#include "ext/emission/image_contribution_light_sampler.h"

#include <nlohmann/json.hpp>
#include <numeric>

#include "ext/prepass/prepass.h"
#include "pbrt/core/effective_params_text.h"
#include "pbrt/integrators/registry.h"
#include "pbrt/lightsamplers/bvh_light_sampler.h"
#include "pbrt/math/warps.h"
#include "pbrt/transport/direct_light.h"
#include "pbrt/transport/path_walk.h"

namespace ext {
namespace {

constexpr uint64_t kStream = 0x7365656eull;  ///< decorrelates this prepass from other uses of the seed
constexpr int kMaxDepth = 8;                 ///< maximum vertices per path, regardless of the render's maximum
constexpr double kLargest = 100;             ///< outlier limit of a contribution, relative to the mean
constexpr double kPlain = 0.1;               ///< added to a tile's relative mean before weighting by its inverse square
constexpr double kMinPaths = 8192, kMaxPaths = 1 << 20;  ///< limits of the number of paths

struct Sample {
    uint32_t group;
    double value;
};

/// A camera path with next-event estimation that records its contributions by the group of the light.
class ContributionPath {
  public:
    ContributionPath(const PathContext &context, const GroupLightSampler &chooser, PrepassPath &path,
                     std::vector<Sample> &samples)
        : scene_(context.scene), chooser_(chooser), samples_(samples), rng_(path.rng), lambda_(path.lambda),
          walk_(context, path.start) {}

    void Follow(int maxDepth) {
        const auto track = [&] { return walk_.ThroughMedium(lambda_, rng_, weights_); };
        const auto arrive = [&](PathWalk::Met met) {
            if (anyNonSpecular_) AddEmission(met);
        };
        for (int depth = 1;; ++depth) {
            const std::optional<ReachedVertex> reached = walk_.NextVertex(lambda_, weights_, track, arrive);
            if (!reached || depth > maxDepth) return;
            if (reached->phase) ScatterInMedium(*reached->phase, reached->p, depth);
            else if (!ScatterAtSurface(depth)) return;
        }
    }

  private:
    void AddEmission(PathWalk::Met met) {
        walk_.ForEachEmission(lambda_, [&](const SampledSpectrum &Le, LightId id, const Point3 &p, const Normal3 &n) {
            const bool isInfinite = met == PathWalk::Met::Nothing;
            const Float pLight = pdf_ > 0 ? last_.LightPdf(scene_.Lights(), id, isInfinite, walk_.GetRay().d, p, n) : 0;
            Add(weights_.beta * Le * EmissionWeight(pdf_, pLight), id, weights_.ru);
        });
    }

    void ScatterInMedium(const HenyeyGreenstein &phase, const Point3 &p, int depth) {
        const Ray &ray = walk_.GetRay();
        const Vector3 wo = -ray.d;
        last_.Prepare(chooser_, LightQueryInMedium(p, wo, ray.medium, phase, ray.time, lambda_, depth),
                      {p, {}, {}, {}, ray.time});
        SampleLight(
            last_.from,
            [&](const Vector3 &wi) {
                return Scattering{SampledSpectrum(phase.P(wo, wi)), 1};
            },
            [&](const Vector3 &wi) { return phase.P(wo, wi); }, [&](const Vector3 &) { return ray.medium; });
        const HenyeyGreenstein::Sample sample = phase.SampleP(wo, rng_.Uniform2());
        pdf_ = sample.p;
        anyNonSpecular_ = true;
        walk_.ScatterInMedium(p, sample.wi);
    }

    /// Returns false if the path ends.
    bool ScatterAtSurface(int depth) {
        const auto &[point, bsdf] = walk_.Vertex();
        if (IsNonSpecular(bsdf.Flags())) {
            last_.Prepare(chooser_, walk_.Vertex(), lambda_, depth);
            SampleLight(
                ScatteringContextAt(scene_, point, bsdf),
                [&](const Vector3 &wi) {
                    return Scattering{bsdf.F(point.wo, wi), AbsDot(wi, point.shading.n)};
                },
                [&](const Vector3 &wi) { return bsdf.Pdf(point.wo, wi); },
                [&](const Vector3 &wi) { return point.MediumTowards(wi); });
        }
        const std::optional<BsdfSample> sample = walk_.SampleScattering(rng_);
        if (!sample) return false;
        weights_.beta *= sample->f * (AbsDot(sample->wi, point.shading.n) / sample->pdf);
        if (!weights_.beta) return false;
        pdf_ = IsSpecular(sample->flags) ? 0 : sample->pdfIsProportional ? bsdf.Pdf(point.wo, sample->wi) : sample->pdf;
        anyNonSpecular_ = anyNonSpecular_ || pdf_ > 0;
        return depth == 1 || !EndsByRoulette(weights_.beta.MaxComponent(), rng_, weights_.beta);
    }

    /// `densities`: as SpectralWeights::ru.
    void Add(const SampledSpectrum &L, LightId light, const SampledSpectrum &densities) {
        const double value = double(SafeDivide(L, lambda_.Pdf()).Average()) / double(densities.Average());
        if (value > 0 && std::isfinite(value)) samples_.push_back({chooser_.Groups().GroupOf(light), value});
    }

    /// `pdf(wi)`: scattering density of a direction (solid angle).
    template <class Scatter, class Pdf, class MediumTowards>
    void SampleLight(const LightSampleContext &at, Scatter &&scatter, Pdf &&pdf, MediumTowards &&mediumTowards) {
        const Float u = rng_.Uniform();
        const auto trace = [&](const LightLiSample &to, const Point2 &) {
            return scene_.HasMedia() ? TraceShadow(scene_, last_.from, mediumTowards(to.wi), to, lambda_, rng_)
                                     : TraceShadowRay(scene_, last_.from, to);
        };
        ObservedPath unobserved;
        const std::optional<DirectLight> light = SampleDirectLight(scene_.Lights(), last_.lights, at, lambda_, true, u,
                                                                   rng_.Uniform2(), unobserved, scatter, trace);
        if (!light) return;
        SampledSpectrum L = weights_.beta * light->F() * light->sample.L / light->Pdf() * light->through.value;
        if (!light->isDelta) L *= PowerHeuristic(light->Pdf(), pdf(light->sample.wi));
        Add(L, light->chosen.light, weights_.ru * light->through.rl);
    }

    const Scene &scene_;
    const GroupLightSampler &chooser_;
    std::vector<Sample> &samples_;
    Rng &rng_;
    SampledWavelengths &lambda_;
    PathWalk walk_;
    SpectralWeights weights_;
    VertexSelection last_;  ///< of the last non-specular vertex
    /// Density of the direction that left it (solid angle); 0: the last vertex was left by a specular sample.
    Float pdf_ = 0;
    bool anyNonSpecular_ = false;
};

/// Traces about `paths` camera paths, spread over the rendered pixels, and sums the contributions of every group of
/// `chooser`. Light sampling (with `chooser`) and BSDF sampling are combined by the power heuristic. Contributions are
/// clamped to a hundred times their mean. Directly visible or purely specular light is excluded, as no light path
/// carries it. Depends on the seed only, not on threads. One Progress phase.
std::vector<ImageContribution> EstimateImageContributions(PrepareContext &context, const GroupLightSampler &chooser,
                                                          double paths) {
    struct Tile {
        std::vector<Sample> samples;
        int64_t paths = 0;
        double sum = 0;
    };
    std::vector<Tile> perTile(PrepassTileCount(context.pixelBounds));
    const PathContext walks{context.scene, context.camera, context.samplesPerPixel, context.scene.NeedsFootprints()};
    const int maxDepth = std::min(context.maxDepth, kMaxDepth);
    const double pathsPerPixel = perTile.empty() ? 0 : paths / double(context.pixelBounds.Area());
    ForEachPrepassPath(context, "image contributions", kStream, pathsPerPixel, [&](int64_t tile, PrepassPath &path) {
        Tile &to = perTile[tile];
        ContributionPath(walks, chooser, path, to.samples).Follow(maxDepth);
        ++to.paths;
    });
    double sum = 0, count = 0, all = 0;
    for (Tile &t : perTile) {
        for (const Sample &f : t.samples) t.sum += f.value;
        sum += t.sum;
        count += double(t.samples.size());
        all += double(t.paths);
    }
    std::vector<ImageContribution> result(chooser.Groups().Size());
    if (sum > 0)
        for (const Tile &t : perTile) {
            const double largest = kLargest * sum / count;
            const double brightness = t.sum / std::max(1.0, double(t.paths)) / (sum / all) + kPlain;
            for (const Sample &f : t.samples) {
                result[f.group].sum += std::min(f.value, largest) / (brightness * brightness);
                ++result[f.group].count;
            }
        }
    return result;
}

}  // namespace

ImageContributionLightSampler::ImageContributionLightSampler(const LightTable &lights,
                                                             const ImageContributionParams &params)
    : PowerLightSampler(params.meshlights ? lights.ByLight() : lights.ByComponent()), params_(params) {}

void ImageContributionLightSampler::Prepare(PrepareContext &context) {
    table_ = TableByPower(groups_);
    contributions_.clear();
    missed_ = 1;
    prepassSeconds_ = 0;
    contributingGroups_ = 0;
    if (groups_.Size() <= 1) return;
    const auto start = std::chrono::steady_clock::now();
    const double pixels = context.pixelBounds.IsEmpty() ? 0 : double(context.pixelBounds.Area());
    const double paths = std::clamp(double(params_.budget) * context.samplesPerPixel * pixels, kMinPaths, kMaxPaths);
    contributions_ = EstimateImageContributions(context, BVHLightSampler(groups_), paths);
    auto powerOf = [&](uint32_t g) { return double(groups_.Lights().PowerTowardsReceivers(groups_.Candidate(g))); };
    double contribution = 0, samples = 0, once = 0, power = 0;
    for (uint32_t g = 0; g < groups_.Size(); ++g) {
        contribution += contributions_[g].sum;
        samples += contributions_[g].count;
        once += contributions_[g].count == 1;
        contributingGroups_ += contributions_[g].count > 0;
        power += powerOf(g);
    }
    if (!(contribution > 0) || !(power > 0) || !std::isfinite(power)) return;
    missed_ = once / samples;
    std::vector<double> roots(groups_.Size());
    for (uint32_t g = 0; g < groups_.Size(); ++g) {
        const double share = powerOf(g) / power;
        roots[g] = std::sqrt(share * ((1 - missed_) * contributions_[g].sum / contribution + missed_ * share));
    }
    const double sum = std::accumulate(roots.begin(), roots.end(), 0.0);
    if (!(sum > 0)) return;
    const auto floor = double(params_.floor);
    std::vector<Float> weights(groups_.Size());
    for (uint32_t g = 0; g < groups_.Size(); ++g)
        weights[g] = Float((1 - floor) * roots[g] / sum + floor * powerOf(g) / power);
    table_ = AliasTable(weights);
    prepassSeconds_ = SecondsSince(start);
}

void ImageContributionLightSampler::Report(nlohmann::ordered_json &json) const {
    json["parameters"] = EffectiveParamsText(params_);
    json["prepassSeconds"] = prepassSeconds_;
    json["contributingGroups"] = contributingGroups_;
    json["missedContribution"] = missed_;
    json["bytes"] = table_.Bytes() + contributions_.capacity() * sizeof(ImageContribution);
    GroupLightSampler::Report(json);
}

void ImageContributionLightSampler::Inspect(const LightQuery &, std::vector<InspectedValue> &values) const {
    uint32_t likeliest = 0;
    for (uint32_t g = 1; g < groups_.Size(); ++g)
        if (table_.PMF(int(g)) > table_.PMF(int(likeliest))) likeliest = g;
    values.push_back({"likeliest group", double(likeliest), true});
}

}  // namespace ext

void register_seen(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.Add<ImageContributionLightSampler, ImageContributionParams>(
        "seen",
        "Chooses lights by power and by their contribution to the image, from a prepass; for `shootingsampler`.",
        {.isSameEverywhere = true});
}
