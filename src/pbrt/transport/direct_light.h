#pragma once
#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/math/warps.h"
#include "pbrt/transport/shadow_transmittance.h"
#include "pbrt/transport/vertex.h"

namespace pbrt {

/// Light sampling state at a vertex. Kept until the next vertex, for the MIS weight of emission there.
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
    /// Density (solid angle) of light sampling here for emission that a ray in direction d (unit) hit at p with normal
    /// n, or outside the scene (`isInfinite`; p and n are ignored). 0: not sampled.
    Float LightPdf(const LightTable &table, LightId light, bool isInfinite, const Vector3 &d, const Point3 &p,
                   const Normal3 &n) const {
        const SampledLight chosen =
            isInfinite ? lights.Towards(light, from.p, d) : SampledLight{light, lights.PMF(light)};
        return chosen.pmf > 0 ? chosen.pmf * table.Region(light, chosen.region).PdfLi(from, d, p, n, true) : 0;
    }
};

/// MIS weight (power heuristic) of emission that a ray of density `pScatter` hits; `pLight`: VertexSelection::LightPdf.
inline Float EmissionWeight(Float pScatter, Float pLight) {
    return pLight > 0 ? PowerHeuristic(pScatter, pLight) : Float(1);
}

/// A path's records for a PathObserver, or none.
struct ObservedPath {
    PathObserver *observer = nullptr;
    PathObserver::PathPlaces places{};

    ObservedPath() = default;
    ObservedPath(PathObserver *o, Point2i pixel, int sample) : observer(o) {
        if (observer) places = observer->BeginPath(pixel, sample);
    }
    /// False if the observer records no (further) light sample of the path, or if there is none.
    bool HasPlace() const { return places.next < places.end; }
};

/// BSDF or phase function for a direction, and the cosine (1 in media).
struct Scattering {
    SampledSpectrum f{0};
    Float cosine = 1;
};

/// Incident light at a vertex from one point on one light, without MIS weight.
struct DirectLight {
    SampledLight chosen;
    LightLiSample sample;
    Scattering to;                ///< scattering towards the light
    ShadowTransmittance through;  ///< nonzero
    bool isDelta = false;         ///< not reachable by other techniques

    SampledSpectrum F() const { return to.f * to.cosine; }
    Float Pdf() const { return chosen.pmf * sample.pdf; }  ///< solid angle, including the discrete light selection
};

/// Next-event estimation at a vertex, for every integrator: selects a light by `lights` and a point on it, and traces
/// the shadow ray. Empty if nothing arrives.
///
///   scatter(wi) -> Scattering
///   trace(const LightLiSample &, const Point2 &u) -> ShadowTransmittance; u: the numbers that sampled the point
///
/// `from`: receiver of light sampling (ScatteringContextAt). The observer receives irradiance over the density of the
/// point, also where it is 0, while its path has places.
std::optional<DirectLight> SampleDirectLight(const LightTable &table, const LightDistribution &lights,
                                             const LightSampleContext &from, const SampledWavelengths &lambda,
                                             bool allowIncompletePdfs, Float uLight, Point2 uPoint,
                                             ObservedPath &observed, auto &&scatter, auto &&trace) {
    const std::optional<SampledLight> chosen = lights.Sample(uLight, &uPoint);
    if (!chosen) return {};
    const auto record = [&](auto &&irradiance) {
        if (observed.HasPlace())
            observed.observer->RecordLightSample(observed.places, lights.Query(), *chosen, irradiance());
    };
    const auto light = table.Region(chosen->light, chosen->region);
    const std::optional<LightLiSample> sample = light.SampleLi(from, uPoint, lambda, allowIncompletePdfs);
    Scattering to;
    if (sample && sample->L && sample->pdf > 0) to = scatter(sample->wi);
    ShadowTransmittance through;
    if (to.f * to.cosine) through = trace(*sample, uPoint);
    if (!through.value) {
        record([] { return SampledSpectrum(0); });
        return {};
    }
    record([&] {
        const Float mean = lambda.SecondaryTerminated() ? through.rl[0] : through.rl.Average();
        return sample->L * through.value * (to.cosine / (sample->pdf * mean));
    });
    return DirectLight{*chosen, *sample, to, through, IsDelta(light.Kind())};
}

/// SampleDirectLight at a surface, with the same `trace`.
std::optional<DirectLight> SampleDirectLight(const Scene &scene, const PathVertex &vertex,
                                             const LightDistribution &lights, const SampledWavelengths &lambda,
                                             bool allowIncompletePdfs, Float uLight, Point2 uPoint,
                                             ObservedPath &observed, auto &&trace) {
    const auto &[point, bsdf] = vertex;
    return SampleDirectLight(
        scene.Lights(), lights, ScatteringContextAt(scene, point, bsdf), lambda, allowIncompletePdfs, uLight, uPoint,
        observed,
        [&](const Vector3 &wi) {
            return Scattering{bsdf.F(point.wo, wi), AbsDot(wi, point.shading.n)};
        },
        trace);
}

/// Shadow ray that is blocked by every surface.
inline ShadowTransmittance TraceShadowRay(const Scene &scene, const LightSampleContext &from, const LightLiSample &to) {
    ShadowTransmittance through;
    if (!scene.Occluded(from, to)) through.value = SampledSpectrum(1);
    return through;
}

}  // namespace pbrt
