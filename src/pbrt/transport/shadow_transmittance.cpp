#include "pbrt/transport/shadow_transmittance.h"

#include "pbrt/media/tracking.h"

namespace pbrt {
namespace {

/// Transmittance below which Russian roulette applies.
constexpr Float kLittle = 0.05f;
constexpr Float kContinuation = 0.25f;

/// Ratio tracking through one medium. Returns false if no light remains.
bool PassMedium(MediumOnRay on, Rng &rng, ShadowTransmittance *through) {
    auto &[value, ru, rl] = *through;
    const SampledSpectrum rest = ForEachCollision(
        on, rng.Uniform(), rng,
        [&](Float, const MediumCoefficients &c, const SampledSpectrum &majorant, const SampledSpectrum &tMaj) {
            const SampledSpectrum null = ClampZero(majorant - c.absorption - c.scattering);
            const Float pdf = majorant[0] * tMaj[0];
            value *= tMaj * null / pdf;
            ru *= tMaj * null / pdf;
            rl *= tMaj * majorant / pdf;
            if (!value) return false;
            if ((value / (ru + rl).Average()).MaxComponent() < kLittle && EndsByRoulette(kContinuation, rng, value))
                value = SampledSpectrum(0);
            return bool(value);
        });
    if (!value || !(rest[0] > 0)) {
        value = SampledSpectrum(0);
        return false;
    }
    const SampledSpectrum f = rest / rest[0];
    value *= f;
    ru *= f;
    rl *= f;
    return bool(value);
}

}  // namespace

ShadowTransmittance TraceShadow(const Scene &scene, const LightSampleContext &from, MediumId medium,
                                const LightLiSample &to, const SampledWavelengths &lambda, Rng &rng) {
    const Ray ray = Scene::ShadowRay(from, to);
    ShadowTransmittance through;
    PassedHits passed;
    if (scene.Occluded(ray, &passed)) return through;
    through.value = SampledSpectrum(1);
    const Float length = Length(ray.d);
    Float begin = 0;
    for (const AccelHit *next = passed.Hits().data(), *last = next + passed.Hits().size();;) {
        std::optional<Scene::Interface> interface;
        if (next != last) interface = scene.InterfaceAt(*next++, ray);
        else if (passed.HasDropped()) interface = scene.NextInterface(ray, begin);
        const Float end = interface ? interface->t : ray.tMax;
        if (const Medium *m = scene.MediumAt(medium)) {
            const Ray part{.o = ray(begin), .d = ray.d / length};
            if (!PassMedium(m->On(part, (end - begin) * length, lambda), rng, &through)) break;
        }
        if (!interface) break;
        medium = interface->behind;
        begin = end;
    }
    return through;
}

}  // namespace pbrt
