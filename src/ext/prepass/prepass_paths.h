#pragma once
#include <functional>

#include "pbrt/cameras/camera.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/math/rng.h"

namespace ext {
using namespace pbrt;

/// A camera path that a prepass is about to follow, and the random numbers for it.
struct PrepassPath {
    Rng rng;
    SampledWavelengths lambda;
    CameraRay start;
};

/// A prepass goes through the picture in tiles of this many pixels a side.
constexpr int kPrepassTileSize = 16;
int64_t PrepassTileCount(const Bounds2i &pixels);

/// Calls follow(tile, path) for `pathsPerPixel` camera paths through every pixel that will be rendered (a fraction:
/// through that share of the pixels, spread by a hash), from many threads, but one after another within a tile, always
/// in the same order. The paths depend on the seed and `stream` only. One Progress phase; cancelled: some are missing.
void ForEachPrepassPath(PrepareContext &context, const char *phase, uint64_t stream, double pathsPerPixel,
                        const std::function<void(int64_t tile, PrepassPath &path)> &follow);

}  // namespace ext
