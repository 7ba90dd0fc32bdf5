#pragma once
#include <fmt/format.h>

#include <memory>
#include <string>

#include "pbrt/shapes/bilinear_mesh.h"
#include "pbrt/shapes/quadric.h"
#include "pbrt/shapes/triangle_mesh.h"
#include "support/sampling.h"

namespace pbrt::test {

struct ShapeCase {
    std::string name;
    std::shared_ptr<Shape> shape;
    /// True: points that the shape itself hides from the receiver are not sampled. False: every point can be sampled.
    bool drawsVisibleOnly = false;
    /// True: for some random numbers the sampler returns no point.
    bool mayDrawNothing = false;
};

inline MeshData OnePrimitive(std::vector<Point3> p) {
    MeshData data;
    for (uint32_t i = 0; i < p.size(); ++i) data.indices.push_back(i);
    data.p = std::move(p);
    return data;
}

inline Transform SomeRotation() {
    return Transform::Translate({0.2f, -0.1f, 0.3f}) * Transform::Rotate(40, {1, 2, -1});
}
inline Transform Stretch() { return SomeRotation() * Transform::Scale({1.5f, 0.6f, 0.9f}); }

/// Calls f(a, b) with the vertices of every edge of every triangle.
template <class F>
void ForEachEdge(const MeshData &mesh, F f) {
    for (size_t i = 0; i < mesh.indices.size(); ++i) f(mesh.indices[i], mesh.indices[i % 3 == 2 ? i - 2 : i + 1]);
}

/// A PLY file as text: `lines` are those of the vertices, whose properties are floats, and of the faces.
inline std::string PlyText(int vertices, const std::vector<std::string> &properties, int faces,
                           const std::string &lines) {
    std::string text = fmt::format("ply\nformat ascii 1.0\nelement vertex {}\n", vertices);
    for (const std::string &name : properties) text += "property float " + name + "\n";
    return text + fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n", faces) + lines;
}

/// At least one whole shape of every kind, about 1 across and near the origin; none is reversed.
inline std::vector<ShapeCase> ShapeCases() {
    Transform id, turn = SomeRotation(), stretch = Stretch();
    Transform twice = turn * Transform::Scale({1.4f, 1.4f, 1.4f});
    auto triangle = OnePrimitive({{-0.6f, -0.5f, 0.1f}, {0.7f, -0.4f, -0.2f}, {0.1f, 0.8f, 0.3f}});
    auto sliver = OnePrimitive({{-0.9f, 0, 0}, {0.9f, 0.02f, 0.1f}, {0.1f, 0.06f, 0}});
    auto rectangle = OnePrimitive({{-0.5f, -0.4f, 0}, {0.5f, -0.4f, 0}, {-0.5f, 0.4f, 0}, {0.5f, 0.4f, 0}});
    auto trapezoid = OnePrimitive({{-0.5f, -0.4f, 0}, {0.5f, -0.4f, 0}, {-0.2f, 0.4f, 0}, {0.3f, 0.6f, 0}});
    auto saddle = OnePrimitive({{-0.5f, -0.5f, 0.3f}, {0.5f, -0.5f, -0.3f}, {-0.5f, 0.5f, -0.3f}, {0.5f, 0.5f, 0.3f}});
    std::vector<ShapeCase> cases;
    cases.push_back({"Triangle", std::make_shared<TriangleMesh>(triangle, id, false)});
    cases.push_back({"Sliver", std::make_shared<TriangleMesh>(sliver, id, false)});
    cases.push_back({"Rectangle", std::make_shared<BilinearMesh>(rectangle, turn, false)});
    cases.push_back({"Trapezoid", std::make_shared<BilinearMesh>(trapezoid, turn, false)});
    cases.push_back({"Saddle", std::make_shared<BilinearMesh>(saddle, turn, false)});
    const std::vector<Float> glow = {1, 2, 0.5f, 1, 1, 3, 0.2f, 1, 1, 1, 4, 0.3f};
    auto emission = std::make_shared<PiecewiseConstant2D>(glow, 3, 4);
    cases.push_back({"GlowingRectangle", std::make_shared<BilinearMesh>(rectangle, turn, false, emission)});
    cases.push_back({"GlowingSaddle", std::make_shared<BilinearMesh>(saddle, turn, false, emission)});
    cases.push_back({"Sphere", std::make_shared<Sphere>(0.6f, -1.0f, 1.0f, 360.0f, turn, false), true});
    cases.push_back({"ScaledSphere", std::make_shared<Sphere>(0.4f, -1.0f, 1.0f, 360.0f, twice, false), true});
    cases.push_back({"Ellipsoid", std::make_shared<Sphere>(0.6f, -1.0f, 1.0f, 360.0f, stretch, false)});
    cases.push_back({"Disk", std::make_shared<Disk>(0.1f, 0.6f, 0.0f, 360.0f, turn, false)});
    cases.push_back({"StretchedDisk", std::make_shared<Disk>(0.1f, 0.6f, 0.0f, 360.0f, stretch, false)});
    cases.push_back({"Cylinder", std::make_shared<Cylinder>(0.3f, -0.6f, 0.5f, 360.0f, turn, false)});
    cases.push_back({"StretchedCylinder", std::make_shared<Cylinder>(0.3f, -0.6f, 0.5f, 250.0f, stretch, false)});
    return cases;
}

/// Parts of quadrics, mirrored, reversed, stretched and with holes, and a triangle whose vertex normals lie on both
/// sides.
inline std::vector<ShapeCase> PartCases() {
    Transform turn = SomeRotation(), stretch = Stretch();
    Transform mirror = turn * Transform::Scale({1, -1, 1}), shrink = turn * Transform::Scale({-1.3f, 1.3f, 1.3f});
    std::vector<ShapeCase> cases;
    auto sphere = [&](const char *name, Float zMin, Float zMax, Float phiMax, const Transform &t, bool reverse,
                      bool opaque = true) {
        bool whole = zMin <= -0.6f && zMax >= 0.6f && phiMax == 360;
        bool byCone = &t != &stretch;  // stretched spheres are sampled by area
        cases.push_back({name, std::make_shared<Sphere>(0.6f, zMin, zMax, phiMax, t, reverse, opaque), byCone && opaque,
                         byCone && !whole});
    };
    sphere("MirroredSphere", -1, 1, 360, mirror, false);
    sphere("ReversedSphere", -1, 1, 360, turn, true);
    sphere("Bowl", -0.6f, 0.1f, 360, turn, false);
    sphere("BowlReversed", -0.6f, 0.1f, 360, turn, true);
    sphere("BowlMirroredScaled", -0.6f, 0.1f, 360, shrink, true);
    sphere("Slice", -0.6f, 0.6f, 150, turn, false);
    sphere("Wedge", -0.6f, 0.6f, 40, mirror, false);
    sphere("Cap", 0.55f, 0.6f, 360, turn, false);
    sphere("BandPart", -0.3f, 0.4f, 250, turn, true);
    sphere("EllipsoidPart", -0.5f, 0.3f, 200, stretch, false);
    sphere("SphereWithHoles", -1, 1, 360, turn, false, false);
    sphere("BowlWithHoles", -0.6f, 0.1f, 300, turn, false, false);
    auto disk = [&](const char *name, Float inner, Float phiMax, const Transform &t, bool reverse) {
        cases.push_back({name, std::make_shared<Disk>(0.1f, 0.6f, inner, phiMax, t, reverse)});
    };
    disk("Ring", 0.35f, 360, turn, false);
    disk("Fan", 0, 230, mirror, false);
    disk("RingPartReversed", 0.2f, 100, turn, true);
    disk("StretchedRing", 0.3f, 270, stretch, false);
    auto cylinder = [&](const char *name, Float phiMax, const Transform &t, bool reverse) {
        cases.push_back({name, std::make_shared<Cylinder>(0.3f, -0.6f, 0.5f, phiMax, t, reverse)});
    };
    cylinder("Trough", 170, turn, true);
    cylinder("TroughMirrored", 200, mirror, false);
    auto bent = OnePrimitive({{-0.6f, -0.5f, 0.1f}, {0.7f, -0.4f, -0.2f}, {0.1f, 0.8f, 0.3f}});
    bent.n = {{0.2f, 0, 1}, {0.1f, 0, 0.9f}, {0, -0.3f, -1}};
    cases.push_back({"TriangleOfTwoSides", std::make_shared<TriangleMesh>(bent, mirror, false)});
    return cases;
}

inline std::vector<ShapeCase> WholeAndPartCases() {
    std::vector<ShapeCase> cases = ShapeCases();
    for (ShapeCase &c : PartCases()) cases.push_back(std::move(c));
    return cases;
}

}  // namespace pbrt::test
