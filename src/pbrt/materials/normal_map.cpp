#include "pbrt/materials/normal_map.h"

#include "pbrt/math/frame.h"

namespace pbrt {

void NormalMap::Perturb(SurfacePoint &point) const {
    Point2 st(point.uv.x, 1 - point.uv.y);
    Vector3 mapped;
    for (int c = 0; c < 3; ++c) mapped[c] = 2 * image_->Bilinear(st, c, WrapMode::Repeat) - 1;
    if (!(LengthSquared(mapped) > 0)) return;

    SurfacePoint::Shading &shading = point.shading;
    Vector3 ns = Normalize(Frame::FromXZ(shading.dpdu, shading.n).FromLocal(Normalize(mapped)));
    Vector3 along = shading.dpdu - ns * Dot(ns, shading.dpdu);
    if (!(LengthSquared(along) > 0)) return;
    along = Normalize(along);
    shading.dpdu = along * Length(shading.dpdu);
    shading.dpdv = Cross(ns, along) * Length(shading.dpdv);
    shading.n = FaceForward(ns, point.n);
}

}  // namespace pbrt
