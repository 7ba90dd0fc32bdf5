#include "pbrt/shapes/quadric.h"

namespace pbrt {

Quadric::Quadric(ShapeKind kind, Float radius, Float phiMax, const Transform &renderFromObject, bool reverseOrientation)
    : Shape(kind), radius_(radius), phiMax_(Radians(std::clamp(phiMax, Float(0), Float(360)))),
      renderFromObject_(renderFromObject), isSimilarity_(renderFromObject.UniformScale(1e-4).has_value()),
      flipNormal_(reverseOrientation != renderFromObject.SwapsHandedness()) {
    // Double precision from the forward matrix, so that hits lie on the surface of Surface().
    glm::dmat3 m(renderFromObject.Matrix());
    toObject_ = glm::inverse(m);
    origin_ = glm::dvec3(renderFromObject.Matrix()[3]);
    double determinant = glm::determinant(m);
    determinant_ = Float(std::abs(determinant));
    scale_ = Float(std::cbrt(std::abs(determinant)));
}

void Quadric::SetArea(Float objectArea) {
    objectArea_ = objectArea;
    const Bounds3 bounds = PrimitiveBounds(0);
    reach_ = Max(Abs(bounds.low), Abs(bounds.high));
    if (isSimilarity_) {
        area_ = objectArea * scale_ * scale_;
        return;
    }
    // |dpdu x dpdv| integrated over (u, v) by the midpoint rule.
    constexpr int kSteps = 128;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            Point2 uv((Float(i) + Float(0.5)) / kSteps, (Float(j) + Float(0.5)) / kSteps);
            ObjectPoint at = PointAt(uv);
            sum += double(Length(Cross(renderFromObject_.Vector(at.dpdu), renderFromObject_.Vector(at.dpdv))));
        }
    area_ = Float(sum / (kSteps * kSteps));
}

Float Quadric::AreaStretch(const Normal3 &n) const {
    if (isSimilarity_) return scale_ * scale_;
    return determinant_ * Length(renderFromObject_.Normal(n));
}

Bounds3 Quadric::PrimitiveBounds(uint32_t) const { return PlacedBounds(renderFromObject_, ObjectBounds()); }

std::optional<PrimitiveHit> Quadric::Intersect(uint32_t, const Point3 &o, const Vector3 &d, Float tMin,
                                               Float tMax) const {
    glm::dvec3 origin = toObject_ * (glm::dvec3(o) - origin_), direction = toObject_ * glm::dvec3(d);
    Roots roots = ObjectIntersect(origin, direction);
    for (int i = 0; i < roots.count; ++i) {
        double t = roots.t[i];
        if (!(t > double(tMin) && t < double(tMax))) continue;
        if (std::optional<Point2> uv = Clip(origin + t * direction)) return PrimitiveHit{Float(t), uv->x, uv->y};
    }
    return {};
}

SurfacePoint Quadric::SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Point3 &o,
                                   const Vector3 &d) const {
    SurfacePoint s = Surface(primitive, hit);
    const glm::dvec3 origin(o), direction(d);
    const Roots roots = ObjectIntersect(toObject_ * (origin - origin_), toObject_ * direction);
    if (roots.count == 0) return s;  // a grazing ray moved off the surface by rounding
    const double t = double(hit.t), first = roots.t[0], last = roots.t[roots.count - 1];
    s.p = Point3(origin + (std::abs(last - t) < std::abs(first - t) ? last : first) * direction);
    // One rounding of the point; Intersect and the line above lose some of a double's 53 bits.
    s.pError = Gamma(2) * Abs(s.p) + 0x1p-40f * (reach_ + Abs(o));
    return s;
}

SurfacePoint Quadric::Surface(uint32_t primitive, const PrimitiveHit &hit) const {
    ObjectPoint at = PointAt({hit.u, hit.v});
    SurfacePoint s;
    s.primitive = primitive;
    s.p = renderFromObject_.Point(at.p);
    s.pError = renderFromObject_.PointError(at.p, at.pError);
    s.uv = {hit.u, hit.v};
    Float side = flipNormal_ ? Float(-1) : Float(1);
    s.n = RenderNormal(at.n);
    s.dpdu = renderFromObject_.Vector(at.dpdu);
    s.dpdv = renderFromObject_.Vector(at.dpdv);
    s.dndu = side * renderFromObject_.Normal(at.dndu);
    s.dndv = side * renderFromObject_.Normal(at.dndv);
    s.shading = {s.n, s.dpdu, s.dpdv, s.dndu, s.dndv};
    return s;
}

Normal3 Quadric::RenderNormal(const Normal3 &objectNormal) const {
    Normal3 n = Normalize(renderFromObject_.Normal(objectNormal));
    return flipNormal_ ? -n : n;
}

std::optional<ShapeSample> Quadric::SampleArea(uint32_t, const Point2 &u) const {
    if (!(objectArea_ > 0)) return {};
    ShapeSample s = SampleObject(u);
    s.pdf = PdfAreaAt(s.n);
    s.pError = renderFromObject_.PointError(s.p, s.pError);
    s.p = renderFromObject_.Point(s.p);
    s.n = RenderNormal(s.n);
    return s;
}

Float Quadric::PdfArea(uint32_t, const Point3 &p, const Normal3 &) const {
    return PdfAreaAt(isSimilarity_ ? Normal3(0, 0, 1) : Normalize(NormalAt(renderFromObject_.InversePoint(p))));
}

}  // namespace pbrt
