#pragma once
#include "pbrt/integrators/direction_sampling.h"
#include "pbrt/lightsamplers/registry.h"

namespace pbrt {

/// Everything that plugins can add.
struct PluginRegistry : LightSamplerRegistry {
    DirectionSamplings directionSamplings{"direction sampling"};
};

}  // namespace pbrt
