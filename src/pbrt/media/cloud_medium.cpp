#include "pbrt/media/cloud_medium.h"

#include "pbrt/textures/noise.h"

namespace pbrt {

namespace {

constexpr Float kLacunarity = Float(1.99);
/// No gradient noise is larger: with the best gradient at each corner of its cube it reaches 1.03635.
constexpr Float kMaxNoise = Float(1.04);
/// The steepness of the density in its noise at the bottom of the cloud.
constexpr Float kSteepness = Float(4.5);
/// Layers of the majorants, from the bottom to the top of the box.
constexpr int kLayers = 8;

/// What fills the lower half of the cloud at a height, whatever the noise.
Float FillAt(Float y) { return 2 * std::max(Float(0), Float(0.5) - y); }

}  // namespace

Float CloudMedium::Shape::DensityAt(const Point3 &p) const {
    const Float fill = FillAt(p.y);
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
    // Above the top noise counts the other way round.
    Float noise = 0, strength = std::copysign(Float(0.5), 1 - p.y), fineness = 1;
    for (int octave = 0; octave < 5; ++octave) {
        noise += strength * GradientNoise(fineness * at);
        // The octaves that are left are together weaker than this one. Mostly they cannot matter.
        const Float rest = kMaxNoise * std::abs(strength);
        if (noise + rest < 0) return fill;
        if (steepness * (noise - rest) > 1 - fill) return 1;
        strength /= 2;
        fineness *= kLacunarity;
    }
    const Float puffs = std::clamp(steepness * noise, Float(0), Float(1));
    return std::min(puffs + fill, Float(1));
}

Float CloudMedium::Shape::MaxBetween(Float low, Float high) const {
    // The density falls with the height up to 1, where noise begins to count the other way round.
    const Float far = std::max(std::abs(1 - low), std::abs(1 - high));
    return std::min(far * kSteepness * density * kMaxNoise + FillAt(low), Float(1));
}

CloudMedium::CloudMedium(MediumSpectra spectra, Float g, const Transform &renderFromMedium, const Bounds3 &bounds,
                         const Shape &shape)
    : Medium(g, false), spectra_(std::move(spectra)), shape_(shape), low_(bounds.low) {
    const glm::ivec3 cells(1, kLayers, 1);
    perCell_ = bounds.Diagonal() / Vector3(cells);
    // Makes up for the rounding of heights.
    const Float margin = 8 * MachineEpsilon * (std::abs(bounds.low.y) + std::abs(bounds.high.y));
    majorants_ = MajorantGrid(cells, [&](const glm::ivec3 &cell) {
        const Float y = low_.y + perCell_.y * static_cast<Float>(cell.y);
        return kMajorantSlack * shape.MaxBetween(y - margin, y + perCell_.y + margin);
    });
    gridFromRender_ =
        AffineMap::ToBox(bounds.low, bounds.high, cells) * AffineMap(glm::dmat4(renderFromMedium.Matrix())).Inverse();
}

MediumOnRay CloudMedium::On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const {
    const MediumCoefficients unit = spectra_.Sample(lambda);
    return {*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, unit, unit.absorption + unit.scattering};
}

MediumCoefficients CloudMedium::Evaluate(MediumOnRay &onRay, Float t) const {
    const Float density = shape_.DensityAt(low_ + perCell_ * onRay.Walk().At(t));
    return {onRay.Unit().absorption * density, onRay.Unit().scattering * density, SampledSpectrum(0)};
}

}  // namespace pbrt
