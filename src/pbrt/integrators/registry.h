#pragma once
#include "pbrt/integrators/direction_sampling.h"
#include "pbrt/lightsamplers/registry.h"

namespace pbrt {

/// All that plugins add: light samplers, and what chooses directions of paths.
struct PluginRegistry : LightSamplerRegistry {
    DirectionSamplings directionSamplings{"direction sampling"};
};

}  // namespace pbrt
