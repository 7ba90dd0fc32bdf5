#pragma once
#include "pbrt/integrators/direction_sampling.h"
#include "pbrt/lightsamplers/registry.h"

namespace pbrt {

/// Everything that plugins register: light samplers and direction sampling.
struct PluginRegistry : LightSamplerRegistry {
    DirectionSamplings directionSamplings{"direction sampling"};
};

}  // namespace pbrt
