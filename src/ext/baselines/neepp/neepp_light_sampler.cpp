#include "ext/baselines/neepp/neepp_light_sampler.h"

#include <nlohmann/json.hpp>

#include "pbrt/core/effective_params_text.h"
#include "pbrt/integrators/registry.h"

namespace ext {

NeeppLightSampler::NeeppLightSampler(const LightTable &lights, const NeeppParams &params)
    : VoxelLightSampler(params.meshlights ? lights.ByLight() : lights.ByComponent()), params_(params),
      map_(params.voxels, params.samples) {}

void NeeppLightSampler::Prepare(PrepareContext &context) {
    if (groups_.Size() <= 1) return;
    map_.Prepare(context, groups_);
    PrepareVoxels(map_.Grid());
}

std::vector<double> NeeppLightSampler::Weights(uint32_t voxel) const {
    const std::span<const uint8_t> row = map_.Row(voxel);
    std::vector<double> weights(groups_.Size());
    for (uint32_t g = 0; g < weights.size(); ++g)
        weights[g] = double(std::max(map_.GroupVisibility(row, g), params_.floor));
    return weights;
}

void NeeppLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParamsText(params_);
    GroupLightSampler::Report(report);
    map_.Report(report);
    report["bytes"] = report["bytes"].get<size_t>() + cdfs_.Bytes();
}

void NeeppLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    Float mean = 0;
    uint32_t voxel = map_.Grid().Index(query.p), seen = 0;
    if (IsPrepared()) {
        std::span<const uint8_t> row = map_.Row(voxel);
        for (uint32_t g = 0; g < groups_.Size(); ++g) {
            Float v = map_.GroupVisibility(row, g);
            mean += v / Float(groups_.Size());
            seen += v > 0;
        }
    }
    values.push_back({"voxel", double(voxel), true});
    values.push_back({"groups with any visibility", double(seen), false});
    values.push_back({"mean visibility of the groups", double(mean), false});
}

std::string NeeppLightSampler::DescribeStructure() const { return IsPrepared() ? map_.Describe() : std::string(); }

}  // namespace ext

void register_neepp(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.Add<NeeppLightSampler, NeeppParams>(
        "neepp", "visibility between voxels (NEE++, Guo et al. 2020); neither power nor distance counts");
}
