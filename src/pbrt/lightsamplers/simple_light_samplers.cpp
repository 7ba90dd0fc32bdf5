#include "pbrt/lightsamplers/simple_light_samplers.h"

#include <nlohmann/json.hpp>

namespace pbrt {

std::unique_ptr<LightSampler> ByPowerUnless(std::unique_ptr<LightSampler> chosen, const LightTable &lights) {
    return chosen ? std::move(chosen) : std::make_unique<PowerLightSampler>(lights.ByComponent());
}

void PowerLightSampler::Report(nlohmann::ordered_json &json) const {
    json["bytes"] = table_.Bytes();
    GroupLightSampler::Report(json);
}

}  // namespace pbrt
