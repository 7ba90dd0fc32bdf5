#include "pbrt/media/medium_kinds.h"
#include "pbrt/textures/noise.h"

namespace pbrt {

namespace {

constexpr Float kLacunarity = Float(1.99);
/// Bound on gradient noise: the best gradients at a cube's corners reach 1.03635.
constexpr Float kMaxNoise = Float(1.04);
constexpr Float kSteepness = Float(4.5);

}  // namespace

Float CloudMedium::Shape::DensityAt(const Point3 &p) const {
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

CloudMedium::CloudMedium(MediumSpectra spectra, Float g, const Transform &renderFromMedium, const Bounds3 &bounds,
                         const Shape &shape)
    : Medium(g, false), spectra_(std::move(spectra)), shape_(shape), bounds_(bounds),
      majorants_(glm::ivec3(1), [](const glm::ivec3 &) { return kMajorantSlack; }),
      gridFromRender_(GridFromRender(renderFromMedium, bounds, glm::ivec3(1))) {}

MediumOnRay CloudMedium::On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const {
    const MediumCoefficients unit = spectra_.Sample(lambda);
    return {*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, unit, unit.absorption + unit.scattering};
}

MediumCoefficients CloudMedium::Evaluate(MediumOnRay &onRay, Float t) const {
    const Float density = shape_.DensityAt(bounds_.low + bounds_.Diagonal() * onRay.Walk().At(t));
    return {onRay.Unit().absorption * density, onRay.Unit().scattering * density, SampledSpectrum(0)};
}

}  // namespace pbrt
