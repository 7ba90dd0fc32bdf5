#include "pbrt/shapes/quadric.h"

#include "pbrt/math/frame.h"

namespace pbrt {

Quadric::Quadric(ShapeKind kind, Float radius, Float zMin, Float zMax, Float phiMax, const Transform &renderFromObject,
                 bool reverseOrientation)
    : Shape(kind), radius_(radius), zMin_(std::min(zMin, zMax)), zMax_(std::max(zMin, zMax)),
      phiMax_(Radians(std::clamp(phiMax, Float(0), Float(360)))), renderFromObject_(renderFromObject),
      isSimilarity_(renderFromObject.UniformScale(1e-4).has_value()),
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
            sum += double(CrossLength(renderFromObject_.Vector(at.dpdu), renderFromObject_.Vector(at.dpdv)));
        }
    area_ = Float(sum / (kSteps * kSteps));
}

Float Quadric::AreaStretch(const Normal3 &n) const {
    if (isSimilarity_) return scale_ * scale_;
    return determinant_ * Length(renderFromObject_.Normal(n));
}

std::optional<PrimitiveHit> Quadric::Intersect(uint32_t, const Ray &ray, Float tMin) const {
    glm::dvec3 origin = toObject_ * (glm::dvec3(ray.o) - origin_), direction = toObject_ * glm::dvec3(ray.d);
    Roots roots = ObjectIntersect(origin, direction);
    for (int i = 0; i < roots.count; ++i) {
        double t = roots.t[i];
        if (!(t > double(tMin) && t < double(ray.tMax))) continue;
        if (std::optional<Point2> uv = Clip(origin + t * direction)) return PrimitiveHit{Float(t), uv->x, uv->y};
    }
    return {};
}

bool Quadric::IsAtHeight(double height, const Point3 &p, const Vector3 &pError) const {
    const glm::dvec3 n(toObject_[0][2], toObject_[1][2], toObject_[2][2]);
    const Vector3 origin = Abs(Vector3(origin_));
    return IsRounding(glm::dot(n, glm::dvec3(p) - origin_) - height, n, Abs(p) + origin,
                      MaxComponent(Max(reach_, origin)), pError);
}

SurfacePoint Quadric::SurfaceOnRay(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray) const {
    SurfacePoint s = Surface(primitive, hit);
    const glm::dvec3 origin(ray.o), direction(ray.d);
    const Roots roots = ObjectIntersect(toObject_ * (origin - origin_), toObject_ * direction);
    if (roots.count == 0) return s;  // a grazing ray moved off the surface by rounding
    const double t = double(hit.t), first = roots.t[0], last = roots.t[roots.count - 1];
    s.p = Point3(origin + (std::abs(last - t) < std::abs(first - t) ? last : first) * direction);
    // One rounding of the point; Intersect and the line above lose some of a double's 53 bits.
    s.pError = Gamma(2) * Abs(s.p) + 0x1p-40f * (reach_ + Abs(ray.o));
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
    const Normal3 placed = renderFromObject_.Normal(at.n);
    s.dndu = side * UnitNormalDerivative(placed, renderFromObject_.Normal(at.dndu));
    s.dndv = side * UnitNormalDerivative(placed, renderFromObject_.Normal(at.dndv));
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

Sphere::Sphere(Float radius, Float zMin, Float zMax, Float phiMax, const Transform &renderFromObject,
               bool reverseOrientation, bool opaque)
    : Quadric(ShapeKind::Sphere, radius, std::clamp(zMin, -radius, radius), std::clamp(zMax, -radius, radius), phiMax,
              renderFromObject, reverseOrientation),
      opaque_(opaque) {
    thetaZMin_ = SafeACos(zMin_ / radius);
    thetaZMax_ = SafeACos(zMax_ / radius);
    center_ = renderFromObject.Point(Point3(0));
    renderRadius_ = radius * Scale();
    SetArea(phiMax_ * radius_ * (zMax_ - zMin_));
    const bool whole = !(zMin_ > -radius_) && !(zMax_ < radius_) && IsFullTurn();
    Float part = whole ? 1 : (zMax_ - zMin_) / (2 * radius_) * (phiMax_ / (2 * Pi));
    coneShare_ = opaque ? part : part / 2;
}

Point2 Sphere::UvOf(const glm::dvec3 &p) const {
    double phi = Azimuth(p.x, p.y), theta = std::atan2(std::sqrt(p.x * p.x + p.y * p.y), p.z);
    double t0 = double(thetaZMin_), t1 = double(thetaZMax_);
    return {Float(phi / double(phiMax_)), Float((theta - t0) / (t1 - t0))};
}

std::optional<Point2> Sphere::Clip(const glm::dvec3 &p) const {
    if ((zMin_ > -radius_ && p.z < double(zMin_)) || (zMax_ < radius_ && p.z > double(zMax_))) return {};
    if (CutsAzimuth(Azimuth(p.x, p.y))) return {};
    Point2 uv = UvOf(p);
    return Point2(std::clamp(uv.x, Float(0), Float(1)), std::clamp(uv.y, Float(0), Float(1)));
}

Quadric::ObjectPoint Sphere::PointAt(const Point2 &uv) const {
    double phi = double(uv.x) * double(phiMax_);
    double theta = double(thetaZMin_) + double(uv.y) * (double(thetaZMax_) - double(thetaZMin_));
    double sinTheta = std::sin(theta), cosTheta = std::cos(theta), r = double(radius_);
    auto cosPhi = Float(std::cos(phi)), sinPhi = Float(std::sin(phi));
    Float ring = Float(r * sinTheta), z = Float(r * cosTheta);

    ObjectPoint at;
    at.p = {ring * cosPhi, ring * sinPhi, z};
    at.pError = Gamma(5) * Abs(at.p);
    at.n = at.p / radius_;
    // dpdu vanishes at the poles; as in stock pbrt-v4, the ring has at least this radius for it.
    Float ringForFrame = std::max(ring, Float(1e-5) * radius_);
    Float dTheta = thetaZMax_ - thetaZMin_;
    Vector3 outward(cosPhi, sinPhi, 0), around(-sinPhi, cosPhi, 0);
    at.dpdu = around * (phiMax_ * ringForFrame);
    at.dpdv = (outward * z - Vector3(0, 0, ring)) * dTheta;
    NormalDerivatives(at.dpdu, at.dpdv, -outward * (phiMax_ * phiMax_ * ringForFrame), around * (dTheta * z * phiMax_),
                      at.p * (-dTheta * dTheta), at.n, &at.dndu, &at.dndv);
    return at;
}

ShapeSample Sphere::SampleObject(const Point2 &u) const {
    Float z = Lerp(u.x, zMax_, zMin_), phi = u.y * phiMax_, ring = SafeSqrt(radius_ * radius_ - z * z);
    ShapeSample at;
    at.n = Normalize(Vector3(ring * std::cos(phi), ring * std::sin(phi), z));
    at.p = at.n * radius_;
    at.pError = Gamma(5) * Abs(at.p);
    at.uv = {u.y, UvOf(glm::dvec3(at.p)).y};
    return at;
}

std::optional<Sphere::Cone> Sphere::ConeFrom(const ShapeSampleContext &from) const {
    if (!IsSimilarity()) return {};
    Point3 o = from.OffsetOrigin(center_ - from.p);
    if (DistanceSquared(o, center_) <= renderRadius_ * renderRadius_) return {};
    Float distance = Distance(from.p, center_);
    Float sinMax = renderRadius_ / distance;
    if (!(sinMax < 1)) return {};
    Float sin2Max = sinMax * sinMax;
    // Form of 1 - cos that is accurate for small spheres.
    return Cone{distance, sinMax, sin2Max / (1 + SafeSqrt(1 - sin2Max))};
}

ShapeSample Sphere::SampleNearSide(const Cone &cone, const ShapeSampleContext &from, const Point2 &u) const {
    // theta: angle between direction and axis at the reference point. alpha: angle of the hit at the centre; from the
    // triangle point - centre - hit.
    Float h = u.x * cone.oneMinusCosThetaMax;  // 1 - cos(theta)
    Float sin2Theta = h * (2 - h), cosTheta = 1 - h;
    Float sin2Ratio = std::min(Float(1), sin2Theta / (cone.sinThetaMax * cone.sinThetaMax));
    Float cosAlpha = sin2Theta / cone.sinThetaMax + cosTheta * SafeSqrt(1 - sin2Ratio);
    Float sinAlpha = SafeSqrt(1 - cosAlpha * cosAlpha);
    Frame frame = Frame::FromZ((from.p - center_) / cone.distance);
    Normal3 n = Normalize(frame.FromLocal(SphericalDirectionOfTurn(sinAlpha, cosAlpha, u.y)));

    ShapeSample s{.p = center_ + n * renderRadius_, .pError = Gamma(5) * (Abs(center_) + Abs(n * renderRadius_))};
    Point3 objectPoint = RenderFromObject().InverseVector(n);
    s.uv = UvOf(glm::dvec3(objectPoint));
    s.n = RenderNormal(objectPoint);
    s.pdf = cone.Pdf();
    return s;
}

std::optional<ShapeSample> Sphere::SampleFirstHit(const Cone &cone, const ShapeSampleContext &from,
                                                  const Point2 &u) const {
    Float h = u.x * cone.oneMinusCosThetaMax;  // 1 - cos(theta)
    Frame frame = Frame::FromZ((center_ - from.p) / cone.distance);
    Vector3 wi = frame.FromLocal(SphericalDirectionOfTurn(SafeSqrt(h * (2 - h)), 1 - h, u.y));
    std::optional<PrimitiveHit> hit = Intersect(0, {from.p, wi}, 0);
    if (!hit) return {};
    SurfacePoint at = Surface(0, *hit);
    return ShapeSample{at.p, at.pError, at.n, at.uv, 0};
}

bool Sphere::IsMetFirst(const ShapeSampleContext &from, const Vector3 &wi, const Point3 &p) const {
    Float middle = Dot(center_ - from.p, wi);  // of the chord
    if (Dot(p - from.p, wi) <= middle) return true;
    std::optional<PrimitiveHit> hit = Intersect(0, {from.p, wi}, 0);
    return hit && hit->t > middle;
}

std::optional<ShapeSample> Sphere::Sample(uint32_t primitive, const ShapeSampleContext &from, const Point2 &u) const {
    std::optional<Cone> cone = ConeFrom(from);
    if (!cone) return Shape::Sample(primitive, from, u);
    if (coneShare_ == 1) return SampleNearSide(*cone, from, u);

    const bool byCone = u.x < coneShare_;
    Float rest = byCone ? u.x / coneShare_ : (u.x - coneShare_) / (1 - coneShare_);
    Point2 v(std::min(rest, OneMinusEpsilon), u.y);
    std::optional<ShapeSample> s = byCone ? SampleFirstHit(*cone, from, v) : SampleArea(primitive, v);
    if (!s) return {};
    Vector3 wi = Normalize(s->p - from.p);
    const bool metFirst = byCone || IsMetFirst(from, wi, s->p);
    if (opaque_ && !metFirst) return {};  // hidden by a nearer part of the sphere
    s->pdf = (1 - coneShare_) * Shape::PdfSolidAngle(primitive, from, wi, s->p, s->n);
    if (metFirst) s->pdf += coneShare_ * cone->Pdf();
    return s;
}

Float Sphere::PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi, const Point3 &pHit,
                            const Normal3 &nHit) const {
    std::optional<Cone> cone = ConeFrom(from);
    if (!cone) return Shape::PdfSolidAngle(primitive, from, wi, pHit, nHit);
    if (coneShare_ == 1) return cone->Pdf();
    Float pdf = (1 - coneShare_) * Shape::PdfSolidAngle(primitive, from, wi, pHit, nHit);
    if (opaque_ || IsMetFirst(from, wi, pHit)) pdf += coneShare_ * cone->Pdf();
    return pdf;
}

}  // namespace pbrt
