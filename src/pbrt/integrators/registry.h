#pragma once
#include "pbrt/integrators/direction_sampling.h"
#include "pbrt/lightsamplers/registry.h"

namespace pbrt {

struct PluginRegistry : LightSamplerRegistry {
    DirectionSamplings directionSamplings{"direction sampling"};
};

}  // namespace pbrt
