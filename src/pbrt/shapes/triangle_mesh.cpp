#include "pbrt/shapes/triangle_mesh.h"

#include "pbrt/core/error.h"
#include "pbrt/math/warps.h"
#include "pbrt/shapes/solid_angle_sampling.h"

namespace pbrt {
namespace {

constexpr size_t kMaxExactPrimitives = 8192;  ///< as tracing in double precision takes longer

Vector3 HitBarycentrics(const PrimitiveHit &hit) { return {std::max(Float(0), 1 - hit.u - hit.v), hit.u, hit.v}; }

[[gnu::always_inline]] inline Normal3 FaceNormal(const Point3 &p0, const Point3 &p1, const Point3 &p2) {
    return RobustUnitCross(p1 - p0, p2 - p0);
}

/// Transforms normals of any lengths, scaled by one power of two if their squares could leave single precision.
void PlaceNormals(const Transform &place, std::vector<Normal3> &normals) {
    const glm::dmat3 inverse(glm::mat3(place.InverseMatrix()));
    double largest = 0;
    for (const Normal3 &n : normals) {
        const glm::dvec3 placed = glm::abs(glm::dvec3(n) * inverse);
        largest = std::max({largest, placed.x, placed.y, placed.z});
    }
    if (largest == 0 || (largest > 0x1p-50 && largest < 0x1p50)) {
        if (!place.IsIdentity())
            for (Normal3 &n : normals) n = place.Normal(n);
        return;
    }
    const double scale = std::ldexp(1.0, -std::ilogb(largest));
    for (Normal3 &n : normals) n = Normal3(glm::dvec3(n) * inverse * scale);
}

}  // namespace

Mesh::Mesh(ShapeKind kind, size_t cornerCount, MeshData data, const Transform &renderFromObject,
           bool reverseOrientation)
    : Shape(kind), mesh_(std::move(data)), cornerCount_(cornerCount),
      flipNormal_(reverseOrientation != renderFromObject.SwapsHandedness()), origin_(renderFromObject.Matrix()[3]) {
    PBRT_CHECK(mesh_.indices.size() % cornerCount == 0);
    for (uint32_t i : mesh_.indices) PBRT_CHECK_MSG(i < mesh_.p.size(), "index {} of {}", i, mesh_.p.size());
    PlaceNormals(renderFromObject, mesh_.n);
    if (PrimitiveCount() <= kMaxExactPrimitives)
        for (const Point3 &p : mesh_.p) exact_.emplace_back(glm::dmat4(renderFromObject.Matrix()) * glm::dvec4(p, 1));
    if (!renderFromObject.IsIdentity()) {
        for (Point3 &p : mesh_.p) p = renderFromObject.Point(p);
        for (Vector3 &s : mesh_.s) s = renderFromObject.Vector(s);
    }
    if (!exact_.empty() && !HasVisibleTestError()) exact_ = {};
    if (reverseOrientation)
        for (Normal3 &n : mesh_.n) n = -n;
    mesh_.p.reserve(mesh_.p.size() + 1);
}

bool Mesh::IsInPlane(uint32_t primitive, const Point3 &p, const Vector3 &pError) const {
    using D = glm::dvec3;
    const D p0 = ExactCorner(primitive, 0);
    const D n = glm::cross(ExactCorner(primitive, 1) - p0, ExactCorner(primitive, 2) - p0);
    Vector3 reach(0);
    for (size_t i = 0; i < cornerCount_; ++i) reach = Max(reach, Abs(Vector3(ExactCorner(primitive, i))));
    // Of corners in double precision, the object's origin and axes are rounded; products lose some of their 53 bits.
    const Vector3 rounded = isTracedInDouble_ ? Abs(p) + Abs(origin_) + 0x1p-20f * reach : reach;
    for (size_t i = 0; i < cornerCount_; ++i) {
        const double height = glm::dot(n, D(p) - ExactCorner(primitive, i));
        if (!IsRounding(height, n, rounded, MaxComponent(reach), pError)) return false;
    }
    return n != D(0);
}

bool Mesh::HasVisibleTestError() const {
    constexpr Float kVisible = 0x1p-14f;  ///< relative to the distance from the camera
    for (size_t i = 0; i < mesh_.indices.size(); i += cornerCount_) {
        const uint32_t *v = &mesh_.indices[i];
        const Point3 &p0 = mesh_.p[v[0]], &p1 = mesh_.p[v[1]], &p2 = mesh_.p[v[2]];
        const Float error = std::max(PlaneTestError(p0, p1, p2, p1), PlaneTestError(p0, p1, p2, p2));
        if (!(error > kVisible * AbsDot(FaceNormal(p0, p1, p2), p0))) continue;
        Bounds3 bounds;
        for (size_t k = 0; k < cornerCount_; ++k) bounds = Union(bounds, mesh_.p[v[k]]);
        if (error > kVisible * Length(Max(Max(bounds.low, -bounds.high), Vector3(0)))) return true;
    }
    return false;
}

void Mesh::SetExactPoint(SurfacePoint &s, const glm::dvec3 &p, const Point3 &o) const {
    s.p = Point3(p);
    if (!isTracedInDouble_) {
        const bool isAxisAligned = (s.n.x == 0) + (s.n.y == 0) + (s.n.z == 0) == 2;
        if (isAxisAligned) s.pError = Gamma(7) * Abs(s.p);  // Embree's test is exact
        return;
    }
    const Bounds3 bounds = PrimitiveBounds(s.primitive);
    // One rounding of the point; Intersect loses some of a double's 53 bits.
    s.pError = Gamma(2) * Abs(s.p) + 0x1p-40f * (Max(Abs(bounds.low), Abs(bounds.high)) + Abs(o));
}

Bounds3 Mesh::RoundedBounds(const Bounds3 &b) const {
    if (!isTracedInDouble_) return b;
    return {b.low - Gamma(2) * Abs(b.low), b.high + Gamma(2) * Abs(b.high)};
}

TriangleMesh::TriangleMesh(MeshData data, const Transform &renderFromObject, bool reverseOrientation)
    : Mesh(ShapeKind::TriangleMesh, 3, std::move(data), renderFromObject, reverseOrientation) {
    for (uint32_t i = 0; i < PrimitiveCount(); ++i)
        largestSpan_ = std::max(largestSpan_, MaxComponent(SpanOf(CornersOf(i))));
}

Vector3 TriangleMesh::SpanOf(const Corners &c) { return Abs(c.p1 - c.p0) + Abs(c.p2 - c.p0); }

TriangleMesh::Corners TriangleMesh::CornersOf(uint32_t primitive) const {
    const uint32_t *v = &mesh_.indices[3 * size_t(primitive)];
    return {mesh_.p[v[0]], mesh_.p[v[1]], mesh_.p[v[2]]};
}

Bounds3 TriangleMesh::PrimitiveBounds(uint32_t primitive) const {
    Corners c = CornersOf(primitive);
    return RoundedBounds(Union(Bounds3(c.p0, c.p1), c.p2));
}

Float TriangleMesh::Area(uint32_t primitive) const {
    Corners c = CornersOf(primitive);
    return CrossLength(c.p1 - c.p0, c.p2 - c.p0) / 2;
}

DirectionCone TriangleMesh::NormalBounds(uint32_t primitive) const {
    Corners c = CornersOf(primitive);
    Normal3 n = OrientedNormal(primitive, c, Vector3(1, 0, 0));
    // Vertex normals lie on both sides of the face, and so does its oriented normal.
    for (Vector3 corner : {Vector3(0, 1, 0), Vector3(0, 0, 1)})
        if (Dot(OrientedNormal(primitive, c, corner), n) < 0) return DirectionCone::EntireSphere();
    return {n, 1};
}

Normal3 TriangleMesh::OrientedNormal(uint32_t primitive, const Corners &c, const Vector3 &b) const {
    const Normal3 face = FaceNormal(c.p0, c.p1, c.p2), n = flipNormal_ ? -face : face;
    if (mesh_.n.empty()) return n;
    const uint32_t *v = &mesh_.indices[3 * size_t(primitive)];
    return FaceForward(n, b.x * mesh_.n[v[0]] + b.y * mesh_.n[v[1]] + b.z * mesh_.n[v[2]]);
}

Point2 TriangleMesh::UvAt(uint32_t primitive, const Vector3 &b) const {
    if (mesh_.uv.empty()) return {b.y + b.z, b.z};  // corners (0,0), (1,0), (1,1)
    const uint32_t *v = &mesh_.indices[3 * size_t(primitive)];
    return b.x * mesh_.uv[v[0]] + b.y * mesh_.uv[v[1]] + b.z * mesh_.uv[v[2]];
}

struct TriangleMesh::PlaneHit {
    double t, b1, b2;

    static std::optional<PlaneHit> Of(const TriangleMesh &mesh, uint32_t primitive, const Ray &ray) {
        using D = glm::dvec3;
        const D p0 = mesh.ExactCorner(primitive, 0), e1 = mesh.ExactCorner(primitive, 1) - p0;
        const D e2 = mesh.ExactCorner(primitive, 2) - p0, s = D(ray.o) - p0, dir(ray.d);
        const D k = glm::cross(dir, e2), q = glm::cross(s, e1);
        const double determinant = glm::dot(k, e1);
        if (determinant == 0) return {};
        return PlaneHit{glm::dot(e2, q) / determinant, glm::dot(s, k) / determinant, glm::dot(dir, q) / determinant};
    }
};

std::optional<PrimitiveHit> TriangleMesh::Intersect(uint32_t primitive, const Ray &ray, Float tMin) const {
    const std::optional<PlaneHit> at = PlaneHit::Of(*this, primitive, ray);
    if (!at || !(at->b1 >= 0 && at->b2 >= 0 && at->b1 + at->b2 <= 1) ||
        !(at->t > double(tMin) && at->t < double(ray.tMax)))
        return {};
    return PrimitiveHit{Float(at->t), Float(at->b1), Float(at->b2)};
}

PrimitiveHit TriangleMesh::Completed(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray) const {
    if (!IsAtCorner(hit)) [[likely]]
        return hit;
    const std::optional<PlaneHit> at = PlaneHit::Of(*this, primitive, ray);
    if (!at) return hit;
    const double b1 = std::clamp(at->b1, 0.0, 1.0), b2 = std::clamp(at->b2, 0.0, 1 - b1);
    return {hit.t, Float(b1), Float(b2)};
}

SurfacePoint TriangleMesh::SurfaceInInstance(uint32_t primitive, const PrimitiveHit &hit, const Ray &ray,
                                             const Vector3 &distance) const {
    SurfacePoint s = Surface(primitive, Completed(primitive, hit, ray));
    if (!IsTracedInDouble()) [[likely]] {
        if (!(largestSpan_ > kLargePrimitive * std::min({distance.x, distance.y, distance.z}))) [[likely]]
            return s;
        if (!IsLarge(SpanOf(CornersOf(primitive)), distance)) return s;
    }
    if (const std::optional<PlaneHit> at = PlaneHit::Of(*this, primitive, ray)) {
        const double slack = kLargePrimitiveSlack;
        const double b1 = std::clamp(at->b1, -slack, 1 + slack), b2 = std::clamp(at->b2, -slack, 1 + slack - b1);
        const glm::dvec3 p0 = ExactCorner(primitive, 0);
        SetExactPoint(s, p0 + b1 * (ExactCorner(primitive, 1) - p0) + b2 * (ExactCorner(primitive, 2) - p0), ray.o);
    }
    return s;
}

Point2 TriangleMesh::Uv(uint32_t primitive, const PrimitiveHit &hit) const {
    return UvAt(primitive, HitBarycentrics(hit));
}

SurfacePoint TriangleMesh::Surface(uint32_t primitive, const PrimitiveHit &hit) const {
    Corners c = CornersOf(primitive);
    Vector3 b = HitBarycentrics(hit);
    const uint32_t *v = &mesh_.indices[3 * size_t(primitive)];

    SurfacePoint s;
    s.primitive = primitive;
    s.p = b.x * c.p0 + b.y * c.p1 + b.z * c.p2;
    s.pError = Gamma(7) * (Abs(b.x * c.p0) + Abs(b.y * c.p1) + Abs(b.z * c.p2));
    s.uv = UvAt(primitive, b);

    // Default corner coordinates (0, 0), (1, 0), (1, 1), with determinant 1.
    Vector2 duv02(-1, -1), duv12(0, -1);
    Float inverse = 1;
    bool degenerateUv = false;
    if (!mesh_.uv.empty()) {
        duv02 = mesh_.uv[v[0]] - mesh_.uv[v[2]];
        duv12 = mesh_.uv[v[1]] - mesh_.uv[v[2]];
        const Float determinant = DifferenceOfProducts(duv02.x, duv12.y, duv02.y, duv12.x);
        degenerateUv = std::abs(determinant) < Float(1e-9);
        inverse = degenerateUv ? 0 : 1 / determinant;
    }
    Vector3 dp02 = c.p0 - c.p2, dp12 = c.p1 - c.p2;
    // Derivatives by u and v of a quantity with differences d02 and d12 along the edges from corner 2.
    auto perU = [&](const Vector3 &d02, const Vector3 &d12) { return (duv12.y * d02 - duv02.y * d12) * inverse; };
    auto perV = [&](const Vector3 &d02, const Vector3 &d12) { return (duv02.x * d12 - duv12.x * d02) * inverse; };
    Normal3 face = FaceNormal(c.p0, c.p1, c.p2);
    s.pError += PlaneTestError(c.p0, c.p1, c.p2, s.p) * Abs(face);
    s.dpdu = perU(dp02, dp12);
    s.dpdv = perV(dp02, dp12);
    if (degenerateUv || Cross(s.dpdu, s.dpdv) == Vector3(0)) {
        degenerateUv = true;
        CoordinateSystem(-face, &s.dpdu, &s.dpdv);
    }
    s.n = flipNormal_ ? -face : face;
    s.shading = {s.n, s.dpdu, s.dpdv, Normal3(0), Normal3(0)};
    if (mesh_.n.empty() && mesh_.s.empty()) return s;

    Normal3 ns = s.n;
    if (!mesh_.n.empty()) {
        Normal3 n = b.x * mesh_.n[v[0]] + b.y * mesh_.n[v[1]] + b.z * mesh_.n[v[2]];
        if (LengthSquared(n) > 0) ns = Normalize(n);
        Normal3 dn02 = mesh_.n[v[0]] - mesh_.n[v[2]], dn12 = mesh_.n[v[1]] - mesh_.n[v[2]];
        if (!degenerateUv) {
            s.shading.dndu = UnitNormalDerivative(n, perU(dn02, dn12));
            s.shading.dndv = UnitNormalDerivative(n, perV(dn02, dn12));
        } else if (Normal3 turn = Cross(dn12, dn02); LengthSquared(turn) > 0) {
            CoordinateSystem(Normalize(turn), &s.shading.dndu, &s.shading.dndv);
        }
    }
    Vector3 tangent = s.dpdu;
    if (!mesh_.s.empty()) {
        Vector3 given = b.x * mesh_.s[v[0]] + b.y * mesh_.s[v[1]] + b.z * mesh_.s[v[2]];
        if (LengthSquared(given) > 0) tangent = given;
    }
    Vector3 bitangent = Cross(ns, tangent);
    if (LengthSquared(bitangent) > 0) tangent = Cross(bitangent, ns);
    else CoordinateSystem(ns, &tangent, &bitangent);
    s.shading.n = ns;
    s.shading.dpdu = tangent;
    s.shading.dpdv = bitangent;
    s.n = FaceForward(s.n, ns);
    return s;
}

ShapeSample TriangleMesh::SampleAt(uint32_t primitive, const Corners &c, const Vector3 &b) const {
    ShapeSample s;
    Point3 p0 = b.x * c.p0, p1 = b.y * c.p1, p2 = b.z * c.p2;
    s.p = p0 + p1 + p2;
    s.n = OrientedNormal(primitive, c, b);
    s.pError = Gamma(7) * (Abs(p0) + Abs(p1) + Abs(p2));
    s.uv = UvAt(primitive, b);
    return s;
}

std::optional<ShapeSample> TriangleMesh::SampleArea(uint32_t primitive, const Point2 &u) const {
    Float area = Area(primitive);
    if (!(area > 0)) return {};
    const Corners c = CornersOf(primitive);
    ShapeSample s = SampleAt(primitive, c, SampleUniformTriangle(u));
    s.pError += PlaneTestError(c.p0, c.p1, c.p2, s.p) * Abs(s.n);  // for rays that start here
    s.pdf = 1 / area;
    return s;
}

std::optional<ShapeSample> TriangleMesh::Sample(uint32_t primitive, const ShapeSampleContext &from,
                                                const Point2 &u) const {
    Corners c = CornersOf(primitive);
    const TriangleSampling::Point at = TriangleSampling(from, c.p0, c.p1, c.p2).Sample(u);
    if (!(at.pdf > 0 && std::isfinite(at.pdf))) return {};
    ShapeSample s = SampleAt(primitive, c, at.barycentrics);
    if (at.offset != Vector3(0)) [[unlikely]]
        s.p = from.p + at.offset;
    s.pdf = at.pdf;
    return s;
}

Float TriangleMesh::PdfSolidAngle(uint32_t primitive, const ShapeSampleContext &from, const Vector3 &wi, const Point3 &,
                                  const Normal3 &) const {
    Corners c = CornersOf(primitive);
    const Float pdf = TriangleSampling(from, c.p0, c.p1, c.p2).Pdf(wi);
    return std::isfinite(pdf) ? pdf : 0;
}

}  // namespace pbrt
