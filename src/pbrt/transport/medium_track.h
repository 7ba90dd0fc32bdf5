#pragma once
#include "pbrt/media/tracking.h"

namespace pbrt {

/// The throughput of a path through media, for each of its wavelengths. A place in a medium is sampled by the
/// coefficients of the first wavelength, so the path could as well have been sampled by those of another one, or its
/// end by light sampling; `ru` and `rl` are these densities over the one that was used, and a contribution of the path
/// is divided by the mean of ru, or of ru + rl, over the wavelengths: the balance heuristic over all ways to sample it
/// (Miller, Georgiev and Jarosz 2019, A null-scattering path integral formulation of light transport, sections 5, 6).
///
/// That needs every wavelength to be the first one equally often. Once the others were terminated (dispersion), only
/// the first one's own densities count; stock pbrt-v4 continues with the mean of all, which is biased.
struct SpectralWeights {
    SampledSpectrum beta{1};  ///< throughput over the density used
    SampledSpectrum ru{1};    ///< path sampled step by step
    SampledSpectrum rl{1};    ///< its last vertex sampled as a point on a light
    bool onlyFirst = false;   ///< the other wavelengths were terminated

    void Multiply(const SampledSpectrum &f) {
        beta *= f;
        ru *= f;
        rl *= f;
    }
    /// After a direction was drawn with this density (solid angle) by scattering that light sampling could replace.
    void SampledDirection(Float pdf) { rl = ru / pdf; }
    Float Mean(const SampledSpectrum &densities) const { return onlyFirst ? densities[0] : densities.Average(); }
};

/// What happens to light on its way through a medium.
struct MediumEvent {
    enum class Kind { Passed, Scattered, Absorbed } kind = Kind::Passed;
    Float t = 0;  ///< distance at which it is scattered
};

/// Random numbers for everything that happens on a ray through a medium after the first distance, which `u` decides. A
/// hash of the ray makes them, because numbers of the pixel's sampler take more time and are no better there.
inline Rng NumbersAlong(const Ray &ray, Float u) { return Rng(Hash(ray.o, ray.d, u)); }

/// Follows light along a ray through a medium (delta tracking) and updates the weights of its path. `emits`: calls
/// emit(radiance, mean) for the emission on the way, divided by `mean`, the mean of its densities. `u`: uniform, for
/// the first distance; `rng` for all else.
template <class Emit>
MediumEvent TrackMedium(MediumOnRay on, Float u, Rng &rng, bool emits, SpectralWeights &weights, Emit &&emit) {
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
