#include "pbrt/shapes/sphere.h"

#include "pbrt/math/frame.h"
#include "pbrt/math/warps.h"
#include "pbrt/shapes/weingarten.h"

namespace pbrt {

Sphere::Sphere(Float radius, Float zMin, Float zMax, Float phiMax, const Transform &renderFromObject,
               bool reverseOrientation)
    : Quadric(renderFromObject, reverseOrientation),
      radius_(radius) {
    zMin_ = std::clamp(std::min(zMin, zMax), -radius, radius);
    zMax_ = std::clamp(std::max(zMin, zMax), -radius, radius);
    thetaZMin_ = SafeACos(zMin_ / radius);
    thetaZMax_ = SafeACos(zMax_ / radius);
    phiMax_ = Radians(std::clamp(phiMax, Float(0), Float(360)));
    center_ = renderFromObject.Point(Point3(0));
    renderRadius_ = radius * Scale();
    SetArea(phiMax_ * radius_ * (zMax_ - zMin_));
}

Bounds3 Sphere::ObjectBounds() const { return {Point3(-radius_, -radius_, zMin_), Point3(radius_, radius_, zMax_)}; }

Quadric::Roots Sphere::ObjectIntersect(const glm::dvec3 &o, const glm::dvec3 &d) const {
    // Distance of the line from the centre decides; the roots lie symmetrically about the nearest point (parameter m).
    double a = glm::dot(d, d), m = -glm::dot(o, d) / a, r = double(radius_);
    glm::dvec3 nearest = o + m * d;
    double rest = r * r - glm::dot(nearest, nearest);
    if (!(rest >= 0)) return {};
    double half = std::sqrt(rest / a), far = m >= 0 ? m + half : m - half;
    // The root nearer to the origin from the product of the roots, which does not cancel.
    double near = far != 0 ? (glm::dot(o, o) - r * r) / (a * far) : 0;
    return {2, {std::min(near, far), std::max(near, far)}};
}

Point2 Sphere::UvOf(const glm::dvec3 &p) const {
    double phi = Azimuth(p.x, p.y), theta = std::atan2(std::sqrt(p.x * p.x + p.y * p.y), p.z);
    double t0 = double(thetaZMin_), t1 = double(thetaZMax_);
    return {static_cast<Float>(phi / double(phiMax_)), static_cast<Float>((theta - t0) / (t1 - t0))};
}

std::optional<Point2> Sphere::Clip(const glm::dvec3 &p) const {
    if ((zMin_ > -radius_ && p.z < double(zMin_)) || (zMax_ < radius_ && p.z > double(zMax_))) return {};
    if (CutsAzimuth(phiMax_, Azimuth(p.x, p.y))) return {};
    Point2 uv = UvOf(p);
    return Point2(std::clamp(uv.x, Float(0), Float(1)), std::clamp(uv.y, Float(0), Float(1)));
}

Quadric::ObjectPoint Sphere::PointAt(const Point2 &uv) const {
    double phi = double(uv.x) * double(phiMax_);
    double theta = double(thetaZMin_) + double(uv.y) * (double(thetaZMax_) - double(thetaZMin_));
    double sinTheta = std::sin(theta), cosTheta = std::cos(theta), r = double(radius_);
    auto cosPhi = static_cast<Float>(std::cos(phi)), sinPhi = static_cast<Float>(std::sin(phi));
    Float ring = static_cast<Float>(r * sinTheta), z = static_cast<Float>(r * cosTheta);

    ObjectPoint at;
    at.p = {ring * cosPhi, ring * sinPhi, z};
    at.pError = Gamma(5) * Abs(at.p);
    at.n = at.p / radius_;
    // dpdu vanishes at the poles; stock pbrt-v4 steps aside by this much there.
    Float ringForFrame = std::max(ring, Float(1e-5) * radius_);
    Float dTheta = thetaZMax_ - thetaZMin_;
    Vector3 outward(cosPhi, sinPhi, 0), around(-sinPhi, cosPhi, 0);
    at.dpdu = around * (phiMax_ * ringForFrame);
    at.dpdv = (outward * z - Vector3(0, 0, ring)) * dTheta;
    NormalDerivatives(at.dpdu, at.dpdv, -outward * (phiMax_ * phiMax_ * ringForFrame), around * (dTheta * z * phiMax_),
                      at.p * (-dTheta * dTheta), at.n, &at.dndu, &at.dndv);
    return at;
}

Quadric::ObjectSample Sphere::SampleObject(const Point2 &u) const {
    ObjectSample at;
    at.n = SampleUniformSphere(u);
    at.p = at.n * (radius_ / Length(at.n));
    at.pError = Gamma(5) * Abs(at.p);
    at.uv = UvOf(glm::dvec3(at.p));
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
    // 1 - cos written so that it keeps its digits for small spheres.
    return Cone{distance, sinMax, sin2Max / (1 + SafeSqrt(1 - sin2Max))};
}

std::optional<ShapeSample> Sphere::Sample(uint32_t primitive, const ShapeSampleContext &from, const Point2 &u) const {
    std::optional<Cone> cone = ConeFrom(from);
    if (!cone) return Quadric::Sample(primitive, from, u);
    // theta: angle of the direction from the axis, seen from the point. alpha: angle of the hit from the axis, seen
    // from the centre; both follow from the triangle point - centre - hit.
    Float h = u.x * cone->oneMinusCosThetaMax;  // 1 - cos(theta)
    Float sin2Theta = h * (2 - h), cosTheta = 1 - h;
    Float sin2Ratio = std::min(Float(1), sin2Theta / (cone->sinThetaMax * cone->sinThetaMax));
    Float cosAlpha = sin2Theta / cone->sinThetaMax + cosTheta * SafeSqrt(1 - sin2Ratio);
    Float sinAlpha = SafeSqrt(1 - cosAlpha * cosAlpha);
    Frame frame = Frame::FromZ((from.p - center_) / cone->distance);
    Normal3 n = Normalize(frame.FromLocal(SphericalDirection(sinAlpha, cosAlpha, 2 * Pi * u.y)));

    ShapeSample s;
    s.p = center_ + n * renderRadius_;
    s.pError = Gamma(5) * (Abs(center_) + Abs(n * renderRadius_));
    Point3 objectPoint = RenderFromObject().InverseVector(n);
    s.uv = UvOf(glm::dvec3(objectPoint));
    s.n = SampleNormal(objectPoint);
    s.pdf = 1 / (2 * Pi * cone->oneMinusCosThetaMax);
    return s;
}

Float Sphere::PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi, const Point3 &pHit,
                            const Normal3 &nHit) const {
    std::optional<Cone> cone = ConeFrom(from);
    if (!cone) return Quadric::PdfSolidAngle(primitive, from, wi, pHit, nHit);
    return 1 / (2 * Pi * cone->oneMinusCosThetaMax);
}

}  // namespace pbrt
