#pragma once
#include <vector>

#include "pbrt/integrators/registry.h"
#include "pbrt/lightsamplers/group_light_sampler.h"

/// Chooses lights by the inverse square of their distance; those at infinity count as if they were one unit away.
class NearestLightSampler final : public pbrt::GroupLightSampler {
  public:
    explicit NearestLightSampler(const pbrt::LightGroups &groups);

    const void *WeighGroups(const pbrt::LightQuery &query, pbrt::LightMemory &memory) const override;
    std::optional<ChosenGroup> ChooseGroup(const pbrt::LightQuery &query, const void *weights,
                                           pbrt::Float u) const override;
    pbrt::Float GroupProbability(const pbrt::LightQuery &query, const void *weights, uint32_t group) const override;

  private:
    struct Place {
        pbrt::Point3 center{};
        pbrt::Float radius = 0;
        bool isFar = false, isDark = false;
    };
    std::vector<Place> places_;  ///< per group
};

void register_nearest(pbrt::PluginRegistry &registry);
