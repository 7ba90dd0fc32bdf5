#include "ext/emission/image_contribution_light_sampler.h"

#include <nlohmann/json.hpp>
#include <numeric>

#include "pbrt/core/effective_params_text.h"
#include "pbrt/core/seconds_since.h"
#include "pbrt/integrators/registry.h"
#include "pbrt/lightsamplers/bvh_light_sampler.h"

namespace ext {

namespace {
constexpr double kMinPaths = 8192, kMaxPaths = 1 << 20;
}

ImageContributionLightSampler::ImageContributionLightSampler(const LightTable &lights,
                                                             const ImageContributionParams &params)
    : GroupLightSampler(params.meshlights ? lights.ByLight() : lights.ByComponent(), true), params_(params) {
    std::vector<Float> power;
    power.reserve(groups_.Size());
    for (uint32_t g = 0; g < groups_.Size(); ++g) power.push_back(groups_.Candidate(g).power);
    if (!power.empty()) table_ = AliasTable(power);
}

void ImageContributionLightSampler::Prepare(PrepareContext &context) {
    if (groups_.Size() <= 1) return;
    const auto start = std::chrono::steady_clock::now();
    const double pixels = context.pixelBounds.IsEmpty() ? 0 : static_cast<double>(context.pixelBounds.Area());
    const double paths =
        std::clamp(static_cast<double>(params_.budget) * context.samplesPerPixel * pixels, kMinPaths, kMaxPaths);
    contributions_ = EstimateImageContributions(context, BVHLightSampler(groups_), paths);
    double found = 0, samples = 0, once = 0, power = 0;
    for (uint32_t g = 0; g < groups_.Size(); ++g) {
        found += contributions_[g].sum;
        samples += contributions_[g].count;
        once += contributions_[g].count == 1;
        groupsSeen_ += contributions_[g].count > 0;
        power += static_cast<double>(groups_.Candidate(g).power);
    }
    if (!(found > 0) || !(power > 0) || !std::isfinite(power)) return;
    missed_ = once / samples;
    std::vector<double> roots(groups_.Size());
    for (uint32_t g = 0; g < groups_.Size(); ++g) {
        const double share = static_cast<double>(groups_.Candidate(g).power) / power;
        roots[g] = std::sqrt(share * ((1 - missed_) * contributions_[g].sum / found + missed_ * share));
    }
    const double sum = std::accumulate(roots.begin(), roots.end(), 0.0);
    if (!(sum > 0)) return;
    const auto floor = static_cast<double>(params_.floor);
    std::vector<Float> weights(groups_.Size());
    for (uint32_t g = 0; g < groups_.Size(); ++g)
        weights[g] = static_cast<Float>((1 - floor) * roots[g] / sum +
                                        floor * static_cast<double>(groups_.Candidate(g).power) / power);
    table_ = AliasTable(weights);
    prepassSeconds_ = SecondsSince(start);
}

std::optional<GroupLightSampler::ChosenGroup> ImageContributionLightSampler::ChooseGroup(const LightQuery &query,
                                                                                         const void *, Float u) const {
    const AliasTable::Sampled s = table_.Sample(u);
    return ChosenGroup{static_cast<uint32_t>(s.index), s.pmf, InnerNumber(query, u)};
}

Float ImageContributionLightSampler::GroupProbability(const LightQuery &, const void *, uint32_t group) const {
    return table_.PMF(static_cast<int>(group));
}

void ImageContributionLightSampler::Report(nlohmann::ordered_json &json) const {
    json["parameters"] = EffectiveParamsText(params_);
    json["prepassSeconds"] = prepassSeconds_;
    json["groupsSeen"] = groupsSeen_;
    json["lightMissed"] = missed_;
    json["bytes"] = table_.Bytes() + contributions_.capacity() * sizeof(ImageContribution);
    GroupLightSampler::Report(json);
}

void ImageContributionLightSampler::Inspect(const LightQuery &, std::vector<InspectedValue> &values) const {
    uint32_t likeliest = 0;
    for (uint32_t g = 1; g < groups_.Size(); ++g)
        if (table_.PMF(static_cast<int>(g)) > table_.PMF(static_cast<int>(likeliest))) likeliest = g;
    values.push_back({"likeliest group", static_cast<double>(likeliest), true});
}

}  // namespace ext

void register_seen(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.samplers.Add<ImageContributionParams>(
        "seen",
        "Chooses lights by power and by their contribution to the image, from a prepass; for `shootingsampler`.",
        [](const ImageContributionParams &p, const ParamSet &, const LightGroups &groups) {
            return std::make_unique<ImageContributionLightSampler>(groups.Lights(), p);
        },
        {.isSameEverywhere = true});
}
