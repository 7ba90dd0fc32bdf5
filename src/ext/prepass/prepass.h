#pragma once
#include <functional>
#include <vector>

#include "pbrt/cameras/camera.h"
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/math/rng.h"
#include "pbrt/scene/scene.h"

namespace ext {
using namespace pbrt;

/// A vertex where a render path would perform next-event estimation.
struct PrepassVertex {
    LightSampleContext at;                    ///< position, error bounds, normals
    Vector3 wo{};                             ///< unit, towards the previous vertex
    bool transmits = false;                   ///< scatters light from the other side as well
    MediumId inside{}, outside{};             ///< behind and in front of the surface; equal in a medium
    const HenyeyGreenstein *phase = nullptr;  ///< in a medium
};

LightQuery QueryAt(const PrepassVertex &vertex);  ///< the render's query at the vertex, without BSDF

/// The paper's path pass (section 4.1): `samplesPerPixel` camera paths per rendered pixel (fractional: in a hashed
/// subset of pixels), at most `depth` vertices each. Continued by BSDF sampling without light sampling or roulette.
/// Purely specular vertices are traversed but not recorded, as lights are never sampled there. Order and content depend
/// on the seed only, not on threads. One Progress phase, "prepass".
std::vector<PrepassVertex> TracePrepassPaths(PrepareContext &context, double samplesPerPixel, int depth);

/// The paper's Eq. 5 for one light: Le G V / p at a light point sampled with `u`, relative to LightTable::Unit(). Le is
/// at SampledWavelengths::WholeRange(). 0 if the surface is opaque and the light is behind it. In a medium there is no
/// cosine, and V includes transmittance, by ratio tracking.
double VisibleContribution(const Scene &scene, const PrepassVertex &vertex, const LightComponent &light,
                           const Point2 &u);

/// Start of a path: camera ray, and what its continuation uses and changes. Belongs to one call of `follow`.
struct PrepassPath {
    Rng rng;  ///< after the numbers of the camera ray
    SampledWavelengths lambda;
    CameraRay start;
};

constexpr int kPrepassTileSize = 16;               ///< side of a prepass tile in pixels
int64_t PrepassTileCount(const Bounds2i &pixels);  ///< number of tiles that cover the pixels

/// Calls follow(tile, path) for `pathsPerPixel` camera paths per rendered pixel (fractional: in a hashed subset of
/// pixels). Tiles run concurrently; paths within a tile run in fixed order. Paths depend on the seed and `stream` only.
/// One Progress phase; incomplete if cancelled.
void ForEachPrepassPath(PrepareContext &context, const char *phase, uint64_t stream, double pathsPerPixel,
                        const std::function<void(int64_t tile, PrepassPath &path)> &follow);

}  // namespace ext
