#pragma once
#include <vector>

#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/scene/scene.h"

namespace ext {
using namespace pbrt;

/// A place where a path of the render would do next-event estimation.
struct PrepassVertex {
    LightSampleContext at;                    ///< position, error bounds, normals
    Vector3 wo{};                             ///< unit, towards the previous vertex
    bool transmits = false;                   ///< light from the other side counts too
    MediumId inside{}, outside{};             ///< behind the surface and before it; in a medium both are that medium
    const HenyeyGreenstein *phase = nullptr;  ///< in a medium
};

/// The query that a render would make at the vertex, but without the BSDF.
LightQuery QueryAt(const PrepassVertex &vertex);

/// The paper's path pass (section 4.1): `samplesPerPixel` camera paths through every pixel that will be rendered (a
/// fraction: through that share of the pixels, spread by a hash), at most `depth` vertices each, continued by BSDF
/// sampling without light sampling or roulette. Vertices with only specular scattering are passed but not recorded: no
/// light is ever sampled there. Order and content depend on the seed only, not on threads. One Progress phase,
/// "prepass".
std::vector<PrepassVertex> TracePrepassPaths(PrepareContext &context, double samplesPerPixel, int depth);

/// The paper's Eq. 5 for one light: Le G V / p at a light point drawn with `u`, over LightTable::Unit(). Le is that of
/// SampledWavelengths::WholeRange(). 0 if the surface is opaque and the light arrives on the side that is not seen. In
/// a medium there is no cosine, and V includes the transmittance of media between the points, by ratio tracking.
double VisibleContribution(const Scene &scene, const PrepassVertex &vertex, const LightComponent &light,
                           const Point2 &u);

}  // namespace ext
