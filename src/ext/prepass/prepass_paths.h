#pragma once
#include <functional>

#include "pbrt/cameras/camera.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/math/rng.h"

namespace ext {
using namespace pbrt;

struct PrepassPath {
    Rng rng;
    SampledWavelengths lambda;
    CameraRay start;
};

/// Side of a prepass tile in pixels.
constexpr int kPrepassTileSize = 16;
int64_t PrepassTileCount(const Bounds2i &pixels);

/// Calls follow(tile, path) for `pathsPerPixel` camera paths per rendered pixel (fractional: in a hashed subset of
/// pixels). Tiles run concurrently; paths within a tile run in fixed order. Paths depend on the seed and `stream` only.
/// One Progress phase; incomplete if cancelled.
void ForEachPrepassPath(PrepareContext &context, const char *phase, uint64_t stream, double pathsPerPixel,
                        const std::function<void(int64_t tile, PrepassPath &path)> &follow);

}  // namespace ext
