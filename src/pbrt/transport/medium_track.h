#pragma once
#include "pbrt/media/tracking.h"

namespace pbrt {

/// Spectral throughput of a path through media. Distances are sampled with the coefficients of the first wavelength;
/// the path could equally have been sampled with another wavelength's, or its end by light sampling. `ru` and `rl` are
/// these densities relative to the one used. A contribution is divided by the mean over wavelengths of ru, or of ru +
/// rl: the balance heuristic over all sampling strategies (Miller, Georgiev and Jarosz 2019, A null-scattering path
/// integral formulation of light transport, sections 5, 6).
///
/// This requires every wavelength to be first equally often. After termination of the secondary wavelengths
/// (dispersion) only the first one's densities count; stock pbrt-v4 continues with the mean over all, which is biased.
struct SpectralWeights {
    SampledSpectrum beta{1};  ///< throughput over the density used
    SampledSpectrum ru{1};    ///< unidirectional sampling
    SampledSpectrum rl{1};    ///< last vertex sampled on a light
    bool onlyFirst = false;   ///< secondary wavelengths were terminated

    void Multiply(const SampledSpectrum &f) {
        beta *= f;
        ru *= f;
        rl *= f;
    }
    /// Updates rl for a sampled scattering direction (density by solid angle) that light sampling could replace.
    void SampledDirection(Float pdf) { rl = ru / pdf; }
    /// From here on, only the first wavelength could have sampled the path.
    void EndSecondary() {
        for (int i = 1; i < SpectrumSamples; ++i) beta[i] = ru[i] = rl[i] = 0;
    }
    Float Mean(const SampledSpectrum &densities) const { return onlyFirst ? densities[0] : densities.Average(); }
};

struct MediumEvent {
    enum class Kind { Passed, Scattered, Absorbed } kind = Kind::Passed;
    Float t = 0;  ///< distance of the scattering event
};

/// Delta tracking along a ray through a medium; updates the path's weights. `emits`: calls emit(radiance, mean) for
/// emission on the way, divided by `mean`, the mean of its densities. `u`: uniform, for the first distance; `rng` for
/// the rest.
MediumEvent TrackMedium(MediumOnRay on, Float u, Rng &rng, bool emits, SpectralWeights &weights, auto &&emit) {
    MediumEvent event;
    const SampledSpectrum rest = ForEachCollision(
        on, u, rng,
        [&](Float t, const MediumCoefficients &c, const SampledSpectrum &majorant, const SampledSpectrum &tMaj) {
            if (emits && c.emission) {
                const Float pdf = majorant[0] * tMaj[0];
                const SampledSpectrum ru = weights.ru * majorant * tMaj / pdf;
                const Float mean = weights.Mean(ru);
                emit(weights.beta * tMaj * c.absorption * c.emission / (pdf * mean), mean);
            }
            const Float what = rng.Uniform() * majorant[0];
            if (what < c.absorption[0]) {
                event.kind = MediumEvent::Kind::Absorbed;
                return false;
            }
            if (what < c.absorption[0] + c.scattering[0]) {
                const SampledSpectrum f = tMaj * c.scattering / (tMaj[0] * c.scattering[0]);
                weights.beta *= f;
                weights.ru *= f;
                event = {MediumEvent::Kind::Scattered, t};
                return false;
            }
            const SampledSpectrum null = ClampZero(majorant - c.absorption - c.scattering);
            const Float pdf = tMaj[0] * null[0];
            if (!(pdf > 0)) {
                event.kind = MediumEvent::Kind::Absorbed;
                return false;
            }
            weights.beta *= tMaj * null / pdf;
            weights.ru *= tMaj * null / pdf;
            weights.rl *= tMaj * majorant / pdf;
            return true;
        });
    if (event.kind != MediumEvent::Kind::Passed) return event;
    if (!(rest[0] > 0)) event.kind = MediumEvent::Kind::Absorbed;
    else weights.Multiply(rest / rest[0]);
    return event;
}

}  // namespace pbrt
