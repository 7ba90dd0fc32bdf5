#pragma once
#include "pbrt/math/rng.h"
#include "pbrt/scene/scene.h"

namespace pbrt {

/// Transmittance of a shadow segment with its sampling densities; see SpectralWeights.
struct ShadowTransmittance {
    SampledSpectrum value{0};  ///< 0: occluded
    SampledSpectrum ru{1}, rl{1};
};

/// Estimates the transmittance between a light sample and a vertex, through media and interfaces: 0 behind a scattering
/// surface, else by ratio tracking, with Russian roulette at low transmittance. `medium`: at the vertex, on the light's
/// side.
ShadowTransmittance TraceShadow(const Scene &scene, const LightSampleContext &from, MediumId medium,
                                const LightLiSample &to, const SampledWavelengths &lambda, Rng &rng);

}  // namespace pbrt
