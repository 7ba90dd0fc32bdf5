#include "pbrt/paths/path_walk.h"

namespace pbrt {

PathWalk::Met PathWalk::Next() {
    if (context_.scene.Intersect(ray_, &vertex_.point)) return passed_ > MaxPassed ? Met::TooManyInterfaces : Met::Surface;
    left_ = true;
    return Met::Nothing;
}

bool PathWalk::FindScattering(SampledWavelengths &lambda) {
    SurfacePoint &point = vertex_.point;
    FindFootprint();
    vertex_.bsdf = ComputeBsdf(context_.scene, point, lambda);
    if (vertex_.bsdf) {
        passed_ = 0;
        return true;
    }
    ++passed_;
    const Vector3 d = ray_.d;
    ray_ = point.SpawnRay(d);
    differential_.rxOrigin += d * point.t;
    differential_.ryOrigin += d * point.t;
    return false;
}

void PathWalk::Scatter(const BsdfSample &sample) {
    const SurfacePoint &point = vertex_.point;
    if (differential_.valid) {
        if (!IsSpecular(sample.flags)) differential_.valid = false;
        else if (IsTransmissive(sample.flags)) differential_ = TransmitDifferential(point, differential_, sample.wi, sample.eta);
        else differential_ = ReflectDifferential(point, differential_, sample.wi);
    }
    ray_ = point.SpawnRay(sample.wi);
}

void PathWalk::Leave(const Vector3 &wi) {
    differential_.valid = false;
    ray_ = vertex_.point.SpawnRay(wi);
}

/// Only where somebody looks at it: the point's material, or the next surface on a specular path.
void PathWalk::FindFootprint() {
    SurfacePoint &point = vertex_.point;
    if (!context_.needsFootprints) differential_.valid = false;
    else if (differential_.valid || context_.scene.NeedsFootprintAt(point))
        ComputeFootprint(point, differential_, context_.camera, context_.samplesPerPixel);
}

}  // namespace pbrt
