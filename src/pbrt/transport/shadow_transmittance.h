#pragma once
#include "pbrt/math/rng.h"
#include "pbrt/scene/scene.h"

namespace pbrt {

/// What arrives of the light on a segment, and how it was estimated; see SpectralWeights.
struct ShadowTransmittance {
    SampledSpectrum value{0};  ///< 0: blocked
    SampledSpectrum ru{1}, rl{1};
};

/// Estimates how much light passes from a point on a light to a vertex, through media and the interfaces between them:
/// 0 behind a surface that scatters, else by ratio tracking, with Russian roulette where hardly anything is left.
/// `medium`: the one at the vertex, on the light's side.
ShadowTransmittance TraceShadow(const Scene &scene, const LightSampleContext &from, MediumId medium,
                                const LightLiSample &to, const SampledWavelengths &lambda, Rng &rng);

}  // namespace pbrt
