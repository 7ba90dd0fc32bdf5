#include "ext/neepp/neepp_light_sampler.h"

#include "ext/voxels/fixed_cdf.h"

namespace ext {

NeeppLightSampler::NeeppLightSampler(const LightTable &lights, const NeeppParams &params)
    : params_(params), groups_(lights, params.meshlights), map_(params.map) {}

void NeeppLightSampler::Prepare(PrepareContext &context) {
    if (groups_.Size() <= 1) return;
    map_.Prepare(context, groups_);
    cdfs_.Reset(map_.Grid().Size(), groups_.Size());
    prepared_ = true;
}

std::span<const uint32_t> NeeppLightSampler::Cdf(const Point3 &p) const {
    uint32_t voxel = map_.Grid().Index(p);
    return cdfs_.Get(voxel, [&](std::span<uint32_t> begins) {
        std::span<const uint8_t> row = map_.Row(voxel);
        std::vector<double> weights(groups_.Size());
        for (uint32_t g = 0; g < weights.size(); ++g)
            weights[g] = static_cast<double>(std::max(map_.GroupVisibility(row, g), params_.floor));
        BuildFixedCdf(weights, begins);
    });
}

std::optional<SampledLight> NeeppLightSampler::Sample(const LightQuery &query, Float u) const {
    const size_t count = groups_.Size();
    if (count == 0) return {};
    uint32_t group = 0;
    Float pmf = 1, begin = 0;
    if (prepared_) {
        std::span<const uint32_t> cdf = Cdf(query.p);
        group = SampleFixedCdf(cdf, u, query.p);
        pmf = FixedCdfPMF(cdf, group);
        begin = FixedCdfBegin(cdf, group);
    } else if (count > 1) {
        pmf = 1 / static_cast<Float>(count);
        auto i = static_cast<size_t>(static_cast<double>(u) * static_cast<double>(count));
        group = static_cast<uint32_t>(std::min(i, count - 1));
        begin = static_cast<Float>(group) * pmf;
    }
    LightId light = groups_.SampleLight(group, MeshGroups::InnerNumber(u, query.p, begin, pmf));
    return SampledLight{light, pmf * groups_.ShareOf(light)};
}

Float NeeppLightSampler::PMF(const LightQuery &query, LightId light) const {
    Float pmf = 1;
    if (prepared_)
        pmf = FixedCdfPMF(Cdf(query.p), groups_.GroupOf(light));
    else if (groups_.Size() > 1)
        pmf = 1 / static_cast<Float>(groups_.Size());
    return pmf * groups_.ShareOf(light);
}

void NeeppLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParams(params_).dump();
    report["groups"] = groups_.Size();
    report["lights"] = groups_.LightCount();
    map_.Report(report);
    report["bytes"] = report["bytes"].get<size_t>() + cdfs_.Bytes();
}

void NeeppLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    Float mean = 0;
    uint32_t voxel = map_.Grid().Index(query.p), seen = 0;
    if (prepared_) {
        std::span<const uint8_t> row = map_.Row(voxel);
        for (uint32_t g = 0; g < groups_.Size(); ++g) {
            Float v = map_.GroupVisibility(row, g);
            mean += v / static_cast<Float>(groups_.Size());
            seen += v > 0;
        }
    }
    values.push_back({"voxel", static_cast<double>(voxel), true});
    values.push_back({"groups with any visibility", static_cast<double>(seen), false});
    values.push_back({"mean visibility of the groups", static_cast<double>(mean), false});
}

std::string NeeppLightSampler::DescribeStructure() const { return prepared_ ? map_.Describe() : std::string(); }

}  // namespace ext
