#include "pbrt/integrators/bdpt_path.h"

namespace pbrt {

Float BdptWeights::LightPdf(const BdptVertex &light, const BdptVertex &next) const {
    const LightComponent component = lights_[light.light];
    const Float pmf = shooting_.PMF({}, light.light);
    // The position of a distant light is its direction; that of an invisible area light has a density.
    if (IsDelta(component.Kind()) && (light.isBeyondScene || light.n == Normal3(0))) return pmf;
    const LightLePdf pdf =
        component.PdfLe(light.isBeyondScene ? next.Position() : light.p, light.n, light.Towards(next));
    return pmf * (light.isBeyondScene ? pdf.direction : pdf.position);
}

Float BdptWeights::FirstStepPdf(const BdptVertex &light, const BdptVertex &next) const {
    const Vector3 w = light.Towards(next);
    const LightLePdf pdf = lights_[light.light].PdfLe(light.isBeyondScene ? next.Position() : light.p, light.n, w);
    if (!light.isBeyondScene) return next.AreaPdf(light, pdf.direction);
    return next.AreaPdfOfParallel(pdf.position, w);
}

Float BdptWeights::ConnectedLightPdf(const BdptVertex &light, const BdptVertex &from, const BdptVertex &beyond,
                                     const SampledWavelengths &lambda, int depth) const {
    const Vector3 wi = from.Towards(light);
    const bool isInfinite = lights_[light.light].Kind() == LightKind::Infinite;
    const LightQuery query = from.Query(from.Towards(beyond), lambda, depth);
    LightMemory memory;
    const LightDistribution lights = connecting_.At(query, memory);
    const LightSampleContext context = from.Context();
    const SampledLight chosen =
        isInfinite ? lights.Towards(light.light, context.p, wi) : SampledLight{light.light, lights.PMF(light.light)};
    const LightComponent component = lights_.Region(light.light, chosen.region);
    const Float pmf = chosen.pmf;
    if (light.isBeyondScene ? !isInfinite : light.n == Normal3(0)) return pmf;
    const ShapePrimitive at = component.Surface();
    // PdfLi is 0 for an area light that rays cannot hit, because only light sampling reaches it.
    const Float pdf = component.Kind() == LightKind::DeltaPosition && at.shape
                          ? at.shape->PdfSolidAngle(at.primitive, context, wi, light.p, light.n)
                          : component.PdfLi(context, wi, light.p, light.n, false);
    return pmf * light.AreaPdf(from, pdf);
}

Float BdptWeights::Weight(std::span<const BdptVertex *const> path, int fromLight, Float cameraPdf,
                          const SampledWavelengths &lambda) const {
    const int n = int(path.size()), s = fromLight;
    if (n == 2) return 1;  // directly visible light is sampled by the camera only
    const auto at = [&](int k) -> const BdptVertex & { return *path[k]; };
    const auto scatterPdf = [&](int k, int from, int to, TransportMode mode) {
        return at(k).ScatterPdf(at(k).Towards(at(from)), at(k).Towards(at(to)), mode);
    };
    // Densities of the vertices on both sides of the connection, for the respective other subpath.
    Float cameraAtLightEnd = 0, cameraBefore = 0, lightAtCameraEnd = 0, lightBehind = 0;
    if (s >= 1)
        cameraAtLightEnd =
            s == n - 1 ? cameraPdf : at(s - 1).AreaPdf(at(s), scatterPdf(s, s + 1, s - 1, TransportMode::Radiance));
    if (s >= 2) cameraBefore = at(s - 2).AreaPdf(at(s - 1), scatterPdf(s - 1, s, s - 2, TransportMode::Radiance));
    if (s <= n - 2)
        lightAtCameraEnd = s == 0   ? LightPdf(at(0), at(1))
                           : s == 1 ? FirstStepPdf(at(0), at(1))
                                    : at(s).AreaPdf(at(s - 1), scatterPdf(s - 1, s - 2, s, TransportMode::Importance));
    if (s + 1 <= n - 2)
        lightBehind = s == 0 ? FirstStepPdf(at(0), at(1))
                             : at(s + 1).AreaPdf(at(s), scatterPdf(s, s - 1, s + 1, TransportMode::Importance));
    // At the connection both ends scatter without a delta, regardless of their subpaths.
    const auto isSpecular = [&](int k) { return k != s - 1 && k != s && at(k).isSpecular; };
    // Densities of specular vertices are deltas from either side. They occur in every strategy's density exactly once
    // and are omitted everywhere.
    const auto lightPdf = [&](int k) -> Float {
        if (k >= 1 && isSpecular(k - 1)) return 1;
        return k < s ? at(k).pdfForward : k == s ? lightAtCameraEnd : k == s + 1 ? lightBehind : at(k).pdfReverse;
    };
    const auto cameraPdfOf = [&](int k) -> Float {
        if (k + 1 < n && isSpecular(k + 1)) return 1;
        return k >= s ? at(k).pdfForward : k == s - 1 ? cameraAtLightEnd : k == s - 2 ? cameraBefore : at(k).pdfReverse;
    };
    const bool canBeHit = !IsDelta(lights_[at(0).light].Kind());
    // Ratio of a strategy's density to the product of light subpath densities: a single light vertex is selected for
    // the vertex it illuminates.
    const Float chosen = LightPdf(at(0), at(1));
    const Float single = chosen > 0 ? ConnectedLightPdf(at(0), at(1), at(2), lambda, n - 2) / chosen : 0;
    const auto ratio = [&](int i, Float density) -> Float {
        if (i == 0) return canBeHit ? density : 0;
        if (isSpecular(i - 1) || isSpecular(i)) return 0;
        return i == 1 ? density * single : density;
    };
    const Float own = ratio(s, 1);
    if (!(own > 0)) return 0;
    Float sum = own, density = 1;
    for (int i = s - 1; i >= 0; --i) {
        density *= cameraPdfOf(i) / lightPdf(i);
        sum += ratio(i, density);
    }
    density = 1;
    for (int i = s + 1; i <= n - 1; ++i) {
        density *= lightPdf(i - 1) / cameraPdfOf(i - 1);
        sum += ratio(i, density);
    }
    return std::isfinite(sum) ? own / sum : 0;
}

}  // namespace pbrt
