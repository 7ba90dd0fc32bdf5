#pragma once
#include "pbrt/media/medium.h"

namespace pbrt {

inline DenseSpectrum ScaledSpectrum(const Spectrum &s, Float scale) {
    std::vector<Float> values;
    for (Float nm = LambdaMin; nm <= LambdaMax; ++nm) values.push_back(scale * s(nm));
    return DenseSpectrum(values);
}

struct MediumSpectra {
    DenseSpectrum absorption, scattering, emission;

    MediumCoefficients Sample(const SampledWavelengths &lambda) const {
        return {absorption.Sample(lambda), scattering.Sample(lambda),
                emission.MaxValue() > 0 ? emission.Sample(lambda) : SampledSpectrum(0)};
    }
    size_t Bytes() const { return 3 * static_cast<size_t>(LambdaMax - LambdaMin + 1) * sizeof(Float); }
};

/// Factor of densities for majorants: covers rounding of interpolation and of sums and products of coefficients.
inline constexpr Float kMajorantSlack = 1 + 32 * MachineEpsilon;

/// Majorant cells per axis for a voxel count. Each cell costs 10 to 15 ns per ray; tight majorants save collisions.
inline glm::ivec3 MajorantCells(const glm::ivec3 &voxels, int voxelsPerCell, int maxCells) {
    return glm::min((voxels + (voxelsPerCell - 1)) / voxelsPerCell, glm::ivec3(maxCells));
}

}  // namespace pbrt
