#include <gtest/gtest.h>

#include "shape_cases.h"

namespace pbrt::test {
namespace {

class ShapeSurface : public testing::TestWithParam<ShapeCase> {};
INSTANTIATE_TEST_SUITE_P(All, ShapeSurface, testing::ValuesIn(ShapeCases()),
                         [](const auto &c) { return c.param.name; });

/// Calls f(ray origin, direction, hit) for random rays that hit.
template <class F>
void ForHits(const Shape &shape, int rays, F &&f) {
    Rng rng(17);
    for (int i = 0; i < rays; ++i) {
        Point3 o = Float(3) * RandomDirection(rng);
        auto target = shape.SampleArea(0, rng.Uniform2());
        Vector3 d = (target->p - o) * (0.2f + 3 * rng.Uniform());
        if (auto hit = shape.Intersect(0, {o, d}, 0)) f(o, d, *hit);
    }
}

TEST_P(ShapeSurface, PointLiesOnTheRayAndUvAgrees) {
    const Shape &shape = *GetParam().shape;
    int hits = 0;
    ForHits(shape, 2000, [&](const Point3 &o, const Vector3 &d, const PrimitiveHit &hit) {
        ++hits;
        SurfacePoint s = shape.Surface(0, hit);
        Vector3 dn = Normalize(d);
        if (AbsDot(dn, s.n) > 0.05f) {
            EXPECT_LT(Distance(s.p, o + hit.t * d), 2e-5);
        }
        EXPECT_NEAR(Length(s.n), 1, 1e-5);
        Point2 uv = shape.Uv(0, hit);
        EXPECT_LT(glm::length(uv - s.uv), 1e-6);
        EXPECT_NEAR(AbsDot(s.n, Normalize(Cross(s.dpdu, s.dpdv))), 1, 1e-4);
        EXPECT_GE(s.pError.x, 0);
        EXPECT_LT(MaxComponent(s.pError), 1e-5);
    });
    EXPECT_GT(hits, 1500);
}

TEST_P(ShapeSurface, DerivativesMatchFiniteDifferences) {
    const Shape &shape = *GetParam().shape;
    bool triangle = shape.Kind() == ShapeKind::TriangleMesh;
    Rng rng(4);
    Float h = 2e-3f;
    for (int i = 0; i < 200; ++i) {
        PrimitiveHit hit{1, 0.1f + 0.8f * rng.Uniform(), 0.1f + 0.8f * rng.Uniform()};
        if (triangle) hit.u = 0.05f + 0.4f * rng.Uniform(), hit.v = 0.05f + 0.4f * rng.Uniform();
        SurfacePoint s = shape.Surface(0, hit);
        // With the default uv = (b1 + b2, b2) of triangles, a change of u alone changes b1, and a change of v alone
        // raises b2 and lowers b1.
        Float dvU = triangle ? -h : 0;
        auto at = [&](Float du, Float dv) { return shape.Surface(0, {1, hit.u + du, hit.v + dv}); };
        SurfacePoint u0 = at(-h, 0), u1 = at(h, 0), v0 = at(-dvU, -h), v1 = at(dvU, h);
        EXPECT_LT(Length((u1.p - u0.p) / (2 * h) - s.dpdu), 2e-3f * (1 + Length(s.dpdu)));
        EXPECT_LT(Length((v1.p - v0.p) / (2 * h) - s.dpdv), 2e-3f * (1 + Length(s.dpdv)));
        EXPECT_LT(Length((u1.n - u0.n) / (2 * h) - s.dndu), 5e-3f * (1 + Length(s.dndu)));
        EXPECT_LT(Length((v1.n - v0.n) / (2 * h) - s.dndv), 5e-3f * (1 + Length(s.dndv)));
    }
}

TEST_P(ShapeSurface, RaysThatLeaveDoNotHitTheSurfaceAgain) {
    const Shape &shape = *GetParam().shape;
    bool convex = GetParam().name.find("Saddle") == std::string::npos;
    Rng rng(6);
    int checked = 0;
    ForHits(shape, 4000, [&](const Point3 &, const Vector3 &, const PrimitiveHit &hit) {
        SurfacePoint s = shape.Surface(0, hit);
        Vector3 w = RandomDirection(rng);
        bool outwards = Dot(w, s.n) > 0;
        bool closed = shape.Kind() == ShapeKind::Sphere || shape.Kind() == ShapeKind::Cylinder;
        Ray ray = s.SpawnRay(w);
        auto again = shape.Intersect(0, {ray.o, ray.d}, 0);
        if (convex && (outwards || !closed)) {
            EXPECT_FALSE(again) << again->t;
            ++checked;
        } else if (again && std::abs(Dot(w, s.n)) > 0.05f) {
            EXPECT_GT(again->t, 1e-3f);
        }
    });
    EXPECT_GT(checked, convex ? 1000 : -1);
}

/// Expects on which side of the shape its normals are, for hits and samples, as it is, reversed, mirrored and both.
template <class S, class... Args>
void ExpectSides(bool isMesh, const Vector3 &reference, const Args &...args) {
    for (const bool mirrored : {false, true})
        for (const bool reverse : {false, true}) {
            const S shape(args..., mirrored ? Transform::Scale({-1, 1, 1}) : Transform(), reverse);
            // A mirrored mesh faces the same way as the mirror image of the original (+z).
            const bool expected = reverse == (mirrored && !isMesh);
            const auto hit = shape.Intersect(0, {reference * Float(5), -reference}, 0);
            ASSERT_TRUE(hit);
            EXPECT_EQ(Dot(shape.Surface(0, *hit).n, reference) > 0, expected) << mirrored << reverse;
            Rng rng(1);
            auto s = shape.SampleArea(0, rng.Uniform2());
            while (Dot(s->p, reference) < 0) s = shape.SampleArea(0, rng.Uniform2());  // on the side of the reference
            EXPECT_EQ(Dot(s->n, shape.Kind() == ShapeKind::Sphere ? s->p : reference) > 0, expected)
                << mirrored << reverse;
        }
}

/// Hits flip as in stock pbrt-v4 (conformance scene shapes/orientation_and_mirroring). Samples flip by the flag XOR the
/// handedness, too, while those of stock's quadrics flip by the flag alone.
TEST(Orientation, FlipsByFlagXorHandednessInHitsAndSamples) {
    const Vector3 up(0, 0, 1);
    MeshData triangle = OnePrimitive({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
    MeshData patch = OnePrimitive({{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}});
    ExpectSides<TriangleMesh>(true, up, triangle);
    ExpectSides<BilinearMesh>(true, up, patch);
    // Vertex normals of length zero count as none.
    for (MeshData *mesh : {&triangle, &patch}) mesh->n.assign(mesh->p.size(), Normal3(0));
    ExpectSides<TriangleMesh>(true, up, triangle);
    ExpectSides<BilinearMesh>(true, up, patch);
    ExpectSides<Disk>(false, up, 0.0f, 1.0f, 0.0f, 360.0f);
    ExpectSides<Sphere>(false, Normalize(Vector3(1, 2, 1)), 1.0f, -1.0f, 1.0f, 360.0f);
}

TEST(Orientation, VertexNormalsDecideTheSide) {
    for (bool reverse : {false, true})
        for (bool mirror : {false, true}) {
            MeshData data = OnePrimitive({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
            data.n = {{0, 0.1f, -1}, {0, 0, -1}, {0.1f, 0, -1}};
            Transform t = mirror ? Transform::Scale({-1, 1, 1}) : Transform();
            TriangleMesh mesh(data, t, reverse);
            SurfacePoint s = mesh.Surface(0, {1, 0.3f, 0.3f});
            EXPECT_EQ(s.n.z > 0, reverse);
            EXPECT_EQ(s.shading.n.z > 0, reverse);
            EXPECT_NEAR(Length(s.shading.n), 1, 1e-6);
            EXPECT_NEAR(Dot(s.shading.n, s.shading.dpdu), 0, 1e-6);
            EXPECT_EQ(mesh.SampleArea(0, {0.4f, 0.3f})->n.z > 0, reverse);
            EXPECT_EQ(mesh.NormalBounds(0).w.z > 0, reverse);
        }
}

TEST(TriangleSurface, NormalsGoByTheInverseTranspose) {
    MeshData data = OnePrimitive({{0, 0, 0}, {1, 0, 0}, {0, 1, 1}});
    data.n.assign(3, Cross(Vector3(1, 0, 0), Vector3(0, 1, 1)));
    TriangleMesh mesh(data, Transform::Scale({1, 3, 0.5f}) * Transform::Rotate(30, {1, 1, 0}), false);
    SurfacePoint s = mesh.Surface(0, {1, 0.2f, 0.2f});
    EXPECT_NEAR(Dot(s.n, s.shading.n), 1, 1e-5);
}

TEST(TriangleSurface, TangentsAreUsedAndMadePerpendicular) {
    MeshData data = OnePrimitive({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    data.s.assign(3, Vector3(1, 1, 1));
    SurfacePoint s = TriangleMesh(data, Transform(), false).Surface(0, {1, 0.2f, 0.2f});
    Vector3 t = Normalize(s.shading.dpdu);
    EXPECT_NEAR(t.x, std::sqrt(0.5f), 1e-6);
    EXPECT_NEAR(t.y, std::sqrt(0.5f), 1e-6);
    EXPECT_NEAR(t.z, 0, 1e-6);
    EXPECT_NEAR(Dot(Cross(s.shading.n, s.shading.dpdu), s.shading.dpdv), Dot(s.shading.dpdv, s.shading.dpdv), 1e-5);
}

TEST(TriangleSurface, DefaultUvAndDegenerateUv) {
    MeshData data = OnePrimitive({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}});
    TriangleMesh plain(data, Transform(), false);
    EXPECT_EQ(plain.Uv(0, {1, 1, 0}), Point2(1, 0));
    EXPECT_EQ(plain.Uv(0, {1, 0, 1}), Point2(1, 1));
    data.uv.assign(3, Point2(0.5f, 0.5f));
    SurfacePoint s = TriangleMesh(data, Transform(), false).Surface(0, {1, 0.2f, 0.2f});
    EXPECT_NEAR(Length(s.dpdu), 1, 1e-6);
    EXPECT_NEAR(Dot(s.dpdu, s.n), 0, 1e-6);
    EXPECT_NEAR(AbsDot(Cross(s.dpdu, s.dpdv), s.n), 1, 1e-6);
}

TEST(TriangleSurface, NormalDerivativesFollowUv) {
    MeshData data = OnePrimitive({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    data.uv = {{0, 0}, {2, 0}, {0, 4}};
    data.n = {{0, 0, 1}, {0.2f, 0, 1}, {0, 0.4f, 1}};
    // Also under a scale, which lengthens or shortens the stored normals, and of triangles so small or large that the
    // squared area leaves single precision.
    for (const Float scale : {1.f, 0.01f, 1e-12f, 1e12f}) {
        const TriangleMesh mesh(data, Transform::Scale(Vector3(scale)), false);
        SurfacePoint s = mesh.Surface(0, {1, 0, 0});
        EXPECT_NEAR(s.shading.dndu.x, 0.1f, 1e-6);
        EXPECT_NEAR(s.shading.dndv.y, 0.1f, 1e-6);
        EXPECT_NEAR(s.dpdu.x / scale, 0.5f, 1e-6);
        EXPECT_NEAR(s.dpdv.y / scale, 0.25f, 1e-6);
        EXPECT_NEAR(mesh.Area(0) / scale / scale, 0.5f, 1e-6);
    }
}

TEST(BilinearSurface, TextureCoordinatesReplaceParameters) {
    MeshData data = OnePrimitive({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
    data.uv = {{0, 1}, {2, 1}, {0, 4}, {2, 4}};
    BilinearMesh mesh(data, Transform(), false);
    SurfacePoint s = mesh.Surface(0, {1, 0.5f, 0.25f});
    EXPECT_EQ(s.uv, Point2(1, 1.75f));
    EXPECT_NEAR(s.dpdu.x, 0.5f, 1e-6);
    EXPECT_NEAR(s.dpdv.y, 1 / 3.0f, 1e-6);
    EXPECT_EQ(s.n, Normal3(0, 0, 1));
    EXPECT_TRUE(mesh.IsRectangle(0));
    EXPECT_TRUE(mesh.IsParallelogram(0));
}

TEST(BilinearSurface, NormalsAgainstTheFaceKeepTheTangents) {
    MeshData data = OnePrimitive({{0, 0, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 2, 0}});
    data.n.assign(4, Normal3(0, 0, -1));
    const SurfacePoint s = BilinearMesh(data, Transform(), false).Surface(0, {1, 0.5f, 0.5f});
    EXPECT_EQ(s.n, Normal3(0, 0, -1));
    EXPECT_EQ(s.shading.dpdu, s.dpdu);
    EXPECT_EQ(s.shading.dpdv, s.dpdv);
}

TEST(BilinearSurface, CornersInOrderAroundARectangleAreNoRectangle) {
    const std::vector<Point3> around = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}};
    for (size_t first = 0; first < 4; ++first) {
        const auto at = [&](size_t i) { return around[(first + i) % 4]; };
        EXPECT_FALSE(BilinearMesh(OnePrimitive({at(0), at(1), at(2), at(3)}), Transform(), false).IsRectangle(0));
        EXPECT_FALSE(BilinearMesh(OnePrimitive({at(0), at(2), at(1), at(3)}), Transform(), false).IsRectangle(0));
        EXPECT_TRUE(BilinearMesh(OnePrimitive({at(0), at(1), at(3), at(2)}), Transform(), false).IsRectangle(0));
        EXPECT_TRUE(BilinearMesh(OnePrimitive({at(0), at(3), at(1), at(2)}), Transform(), false).IsRectangle(0));
    }
}

TEST(BilinearSurface, RaysHitASaddleTwice) {
    BilinearMesh saddle(OnePrimitive({{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}}), Transform(), false);
    // This ray along the diagonal at height 0.8 meets the surface 1 - x - y + 2xy twice.
    Vector3 d = Normalize(Vector3(1, 1, 0));
    auto first = saddle.Intersect(0, {{-1, -1, 0.8f}, d}, 0);
    ASSERT_TRUE(first);
    auto second = saddle.Intersect(0, {{-1, -1, 0.8f}, d}, std::nextafter(first->t, Infinity));
    ASSERT_TRUE(second);
    EXPECT_NEAR(first->u + second->u, 1, 1e-6);
    EXPECT_LT(first->t, second->t);
}

void ExpectUv(const Shape &shape, const Point3 &o, const Vector3 &d, Float u, Float v) {
    const auto hit = shape.Intersect(0, {o, d}, 0);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->u, u, 1e-6);
    EXPECT_NEAR(hit->v, v, 1e-6);
}

TEST(QuadricSurface, UvConventions) {
    Sphere sphere(2, -1, 1.5f, 180, Transform(), false);
    const Float t0 = std::acos(-0.5f), t1 = std::acos(0.75f);
    ExpectUv(sphere, {0, 5, 0}, {0, -1, 0}, 0.5f, (Pi / 2 - t0) / (t1 - t0));
    // The ray passes through the removed half, and the next one through the removed cap.
    EXPECT_NEAR(sphere.Intersect(0, {{0, -5, 0}, {0, 1, 0}}, 0)->t, 7, 1e-5);
    EXPECT_FALSE(sphere.Intersect(0, {{0.1f, 0.1f, 9}, {0, 0, -1}}, 0));

    Disk disk(1, 2, 0.5f, 270, Transform(), false);
    ExpectUv(disk, {-1.25f, 0, 3}, {0, 0, -1}, 180 / 270.0f, 0.5f);
    EXPECT_FALSE(disk.Intersect(0, {{0.4f, 0, 3}, {0, 0, -1}}, 0));
    EXPECT_FALSE(disk.Intersect(0, {{1, -1, 3}, {0, 0, -1}}, 0));

    Cylinder cylinder(1, 3, -1, 360, Transform(), false);
    ExpectUv(cylinder, {-5, 0, 2}, {1, 0, 0}, 0.5f, 0.75f);
    EXPECT_FALSE(cylinder.Intersect(0, {{-5, 0, 3.1f}, {1, 0, 0}}, 0));
}

TEST(TransformSurface, KeepsSidesAndBoundsTheError) {
    Transform t =
        Transform::Translate({100, -20, 7}) * Transform::Rotate(33, {1, 2, 3}) * Transform::Scale({-2, 0.5f, 1});
    Rng rng(2);
    for (int i = 0; i < 500; ++i) {
        SurfacePoint s;
        s.p = Float(3) * RandomDirection(rng);
        s.pError = Vector3(1e-6f);
        s.n = RandomDirection(rng);
        CoordinateSystem(s.n, &s.dpdu, &s.dpdv);
        s.dndu = Float(2) * s.dpdu;
        s.shading = {s.n, s.dpdu, s.dpdv, s.dndu, Normal3(0)};
        s.uv = {0.25f, 0.5f};
        s.primitive = 7;
        SurfacePoint r = TransformSurface(t, s);
        EXPECT_EQ(r.uv, s.uv);
        EXPECT_EQ(r.primitive, 7u);
        EXPECT_NEAR(Length(r.n), 1, 1e-6);
        EXPECT_NEAR(Dot(r.n, Normalize(r.dpdu)), 0, 1e-5);
        EXPECT_NEAR(Dot(r.n, Normalize(r.dpdv)), 0, 1e-5);
        // A point on the n side stays on the n side.
        EXPECT_GT(Dot(t.Vector(s.n), r.n), 0);
        EXPECT_NEAR(Dot(r.shading.n, r.n), 1, 1e-5);
        SurfacePoint next = s;
        next.n = Normalize(s.n + 1e-4f * s.dndu);
        EXPECT_LT(Length((TransformSurface(t, next).n - r.n) / 1e-4f - r.shading.dndu), 0.05f);
        glm::dvec3 exact = glm::dmat3(glm::dmat4(t.Matrix())) * glm::dvec3(s.p) + glm::dvec3(t.Matrix()[3]);
        for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(exact[k] - double(r.p[k])), double(r.pError[k]));
    }
}

}  // namespace
}  // namespace pbrt::test
