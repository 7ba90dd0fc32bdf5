#pragma once
#include "pbrt/media/medium.h"

namespace pbrt {

/// A spectrum times a factor, one value per nm.
inline DenseSpectrum ScaledSpectrum(const Spectrum &s, Float scale) {
    std::vector<Float> values;
    for (Float nm = LambdaMin; nm <= LambdaMax; ++nm) values.push_back(scale * s(nm));
    return DenseSpectrum(values);
}

/// What a medium of density 1 does, as spectra. The coefficients are those of MediumCoefficients.
struct MediumSpectra {
    DenseSpectrum absorption, scattering, emission;

    MediumCoefficients Sample(const SampledWavelengths &lambda) const {
        return {absorption.Sample(lambda), scattering.Sample(lambda),
                emission.MaxValue() > 0 ? emission.Sample(lambda) : SampledSpectrum(0)};
    }
    size_t Bytes() const { return 3 * static_cast<size_t>(LambdaMax - LambdaMin + 1) * sizeof(Float); }
};

/// Densities of media are multiplied by this before they become majorants: it makes up for the rounding of what is
/// interpolated and of the sums and products of coefficients.
inline constexpr Float kMajorantSlack = 1 + 32 * MachineEpsilon;

/// The cells of a grid of majorants along each axis, for so many voxels. Cells cost time on every ray (10 to 15 ns),
/// tight majorants save collisions.
inline glm::ivec3 MajorantCells(const glm::ivec3 &voxels, int voxelsPerCell, int maxCells) {
    return glm::min((voxels + (voxelsPerCell - 1)) / voxelsPerCell, glm::ivec3(maxCells));
}

}  // namespace pbrt
