#pragma once
#include <vector>

#include "pbrt/media/medium.h"
#include "pbrt/textures/noise.h"

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
    size_t Bytes() const { return 3 * size_t(LambdaMax - LambdaMin + 1) * sizeof(Float); }
};

/// Emission of a black body at temperature (T - offset) * factor, normalised to its peak. None at 100 K and below.
struct ThermalEmission {
    Float offset = 0;  ///< kelvin
    Float factor = 1;
    Float scale = 1;  ///< of the emission

    SampledSpectrum At(Float temperature, const SampledWavelengths &lambda) const {
        const Float kelvin = (temperature - offset) * factor;
        constexpr Float kCold = 100;
        if (!(kelvin > kCold)) return SampledSpectrum(0);
        return scale * BlackbodySpectrum(kelvin).Sample(lambda);
    }
};

class HomogeneousMedium final : public Medium {
  public:
    HomogeneousMedium(MediumSpectra spectra, Float g)
        : Medium(g, spectra.emission.MaxValue() > 0 && spectra.absorption.MaxValue() > 0),
          spectra_(std::move(spectra)) {}
    size_t Bytes() const override { return sizeof(*this) + spectra_.Bytes(); }
    MediumOnRay On(const Ray &, Float tMax, const SampledWavelengths &lambda) const override {
        return {*this, GridWalk(tMax), lambda, spectra_.Sample(lambda)};
    }

  private:
    MediumCoefficients Evaluate(MediumOnRay &onRay, Float) const override { return onRay.Unit(); }
    MediumSpectra spectra_;
};

/// Factor of densities for majorants: covers rounding of interpolation and of sums and products of coefficients.
inline constexpr Float kMajorantSlack = 1 + 32 * MachineEpsilon;

/// Majorant cells per axis for a voxel count. Each cell costs 10 to 15 ns per ray; tight majorants save collisions.
inline glm::ivec3 MajorantCells(const glm::ivec3 &voxels, int voxelsPerCell, int maxCells) {
    return glm::min((voxels + (voxelsPerCell - 1)) / voxelsPerCell, glm::ivec3(maxCells));
}

/// Maps rendering space to the cells of a majorant grid over a box in medium space.
inline AffineMap GridFromRender(const Transform &renderFromMedium, const Bounds3 &box, const glm::ivec3 &cells) {
    return AffineMap::ToBox(box.low, box.high, cells) * AffineMap(glm::dmat4(renderFromMedium.Matrix())).Inverse();
}

struct NanoVdbRequest {
    std::string path;
    std::string densityName, temperatureName;  ///< of grids in the file; the second is optional
    ThermalEmission thermal;
};

/// Medium of a sparse density grid from a NanoVDB file, which multiplies absorption and scattering. The grid's own
/// transformation maps to medium space. Values are at integer index coordinates, interpolated trilinearly; negative
/// densities count as 0. The medium extends one voxel beyond the active voxels. A temperature grid makes it emit.
///
/// Throws UserError (no location) if the file is unreadable, lacks the density, or holds invalid densities.
std::unique_ptr<Medium> MakeNanoVdbMedium(const NanoVdbRequest &request, MediumSpectra spectra, Float g,
                                          const Transform &renderFromMedium);

/// Box with a procedural cloud of density at most 1. It is a function of medium space and lies in 0 < y < 1.
class CloudMedium final : public Medium {
  public:
    struct Shape {
        static constexpr Float kLacunarity = Float(1.99);
        /// Bound on gradient noise: the best gradients at a cube's corners reach 1.03635.
        static constexpr Float kMaxNoise = Float(1.04);
        static constexpr Float kSteepness = Float(4.5);
        Float density = 1, wispiness = 1, frequency = 5;
        Float DensityAt(const Point3 &p) const {
            const Float fill = 2 * std::max(Float(0), Float(0.5) - p.y);
            if (fill >= 1) return 1;
            const Float steepness = std::abs((1 - p.y) * kSteepness * density);
            Point3 at = frequency * p;
            if (wispiness > 0) {
                Float strength = Float(0.05) * wispiness, fineness = 10;
                for (int octave = 0; octave < 2; ++octave) {
                    at += strength * GradientNoiseSlope(fineness * at);
                    strength /= 2;
                    fineness *= kLacunarity;
                }
            }
            // Above the top, noise is negated.
            Float noise = 0, strength = std::copysign(Float(0.5), 1 - p.y), fineness = 1;
            for (int octave = 0; octave < 5; ++octave) {
                noise += strength * GradientNoise(fineness * at);
                // Bound on the remaining octaves, which together are weaker than this one and mostly irrelevant.
                const Float rest = kMaxNoise * std::abs(strength);
                if (noise + rest < 0) return fill;
                if (steepness * (noise - rest) > 1 - fill) return 1;
                strength /= 2;
                fineness *= kLacunarity;
            }
            const Float puffs = std::clamp(steepness * noise, Float(0), Float(1));
            return std::min(puffs + fill, Float(1));
        }
    };
    /// Spectra at density 1; the emission must be 0.
    CloudMedium(MediumSpectra spectra, Float g, const Transform &renderFromMedium, const Bounds3 &bounds,
                const Shape &shape)
        : Medium(g, false), spectra_(std::move(spectra)), shape_(shape), bounds_(bounds),
          majorants_(glm::ivec3(1), [](const glm::ivec3 &) { return kMajorantSlack; }),
          gridFromRender_(GridFromRender(renderFromMedium, bounds, glm::ivec3(1))) {}
    size_t Bytes() const override { return sizeof(*this) + spectra_.Bytes() + majorants_.Bytes(); }
    MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const override {
        return {*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, spectra_.Sample(lambda)};
    }

  private:
    MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const override {
        const Float density = shape_.DensityAt(bounds_.low + bounds_.Diagonal() * onRay.Walk().At(t));
        return {onRay.Unit().absorption * density, onRay.Unit().scattering * density, SampledSpectrum(0)};
    }

    MediumSpectra spectra_;
    Shape shape_;
    Bounds3 bounds_;
    MajorantGrid majorants_;
    AffineMap gridFromRender_;
};

}  // namespace pbrt
