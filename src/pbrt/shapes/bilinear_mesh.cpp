#include "pbrt/shapes/bilinear_mesh.h"

#include <array>

#include "pbrt/math/frame.h"
#include "pbrt/math/warps.h"
#include "pbrt/shapes/solid_angle_sampling.h"

namespace pbrt {
namespace {

template <class T>
T Bilerp(const Point2 &uv, const T &f00, const T &f10, const T &f01, const T &f11) {
    return (1 - uv.y) * ((1 - uv.x) * f00 + uv.x * f10) + uv.y * ((1 - uv.x) * f01 + uv.x * f11);
}

/// Texture coordinates (s, t) at a point of a patch and the derivatives of (u, v) with respect to them.
struct TextureCoordinates {
    Point2 value{};
    Vector2 uvPerS{1, 0}, uvPerT{0, 1};

    /// Interpolates the corner coordinates. The derivatives should be the inverse of the matrix d(s, t)/d(u, v). As in
    /// stock pbrt-v4, they are the reciprocals of its entries: exact where s depends on u only and t on v only (or the
    /// reverse), as nearly always.
    static TextureCoordinates At(const Point2 &uv, const Point2 &st00, const Point2 &st10, const Point2 &st01,
                                 const Point2 &st11) {
        const Vector2 perU = Lerp(uv.y, st10, st11) - Lerp(uv.y, st00, st01);
        const Vector2 perV = Lerp(uv.x, st01, st11) - Lerp(uv.x, st00, st10);
        auto inverse = [](Float rate) { return std::abs(rate) < Float(1e-8) ? 0 : 1 / rate; };
        return {
            Bilerp(uv, st00, st10, st01, st11), {inverse(perU.x), inverse(perV.x)}, {inverse(perU.y), inverse(perV.y)}};
    }
    Vector3 AlongS(const Vector3 &perU, const Vector3 &perV) const { return perU * uvPerS.x + perV * uvPerS.y; }
    Vector3 AlongT(const Vector3 &perU, const Vector3 &perV) const { return perU * uvPerT.x + perV * uvPerT.y; }
};

int SolveQuadratic(double a, double b, double c, std::array<double, 2> &x) {
    double discriminant = b * b - 4 * a * c;
    if (!(discriminant >= 0)) return 0;
    double q = -(b + std::copysign(std::sqrt(discriminant), b)) / 2;
    int n = 0;
    if (q != 0) x[n++] = a / q;
    if (c != 0) x[n++] = q / c;
    return n;
}

bool IsNearlyRectangle(const Point3 &p00, const Point3 &p10, const Point3 &p01, const Point3 &p11) {
    if (p00 == p10 || p10 == p11 || p11 == p01 || p01 == p00) return false;
    Vector3 n = RobustUnitCross(p10 - p00, p01 - p00);
    if (!(AbsDot(Normalize(p11 - p00), n) <= Float(1e-5))) return false;
    Point3 center = (p00 + p10 + p01 + p11) / Float(4);
    Float d = DistanceSquared(p00, center);
    for (const Point3 &p : {p10, p01, p11})
        if (!(std::abs(DistanceSquared(p, center) - d) <= Float(1e-4) * d)) return false;
    // With corners in order around a rectangle the patch folds.
    auto offCenter = [&](const Point3 &p) { return DistanceSquared((p00 + p) / Float(2), center); };
    return offCenter(p11) <= std::min(offCenter(p10), offCenter(p01));
}

}  // namespace

Point3 BilinearMesh::Corners::At(const Point2 &uv) const { return Bilerp(uv, p00, p10, p01, p11); }
Vector3 BilinearMesh::Corners::DpDu(Float v) const { return Lerp(v, p10, p11) - Lerp(v, p00, p01); }
Vector3 BilinearMesh::Corners::DpDv(Float u) const { return Lerp(u, p01, p11) - Lerp(u, p00, p10); }
Vector3 BilinearMesh::Corners::Error(const Point2 &uv, const Point3 &p, const Normal3 &n) const {
    // Embree tests parallelograms as two triangles.
    const Float test = uv.x + uv.y < 1 ? PlaneTestError(p00, p10, p01, p) : PlaneTestError(p11, p01, p10, p);
    return Gamma(6) * (Abs(p00) + Abs(p10) + Abs(p01) + Abs(p11)) + test * Abs(n);
}
void BilinearMesh::Corners::AreaWeights(Float w[4]) const {
    for (int i = 0; i < 4; ++i) w[i] = CrossLength(DpDu(Float(i >> 1)), DpDv(Float(i & 1)));
}

BilinearMesh::BilinearMesh(MeshData data, const Transform &renderFromObject, bool reverseOrientation,
                           std::shared_ptr<const PiecewiseConstant2D> emission)
    : Mesh(ShapeKind::BilinearMesh, 4, std::move(data), renderFromObject, reverseOrientation),
      isRectangle_(PrimitiveCount()), emission_(std::move(emission)) {
    PBRT_CHECK(!emission_ || mesh_.uv.empty());
    for (uint32_t i = 0; i < PrimitiveCount(); ++i) {
        Corners c = CornersOf(i);
        isRectangle_[i] = IsNearlyRectangle(c.p00, c.p10, c.p01, c.p11);
    }
}

BilinearMesh::Corners BilinearMesh::CornersOf(uint32_t primitive) const {
    const uint32_t *v = &mesh_.indices[4 * size_t(primitive)];
    return {mesh_.p[v[0]], mesh_.p[v[1]], mesh_.p[v[2]], mesh_.p[v[3]]};
}

template <class T>
T BilinearMesh::AtCorners(const std::vector<T> &values, uint32_t primitive, const Point2 &uv) const {
    const uint32_t *v = &mesh_.indices[4 * size_t(primitive)];
    return Bilerp(uv, values[v[0]], values[v[1]], values[v[2]], values[v[3]]);
}

bool BilinearMesh::IsParallelogram(uint32_t primitive) const {
    Corners c = CornersOf(primitive);
    Vector3 gap = Abs((c.p11 - c.p10) - (c.p01 - c.p00));
    Vector3 size = Max(Max(Abs(c.p00), Abs(c.p10)), Max(Abs(c.p01), Abs(c.p11)));
    return glm::all(glm::lessThanEqual(gap, 2 * MachineEpsilon * size));
}

Bounds3 BilinearMesh::PrimitiveBounds(uint32_t primitive) const {
    Corners c = CornersOf(primitive);
    return RoundedBounds(Union(Bounds3(c.p00, c.p10), Bounds3(c.p01, c.p11)));
}

Float BilinearMesh::Area(uint32_t primitive) const {
    Corners c = CornersOf(primitive);
    if (IsRectangle(primitive)) return Distance(c.p00, c.p01) * Distance(c.p00, c.p10);
    // Stock pbrt-v4's approximation by 3 x 3 flat pieces, because it defines emitted power.
    constexpr int kPieces = 3;
    Point3 p[kPieces + 1][kPieces + 1];
    for (int i = 0; i <= kPieces; ++i)
        for (int j = 0; j <= kPieces; ++j) p[i][j] = c.At({Float(i) / kPieces, Float(j) / kPieces});
    Float area = 0;
    for (int i = 0; i < kPieces; ++i)
        for (int j = 0; j < kPieces; ++j) area += CrossLength(p[i + 1][j + 1] - p[i][j], p[i + 1][j] - p[i][j + 1]) / 2;
    return area;
}

Normal3 BilinearMesh::OrientedNormal(uint32_t primitive, const Corners &c, const Point2 &uv) const {
    const Normal3 face = RobustUnitCross(c.DpDu(uv.y), c.DpDv(uv.x)), n = flipNormal_ ? -face : face;
    if (mesh_.n.empty()) return n;
    return FaceForward(n, AtCorners(mesh_.n, primitive, uv));
}

DirectionCone BilinearMesh::NormalBounds(uint32_t primitive) const {
    // The unnormalised normal is linear in (u, v), so all normals lie between those of the corners.
    Corners c = CornersOf(primitive);
    DirectionCone cone;
    for (Point2 uv : {Point2(0, 0), Point2(1, 0), Point2(0, 1), Point2(1, 1)}) {
        if (Cross(c.DpDu(uv.y), c.DpDv(uv.x)) == Vector3(0)) continue;  // two corners coincide
        cone = Union(cone, {OrientedNormal(primitive, c, uv), 1});
    }
    return cone.IsEmpty() ? DirectionCone::EntireSphere() : cone;
}

struct BilinearMesh::PatchHit {
    double t, u, v;

    /// The hit in (tMin, tMax) nearest to `at`; u and v may leave [0, 1] by `slack`.
    static std::optional<PatchHit> Nearest(const BilinearMesh &mesh, uint32_t primitive, const Ray &ray, double tMin,
                                           double tMax, double at, double slack) {
        // For fixed u the patch is a line; the ray meets it where both are coplanar, a quadratic in u. Double precision
        // separates close roots of low curvature and keeps shared edges watertight.
        using D = glm::dvec3;
        const D p00 = mesh.ExactCorner(primitive, 0), p01 = mesh.ExactCorner(primitive, 2);
        D dir(ray.d), a0 = p00 - D(ray.o), da = mesh.ExactCorner(primitive, 1) - p00, e0 = p01 - p00;
        D de = (mesh.ExactCorner(primitive, 3) - p01) - da;
        D a0d = glm::cross(a0, dir), dad = glm::cross(da, dir);
        std::array<double, 2> roots{};
        int n = SolveQuadratic(glm::dot(e0, a0d), glm::dot(de, a0d) + glm::dot(e0, dad), glm::dot(de, dad), roots);

        // Cross products lose at most 2^-46 of the patch's size; planes through the origin are not hit at it.
        const D size = glm::abs(a0) + glm::abs(da) + glm::abs(e0) + glm::abs(de), length = glm::abs(dir);
        tMin += 0x1p-46 * std::max({size.x, size.y, size.z}) / std::max({length.x, length.y, length.z});
        std::optional<PatchHit> best;
        for (int i = 0; i < n; ++i) {
            double u = roots[i];
            if (!(u >= -slack && u <= 1 + slack)) continue;
            D a = a0 + u * da, e = e0 + u * de;
            D ed = glm::cross(e, dir);
            double ed2 = glm::dot(ed, ed);
            if (!(ed2 > 0)) continue;
            double v = -glm::dot(glm::cross(a, dir), ed) / ed2;
            double t = -glm::dot(glm::cross(a, e), ed) / ed2;
            // Refined with the tangent plane, which is exact along the axes.
            const D normal = glm::cross(da + v * de, e);
            const double slope = glm::dot(normal, dir);
            if (std::abs(slope) > 1e-7 * glm::length(normal) * glm::length(dir))
                t = glm::dot(normal, a + v * e) / slope;
            if (!(v >= -slack && v <= 1 + slack && t > tMin && t < tMax)) continue;
            if (best && !(std::abs(t - at) < std::abs(best->t - at))) continue;
            best = PatchHit{t, u, v};
        }
        return best;
    }
};

std::optional<PrimitiveHit> BilinearMesh::Intersect(uint32_t primitive, const Ray &ray, Float tMin) const {
    const std::optional<PatchHit> hit =
        PatchHit::Nearest(*this, primitive, ray, double(tMin), double(ray.tMax), double(tMin), 1e-9);
    if (!hit) return {};
    return PrimitiveHit{Float(hit->t), Float(std::clamp(hit->u, 0.0, 1.0)), Float(std::clamp(hit->v, 0.0, 1.0))};
}

PrimitiveHit BilinearMesh::Completed(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray) const {
    if (!IsAtCorner(hit)) [[likely]]
        return hit;
    constexpr double kSlack = 1e-3;  ///< beyond the edges, for the rounding of rays in an instance's space
    const std::optional<PatchHit> at =
        PatchHit::Nearest(*this, primitive, ray, 0, double(Infinity), double(hit.t), kSlack);
    if (!at) return hit;
    return {hit.t, Float(std::clamp(at->u, 0.0, 1.0)), Float(std::clamp(at->v, 0.0, 1.0))};
}

SurfacePoint BilinearMesh::SurfaceInInstance(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray,
                                             const Vector3 &distance) const {
    SurfacePoint s = Surface(primitive, Completed(primitive, hit, ray));
    const Corners c = CornersOf(primitive);
    const Vector3 span = Abs(c.p10 - c.p00) + Abs(c.p01 - c.p00) + Abs(c.p11 - c.p00);
    if (!IsTracedInDouble() && !IsLarge(span, distance)) return s;
    if (const auto at =
            PatchHit::Nearest(*this, primitive, ray, 0, double(Infinity), double(hit.t), kLargePrimitiveSlack)) {
        auto corner = [&](size_t i) { return ExactCorner(primitive, i); };
        const glm::dvec3 p0 = glm::mix(corner(0), corner(1), at->u), p1 = glm::mix(corner(2), corner(3), at->u);
        SetExactPoint(s, glm::mix(p0, p1, at->v), ray.o);
    }
    return s;
}

Point2 BilinearMesh::Uv(uint32_t primitive, const PrimitiveHit &hit) const {
    Point2 uv(hit.u, hit.v);
    return mesh_.uv.empty() ? uv : AtCorners(mesh_.uv, primitive, uv);
}

SurfacePoint BilinearMesh::Surface(uint32_t primitive, const PrimitiveHit &hit) const {
    Corners c = CornersOf(primitive);
    Point2 uv(std::clamp(hit.u, Float(0), Float(1)), std::clamp(hit.v, Float(0), Float(1)));
    SurfacePoint s;
    s.primitive = primitive;
    s.p = c.At(uv);
    s.uv = uv;
    s.dpdu = c.DpDu(uv.y);
    s.dpdv = c.DpDv(uv.x);

    // Given texture coordinates (s, t) replace (u, v), unless they do not span the tangent plane.
    TextureCoordinates st;
    Vector3 tangents[2] = {s.dpdu, s.dpdv};
    if (!mesh_.uv.empty()) {
        const uint32_t *v = &mesh_.indices[4 * size_t(primitive)];
        st = TextureCoordinates::At(uv, mesh_.uv[v[0]], mesh_.uv[v[1]], mesh_.uv[v[2]], mesh_.uv[v[3]]);
        s.uv = st.value;
        const Vector3 alongS = st.AlongS(s.dpdu, s.dpdv), alongT = st.AlongT(s.dpdu, s.dpdv);
        const Vector3 normal = Cross(alongS, alongT);
        const bool mirrored = Dot(Cross(s.dpdu, s.dpdv), normal) < 0;
        if (normal != Vector3(0)) {
            tangents[0] = alongS;
            tangents[1] = mirrored ? -alongT : alongT;
        }
    }
    const Normal3 face = RobustUnitCross(s.dpdu, s.dpdv);
    s.pError = c.Error(uv, s.p, face);
    Vector3 twist = (c.p00 - c.p01) + (c.p11 - c.p10);
    Normal3 dndu, dndv;
    NormalDerivatives(s.dpdu, s.dpdv, Vector3(0), twist, Vector3(0), face, &dndu, &dndv);
    s.dndu = st.AlongS(dndu, dndv);
    s.dndv = st.AlongT(dndu, dndv);
    s.dpdu = tangents[0];
    s.dpdv = tangents[1];
    s.n = flipNormal_ ? -face : face;
    s.shading = {s.n, s.dpdu, s.dpdv, s.dndu, s.dndv};
    if (mesh_.n.empty()) return s;

    const uint32_t *v = &mesh_.indices[4 * size_t(primitive)];
    const Normal3 &n00 = mesh_.n[v[0]], &n10 = mesh_.n[v[1]], &n01 = mesh_.n[v[2]], &n11 = mesh_.n[v[3]];
    const Normal3 n = Bilerp(uv, n00, n10, n01, n11);
    if (!(LengthSquared(n) > 0)) return s;
    const Normal3 ns = Normalize(n);
    dndu = UnitNormalDerivative(n, Lerp(uv.y, n10, n11) - Lerp(uv.y, n00, n01));
    dndv = UnitNormalDerivative(n, Lerp(uv.x, n01, n11) - Lerp(uv.x, n00, n10));
    s.shading.dndu = st.AlongS(dndu, dndv);
    s.shading.dndv = st.AlongT(dndu, dndv);
    s.n = FaceForward(s.n, ns);
    s.shading.dpdu = RotateFromTo(s.n, ns, s.dpdu);
    s.shading.dpdv = RotateFromTo(s.n, ns, s.dpdv);
    s.shading.n = ns;
    return s;
}

Point2 BilinearMesh::Parameters(const Corners &c, const Point3 &p, const Normal3 &n) const {
    // Solved in the coordinate plane that the patch faces most: p = p00 + u E + v F + uv G without u is quadratic.
    using D2 = glm::dvec2;
    Vector3 an = Abs(n);
    int drop = an.x > an.y && an.x > an.z ? 0 : an.y > an.z ? 1 : 2;
    int ix = drop == 0 ? 1 : 0, iy = drop == 2 ? 1 : 2;
    auto flat = [&](const Vector3 &v) { return D2(v[ix], v[iy]); };
    auto cross = [](const D2 &a, const D2 &b) { return a.x * b.y - a.y * b.x; };
    D2 o = flat(c.p00), e = flat(c.p10) - o, f = flat(c.p01) - o, g = flat(c.p11) - flat(c.p01) - e, h = flat(p) - o;
    std::array<double, 2> roots{};
    int count = SolveQuadratic(cross(h, e), cross(e, f) + cross(h, g), cross(g, f), roots);
    Point2 best(Float(0.5));
    double bestError = std::numeric_limits<double>::infinity();
    for (int i = 0; i < count; ++i) {
        double v = std::clamp(roots[i], 0.0, 1.0);
        D2 along = e + v * g, rest = h - v * f;
        double u = std::abs(along.x) > std::abs(along.y) ? rest.x / along.x : rest.y / along.y;
        if (!std::isfinite(u)) continue;
        Point2 uv(Float(std::clamp(u, 0.0, 1.0)), static_cast<Float>(v));
        double error = double(DistanceSquared(c.At(uv), p));
        if (error < bestError) {
            bestError = error;
            best = uv;
        }
    }
    return best;
}

Float BilinearMesh::PdfArea(uint32_t primitive, const Corners &c, const Point2 &uv) const {
    Float density = 1;
    if (emission_) {
        density = emission_->Pdf(uv);
    } else if (!IsRectangle(primitive)) {
        Float w[4];
        c.AreaWeights(w);
        density = BilinearPdf(uv, w);
    }
    return density / CrossLength(c.DpDu(uv.y), c.DpDv(uv.x));
}

ShapeSample BilinearMesh::SampleAt(uint32_t primitive, const Corners &c, const Point2 &uv) const {
    ShapeSample s;
    s.p = c.At(uv);
    s.n = OrientedNormal(primitive, c, uv);
    s.pError = c.Error(uv, s.p, s.n);
    s.uv = mesh_.uv.empty() ? uv : AtCorners(mesh_.uv, primitive, uv);
    return s;
}

std::optional<ShapeSample> BilinearMesh::SampleArea(uint32_t primitive, const Point2 &u) const {
    Corners c = CornersOf(primitive);
    Point2 uv = u;
    if (emission_) {
        uv = emission_->Sample(u).p;
    } else if (!IsRectangle(primitive)) {
        Float w[4];
        c.AreaWeights(w);
        if (!(w[0] + w[1] + w[2] + w[3] > 0)) return {};
        uv = SampleBilinear(u, w);
    }
    ShapeSample s = SampleAt(primitive, c, uv);
    s.pdf = PdfArea(primitive, c, uv);
    if (!std::isfinite(s.pdf)) return {};
    return s;
}

Float BilinearMesh::PdfArea(uint32_t primitive, const Point3 &p, const Normal3 &n) const {
    const Corners c = CornersOf(primitive);
    const Float pdf = PdfArea(primitive, c, Parameters(c, p, n));
    return std::isfinite(pdf) ? pdf : 0;
}

std::optional<ShapeSample> BilinearMesh::Sample(uint32_t primitive, const ShapeSampleContext &from,
                                                const Point2 &u) const {
    if (!IsRectangle(primitive) || emission_) return Shape::Sample(primitive, from, u);
    Corners c = CornersOf(primitive);
    const RectangleSampling::Point at = RectangleSampling(from, c.p00, c.p10 - c.p00, c.p01 - c.p00).Sample(u);
    if (!(at.pdf > 0 && std::isfinite(at.pdf))) return {};
    ShapeSample s = SampleAt(primitive, c, at.st);
    s.pdf = at.pdf;
    return s;
}

Float BilinearMesh::PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi,
                                  const Point3 &pHit, const Normal3 &nHit) const {
    if (!IsRectangle(primitive) || emission_) return Shape::PdfSolidAngle(primitive, from, wi, pHit, nHit);
    const Corners c = CornersOf(primitive);
    const Float pdf = RectangleSampling(from, c.p00, c.p10 - c.p00, c.p01 - c.p00).Pdf(pHit);
    return std::isfinite(pdf) ? pdf : 0;
}

}  // namespace pbrt
