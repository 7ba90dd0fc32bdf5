#pragma once
#include "pbrt/core/counters.h"
#include "pbrt/math/fast_functions.h"
#include "pbrt/math/rng.h"
#include "pbrt/media/medium.h"

namespace pbrt {

/// Transmittance of a segment at the majorants of all wavelengths; `length` may be infinite.
inline SampledSpectrum MajorantTransmittance(const SampledSpectrum &majorant, Float length) {
    return majorant.Map([length](Float m) { return m > 0 ? ExpOfMinus(m * length) : Float(1); });
}

/// Samples tentative collisions along a ray with the majorant at wavelength 0: `u` for the first one, `rng` for the
/// others. Calls
///   visit(Float t, const MediumCoefficients &, const SampledSpectrum &majorant, const SampledSpectrum &tMaj) -> bool
///   until it returns false. tMaj is the majorant transmittance since the last tentative collision or the ray's start;
///   the density of t is majorant[0] * tMaj[0] relative to it. Returns the majorant transmittance from the last
///   collision to the end of the ray, or 1 if `visit` returned false. Segments with majorant 0 at wavelength 0 have no
///   collisions, but count for the transmittance of the other wavelengths.
SampledSpectrum ForEachCollision(MediumOnRay &onRay, Float u, Rng &rng, auto &&visit) {
    SampledSpectrum tMaj(1);
    uint64_t lookups = 0;
    Float depth = DepthThatTakes(u);  // majorant optical depth, at wavelength 0, to the next collision
    MajorantSegment segment;
    while (onRay.Next(&segment)) {
        const Float majorant = segment.majorant[0];
        Float begin = segment.begin;
        for (;;) {
            const Float t = majorant > 0 ? begin + depth / majorant : Infinity;
            if (!(t < segment.end)) break;
            tMaj *= MajorantTransmittance(segment.majorant, t - begin);
            ++lookups;
            if (!visit(t, onRay.At(t), segment.majorant, tMaj)) {
                ThreadCounters().mediumLookups += lookups;
                return SampledSpectrum(1);
            }
            tMaj = SampledSpectrum(1);
            begin = t;
            depth = DepthThatTakes(rng.Uniform());
        }
        const Float length = segment.end - begin;
        if (majorant > 0) depth = std::max(depth - majorant * length, Float(0));
        tMaj *= MajorantTransmittance(segment.majorant, length);
    }
    ThreadCounters().mediumLookups += lookups;
    return tMaj;
}

}  // namespace pbrt
