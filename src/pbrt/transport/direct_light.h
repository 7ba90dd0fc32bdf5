#pragma once
#include "pbrt/core/counters.h"
#include "pbrt/lightsamplers/path_observer.h"
#include "pbrt/math/warps.h"
#include "pbrt/transport/light_query.h"
#include "pbrt/transport/shadow_transmittance.h"

namespace pbrt {

/// What light sampling needs at a vertex. It is kept until the next vertex, because the MIS weight of emission there
/// depends on the probabilities of the lights here.
struct VertexSelection {
    LightQuery query;
    LightSampleContext from;
    LightMemory memory;
    LightDistribution lights;

    void Prepare(const LightSampler &sampler, const LightQuery &q, const LightSampleContext &at) {
        query = q;
        from = at;
        lights = sampler.At(query, memory);
    }
    void Prepare(const LightSampler &sampler, const PathVertex &vertex, const SampledWavelengths &lambda, int depth) {
        Prepare(sampler, LightQueryAt(vertex, lambda, depth), LightContextAt(vertex.point));
    }
    /// Density (solid angle) with which light sampling here would have found emission that a ray in direction d (unit)
    /// met at p with normal n, or beyond the scene (`isInfinite`; p and n are ignored). 0: it could not.
    Float LightPdf(const LightTable &table, LightId light, bool isInfinite, const Vector3 &d, const Point3 &p,
                   const Normal3 &n) const {
        const SampledLight chosen =
            isInfinite ? lights.Towards(light, from.p, d) : SampledLight{light, lights.PMF(light)};
        return chosen.pmf > 0 ? chosen.pmf * table.Region(light, chosen.region).PdfLi(from, d, p, n, true) : 0;
    }
};

/// The record of one path for a PathObserver, or of none.
struct ObservedPath {
    PathObserver *observer = nullptr;
    PathObserver::PathPlaces places{};

    ObservedPath() = default;
    ObservedPath(PathObserver *o, Point2i pixel, int sample) : observer(o) {
        if (observer) places = observer->BeginPath(pixel, sample);
    }
};

/// The BSDF or phase function towards a direction, and the cosine there (1 in media).
struct Scattering {
    SampledSpectrum f{0};
    Float cosine = 1;
};

/// Light from one point on one light that arrives at a vertex, without weight for MIS.
struct DirectLight {
    SampledLight chosen;
    LightLiSample sample;
    Scattering to;                ///< from the vertex towards the light
    ShadowTransmittance through;  ///< not 0
    bool isDelta = false;         ///< no other technique finds it

    SampledSpectrum F() const { return to.f * to.cosine; }
    Float Pdf() const { return chosen.pmf * sample.pdf; }  ///< solid angle, and discrete choice of the light
};

/// Next-event estimation at a vertex, for every integrator: chooses a light by `lights` and a point on it, and traces
/// the shadow ray. Empty if nothing arrives.
///
///   scatter(wi) -> Scattering
///   trace(const LightLiSample &, const Point2 &u) -> ShadowTransmittance; u: the numbers that drew the point
///
/// `from`: where lights are sampled from (ScatteringContextAt). The observer receives the irradiance over the density
/// of the point, also where it is 0.
template <class Scatter, class Trace>
std::optional<DirectLight> SampleDirectLight(const LightTable &table, const LightDistribution &lights,
                                             const LightSampleContext &from, const SampledWavelengths &lambda,
                                             bool allowIncompletePdfs, Float uLight, Point2 uPoint,
                                             ObservedPath &observed, Scatter &&scatter, Trace &&trace) {
    const std::optional<SampledLight> chosen = lights.Sample(uLight, &uPoint);
    if (!chosen) {
        ++ThreadCounters().zeroLightSamples;
        return {};
    }
    const auto record = [&](const SampledSpectrum &irradiance) {
        if (observed.observer)
            observed.observer->RecordLightSample(observed.places, lights.Query(), *chosen, irradiance);
    };
    const auto light = table.Region(chosen->light, chosen->region);
    const std::optional<LightLiSample> sample = light.SampleLi(from, uPoint, lambda, allowIncompletePdfs);
    Scattering to;
    if (sample && sample->L && sample->pdf > 0) to = scatter(sample->wi);
    ShadowTransmittance through;
    if (to.f * to.cosine) through = trace(*sample, uPoint);
    if (!through.value) {
        record(SampledSpectrum(0));
        return {};
    }
    const Float mean = lambda.SecondaryTerminated() ? through.rl[0] : through.rl.Average();
    record(sample->L * through.value * (to.cosine / (sample->pdf * mean)));
    return DirectLight{*chosen, *sample, to, through, IsDelta(light.Kind())};
}

/// SampleDirectLight at a surface. `trace` as there.
template <class Trace>
std::optional<DirectLight> SampleDirectLight(const Scene &scene, const PathVertex &vertex,
                                             const LightDistribution &lights, const SampledWavelengths &lambda,
                                             bool allowIncompletePdfs, Float uLight, Point2 uPoint,
                                             ObservedPath &observed, Trace &&trace) {
    const auto &[point, bsdf] = vertex;
    return SampleDirectLight(
        scene.Lights(), lights, ScatteringContextAt(scene, point, bsdf), lambda, allowIncompletePdfs, uLight, uPoint,
        observed,
        [&](const Vector3 &wi) {
            return Scattering{bsdf.F(point.wo, wi), AbsDot(wi, point.shading.n)};
        },
        trace);
}

/// A shadow ray that every surface blocks.
inline ShadowTransmittance TraceShadowRay(const Scene &scene, const LightSampleContext &from, const LightLiSample &to) {
    ShadowTransmittance through;
    if (!scene.Occluded(from, to)) through.value = SampledSpectrum(1);
    return through;
}

}  // namespace pbrt
