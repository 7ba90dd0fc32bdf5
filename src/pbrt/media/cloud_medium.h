#pragma once
#include "pbrt/media/medium_kinds.h"
#include "pbrt/textures/noise.h"

namespace pbrt {

/// Box with a procedural cloud of density at most 1. The density is a function of medium space, where the cloud lies
/// between y = 0 and y = 1.
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
        const MediumCoefficients unit = spectra_.Sample(lambda);
        return {*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, unit,
                unit.absorption + unit.scattering};
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
