#include "pbrt/shapes/mesh_sources.h"

#include <cmath>
#include <map>
#include "shape_cases.h"
#include "support/errors.h"

namespace pbrt::test {
namespace {

/// A unit square at z = 0 as a quad, and a narrow triangle beyond its side x = 1, sharing the vertices there.
PlyMesh QuadAndTriangle() {
    PlyMesh ply;
    MeshData vertices;
    vertices.p = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1.3f, 0.5f, 0}};
    vertices.n.assign(5, Normal3(0, 0, 2));
    for (const Point3 &p : vertices.p) vertices.uv.emplace_back(p.x, p.y);
    ply.triangles = ply.quads = vertices;
    ply.triangles.indices = {1, 4, 3};
    ply.quads.indices = {0, 1, 2, 3};
    return ply;
}

Displacement By(std::function<Float(const Point3 &, const Normal3 &, const Point2 &)> height, Float edgeScale = 1) {
    return {std::move(height), edgeScale};
}
/// Changes nothing but the triangles.
Displacement Flat(Float edgeScale = 1) {
    return By([](auto...) { return Float(0); }, edgeScale);
}

double Area(const MeshData &m) {
    double area = 0;
    for (size_t i = 0; i < m.indices.size(); i += 3) {
        const Point3 &p = m.p[m.indices[i]];
        area += double(Length(Cross(m.p[m.indices[i + 1]] - p, m.p[m.indices[i + 2]] - p))) / 2;
    }
    return area;
}

Float LongestEdge(const MeshData &m, const Transform &t) {
    Float longest = 0;
    ForEachEdge(
        m, [&](uint32_t a, uint32_t b) { longest = std::max(longest, Distance(t.Point(m.p[a]), t.Point(m.p[b]))); });
    return longest;
}

TEST(Displacement, SplitsUntilEdgesAreShortAfterTheTransformation) {
    const Transform twice = Transform::Scale({2, 2, 2});
    for (Float edge : {5.f, 0.5f, 0.11f}) {
        const MeshData m = DisplaceMesh(QuadAndTriangle(), twice, edge, Flat());
        EXPECT_LT(LongestEdge(m, twice), edge);
        EXPECT_GT(LongestEdge(m, twice), edge > 4 ? 1 : edge / 2.1f) << "edges are split more often than necessary";
        EXPECT_NEAR(Area(m), 1.15, 1e-4);
    }
    EXPECT_EQ(DisplaceMesh(QuadAndTriangle(), twice, 0.5f, Flat(10)).indices.size(), 3u * 3);
}

TEST(Displacement, LeavesNoCracks) {
    const MeshData m = DisplaceMesh(QuadAndTriangle(), Transform(), 0.07f, Flat());
    std::map<std::pair<uint32_t, uint32_t>, int> uses;
    ForEachEdge(m, [&](uint32_t a, uint32_t b) { ++uses[std::minmax(a, b)]; });
    auto onBorder = [](const Point3 &p) {
        const Float beyond = p.x - 1;
        return p.x == 0 || (p.x <= 1 && (p.y == 0 || p.y == 1)) ||
               std::abs(std::abs(p.y - 0.5f) - 0.5f * (1 - beyond / 0.3f)) < 1e-5f;
    };
    for (const auto &[edge, count] : uses) {
        if (count == 2) continue;
        ASSERT_EQ(count, 1);
        EXPECT_TRUE(onBorder(m.p[edge.first]) && onBorder(m.p[edge.second]));
    }
}

TEST(Displacement, MovesAlongTheNormalByObjectUnitsAndRenewsNormals) {
    const Transform place = Transform::Translate({5, 0, 0}) * Transform::Scale({2, 2, 2});
    auto height = [](const Point3 &p, const Normal3 &n, const Point2 &uv) {
        EXPECT_NEAR(p.x, 5 + 2 * uv.x, 1e-5f) << "the displacement gets the point in rendering space";
        EXPECT_NEAR(n.z, 1, 1e-6f);
        return Float(0.1) * std::sin(4 * uv.x);
    };
    const MeshData m = DisplaceMesh(QuadAndTriangle(), place, 0.05f, By(height));
    for (size_t i = 0; i < m.p.size(); ++i) {
        EXPECT_NEAR(m.p[i].z, 0.1f * std::sin(4 * m.uv[i].x), 1e-6f);
        EXPECT_NEAR(m.p[i].x, m.uv[i].x, 1e-6f);
        if (m.p[i].x < 0.05f || m.p[i].x > 0.95f) continue;
        EXPECT_GT(Dot(m.n[i], Normalize(Vector3(-0.4f * std::cos(4 * m.p[i].x), 0, 1))), 0.998f);
    }
    const MeshData down = [] {
        PlyMesh ply = QuadAndTriangle();
        for (MeshData *data : {&ply.triangles, &ply.quads})
            for (Normal3 &n : data->n) n = Normal3(0, 0, -1);
        return DisplaceMesh(ply, Transform(), 0.3f, By([](auto...) { return Float(0.25); }));
    }();
    for (size_t i = 0; i < down.p.size(); ++i) {
        EXPECT_EQ(down.p[i].z, -0.25f);
        EXPECT_EQ(down.n[i], Normal3(0, 0, -1)) << "the normals stay on the side of those in the mesh";
    }
}

/// The parameter to blame, and the message.
std::pair<std::string, std::string> ErrorOfDisplacing(const PlyMesh &ply, Float edge, const Displacement &by) {
    try {
        DisplaceMesh(ply, Transform(), edge, by);
    } catch (const DisplacementError &e) {
        return {e.parameter, e.what()};
    }
    return {};
}

TEST(Displacement, NeedsTextureCoordinatesAndNormals) {
    for (bool noUv : {true, false}) {
        PlyMesh ply = QuadAndTriangle();
        for (MeshData *data : {&ply.triangles, &ply.quads}) noUv ? data->uv.clear() : data->n.clear();
        EXPECT_EQ(ErrorOfDisplacing(ply, 1, Flat()).first, "displacement");
    }
}

TEST(Displacement, TheNumberOfTrianglesIsComputedInAdvance) {
    const Transform place = Transform::Scale({3, 3, 3});
    const SplitSize size = MeasureSplit(QuadAndTriangle(), place);
    EXPECT_EQ(size.faces, 3);
    EXPECT_NEAR(size.area, 9 * 1.15, 1e-4);
    for (Float edge : {100.f, 1.5f, 0.4f, 0.1f, 0.07f, 0.05f}) {
        const MeshData m = DisplaceMesh(QuadAndTriangle(), place, edge, Flat());
        const double made = double(m.indices.size()) / 3;
        EXPECT_NEAR(std::log2(size.Triangles(double(edge)) / made), 0, 0.8) << edge << ' ' << made;
    }
}

TEST(Displacement, TooManyTrianglesThrowBeforeTheyAreMade) {
    const auto [parameter, message] = ErrorOfDisplacing(QuadAndTriangle(), 2e-6f, Flat(0.5f));
    EXPECT_EQ(parameter, "edgelength");
    ExpectWords(message, {"\"edgelength\" 2e-06", "scale 0.5", "million", "would fit"});
    const double fitting = std::stod(message.substr(message.find("shape. ") + 7)) / 2;
    const double made = MeasureSplit(QuadAndTriangle(), Transform()).Triangles(fitting) / kMaxDisplacedTriangles;
    EXPECT_LT(made, 0.6);
    EXPECT_GT(made, 0.3);
}

TEST(Displacement, EndsWhereFloatsEnd) {
    PlyMesh ply = QuadAndTriangle();
    for (MeshData *data : {&ply.triangles, &ply.quads})
        for (Point3 &p : data->p) p = Point3(1e6f) + p * Float(0.25);
    const MeshData m = DisplaceMesh(ply, Transform(), 1e-3f, Flat());
    EXPECT_LT(m.indices.size(), 3000u);
}

}  // namespace
}  // namespace pbrt::test
