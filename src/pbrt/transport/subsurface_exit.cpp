#include "pbrt/transport/subsurface_exit.h"

namespace pbrt {

std::optional<SubsurfaceExit> SampleSubsurfaceExit(const Scene &scene, const SurfacePoint &entry, const Bssrdf &bssrdf,
                                                   Sampler &sampler) {
    const Float uAxis = sampler.Get1D();
    const Point2 uProbe = sampler.Get2D();
    const Float uCrossing = sampler.Get1D();
    const std::optional<Bssrdf::Probe> probe = bssrdf.SampleProbe(uAxis, uProbe);
    if (!probe) return {};
    std::optional<Scene::Crossing> crossing =
        scene.SampleCrossing(probe->from, probe->to, entry.time, entry.material, uCrossing);
    if (!crossing) return {};
    SubsurfaceExit exit;
    auto &[point, bsdf] = exit.vertex;
    point = crossing->point;
    point.wo = point.shading.n;
    // The probe ray carried no medium, so surfaces without interface have none set.
    if (point.insideMedium == point.outsideMedium) point.insideMedium = point.outsideMedium = entry.outsideMedium;
    const Float pdf = bssrdf.Pdf(point.p, point.n) / Float(crossing->count);  // area
    if (!(pdf > 0)) return {};
    exit.weight = bssrdf.Profile(Distance(entry.p, point.p)) / pdf;
    if (!exit.weight) return {};
    bsdf = Bsdf(point.shading.n, point.shading.dpdu, bssrdf.ExitLobe());
    return exit;
}

}  // namespace pbrt
