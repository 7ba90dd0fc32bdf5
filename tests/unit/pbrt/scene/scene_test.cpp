// Tests how rays find surface points, and whether segments are occluded.
#include "pbrt/scene/scene.h"

#include <gtest/gtest.h>

#include <set>

#include "pbrt/core/counters.h"
#include "support/build_text.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

/// A scene whose rendering space is world space.
BuiltScene Build(const std::string &world, const std::string &integrator = "path") {
    return BuildText(SceneText().Head("Option 'rendercoordsys' 'world'").Integrator(integrator).World(world));
}

std::optional<SurfacePoint> Hit(const BuiltScene &built, const Point3 &o, const Vector3 &d, Float time = 0) {
    return built.scene->Intersect({.o = o, .d = d, .time = time});
}

void ExpectNear(const Vector3 &a, const Vector3 &b, Float error = 1e-5f) {
    EXPECT_LT(Length(a - b), error) << a.x << " " << a.y << " " << a.z;
}

const std::string kQuad = "Shape 'bilinearmesh' 'point3 P' [ -1 -1 0  1 -1 0  -1 1 0  1 1 0 ]\n";

TEST(Scene, IntersectCompletesThePoint) {
    const BuiltScene built =
        Build("Translate 2 0 5 Material 'conductor'\n" + kQuad + "Material 'diffuse' Translate 0 0 9\n" + kQuad);
    const auto hit = Hit(built, {2.5f, -0.5f, 1}, {0, 0, 2}, 0.75f);
    ASSERT_TRUE(hit);
    ExpectNear(hit->p, {2.5f, -0.5f, 5});
    ExpectNear(Vector3(std::abs(hit->n.x), std::abs(hit->n.y), std::abs(hit->n.z)), {0, 0, 1});
    ExpectNear(hit->wo, {0, 0, -1});
    EXPECT_NEAR(hit->uv.x, 0.75f, 1e-5f);
    EXPECT_NEAR(hit->uv.y, 0.25f, 1e-5f);
    EXPECT_FLOAT_EQ(hit->t, 2);
    EXPECT_EQ(hit->time, 0.75f);
    EXPECT_EQ(hit->shape, ShapeId(0u));
    EXPECT_FALSE(hit->light);
    EXPECT_GT(hit->pError.x, 0);
    EXPECT_GT(hit->pError.z, hit->pError.x);  // per axis: 5 units along z, at most 3 along x
    const auto second = built.scene->Intersect(hit->SpawnRay({0, 0, 1}));
    ASSERT_TRUE(second);
    EXPECT_EQ(second->shape, ShapeId(1u));
    EXPECT_NE(second->material, hit->material);
    EXPECT_FALSE(Hit(built, {0, 0, 1}, {0, 0, -1}));
}

TEST(Scene, PrimitivesOfAnEmissiveMeshAreLightsOfTheirOwn) {
    const BuiltScene built = Build(
        "LightSource 'point' AreaLightSource 'diffuse'\n"
        "Shape 'trianglemesh' 'point3 P' [ 0 0 5  2 0 5  2 2 5  0 2 5 ] 'integer indices' [ 0 1 2  0 2 3 ]");
    const auto first = Hit(built, {1.5f, 0.5f, 0}, {0, 0, 1}), second = Hit(built, {0.5f, 1.5f, 0}, {0, 0, 1});
    ASSERT_TRUE(first && second);
    ASSERT_TRUE(first->light && second->light);
    EXPECT_NE(first->light, second->light);
    EXPECT_EQ(std::abs(int(first->light.value) - int(second->light.value)), 1);
}

TEST(Scene, RaysHitInstancesWhereTheyArePlaced) {
    const BuiltScene built = Build("ObjectBegin 'o'\n" + kQuad +
                                   "ObjectEnd\n"
                                   "AttributeBegin Translate 10 0 0 Rotate 90 0 1 0 ObjectInstance 'o' AttributeEnd\n"
                                   "AttributeBegin Translate -10 0 0 Scale 3 3 3 ObjectInstance 'o' AttributeEnd");
    const auto turned = Hit(built, {0, 0, 0.5f}, {1, 0, 0});
    ASSERT_TRUE(turned);
    ExpectNear(turned->p, {10, 0, 0.5f});
    EXPECT_NEAR(std::abs(turned->n.x), 1, 1e-5f);
    EXPECT_NEAR(Length(turned->dpdu), 2, 1e-4f);
    const auto large = Hit(built, {-12, 2, 4}, {0, 0, -1});
    ASSERT_TRUE(large);
    ExpectNear(large->p, {-12, 2, 0});
    EXPECT_NEAR(Length(large->dpdu), 6, 1e-4f);
    EXPECT_FALSE(Hit(built, {0, 0, 4}, {0, 0, -1}));
}

TEST(Scene, RaysHitMovingShapesAtTheirTime) {
    const BuiltScene built = Build("ActiveTransform EndTime Translate 8 0 0 ActiveTransform All\n" + kQuad);
    auto sees = [&](Float x, Float time) { return Hit(built, {x, 0, 3}, {0, 0, -1}, time).has_value(); };
    EXPECT_TRUE(sees(0, 0) && sees(4, 0.5f) && sees(8, 1));
    EXPECT_FALSE(sees(4, 0) || sees(0, 0.5f) || sees(0, 1));
}

LightSampleContext From(const Point3 &p, const Normal3 &n) {
    LightSampleContext from;
    from.p = p;
    from.pError = Vector3(1e-6f);
    from.n = from.ns = n;
    return from;
}

LightLiSample To(const Point3 &from, const Point3 &p, const Normal3 &n = Normal3(0)) {
    LightLiSample to;
    to.pLight = p;
    to.nLight = n;
    to.pLightError = Vector3(1e-6f);
    to.wi = Normalize(p - from);
    return to;
}

TEST(Scene, OnlyWhatIsBetweenTwoPointsOccludes) {
    // The ends of the segments lie on two surfaces at z = 0 and z = 4; a small surface is between them at z = 2.
    const BuiltScene built =
        Build("Scale 9 9 1\n" + kQuad + "Translate 0 0 4\n" + kQuad + "Identity Translate 5 0 2\n" + kQuad);
    const Scene &scene = *built.scene;
    ResetCounters();
    auto occluded = [&](const Point3 &a, const Point3 &b) {
        return scene.Occluded(From(a, {0, 0, 1}), To(a, b, {0, 0, -1}));
    };
    for (Float x : {-7.0f, -3.3f, 0.1f, 3.0f}) EXPECT_FALSE(occluded({x, 0.2f, 0}, {x, 0.3f, 4})) << x;
    EXPECT_TRUE(occluded({5, 0, 0}, {5, 0, 4}));
    EXPECT_TRUE(occluded({3, 0, 0}, {6.5f, 0, 4}));
    EXPECT_TRUE(occluded({-7, 0, 0}, {-7, 0, 4.1f}));
    EXPECT_EQ(SumCounters().shadowRays, 7u);
    EXPECT_EQ(SumCounters().shadowRaysBlocked, 3u);
    EXPECT_TRUE(scene.Occluded(Ray{.o = {5, 0, 1}}));
    EXPECT_FALSE(scene.Occluded(Ray{.o = {5, 0, 1}, .tMax = 0.9f}));
}

TEST(Scene, ShadowRaysPassInterfacesForVolpathOnly) {
    const std::string world =
        "Material 'interface' Translate 0 0 2\n" + kQuad + "Material 'diffuse' Translate 5 0 0\n" + kQuad;
    for (const char *integrator : {"path", "volpath"}) {
        const BuiltScene built = Build(world, integrator);
        const LightSampleContext from = From({0, 0, 0}, {0, 0, 1});
        EXPECT_EQ(built.scene->Occluded(from, To(from.p, {0, 0, 4})), std::string(integrator) == "path") << integrator;
        // Rays that are not shadow rays meet interfaces, and surfaces of other materials block shadow rays.
        EXPECT_TRUE(Hit(built, {0, 0, 0}, {0, 0, 1}));
        EXPECT_TRUE(built.scene->Occluded(Ray{.o = {5, 0, 0}}));
    }
}

TEST(Scene, CrossingsAreThoseOfOneMaterialAndEquallyLikely) {
    // Surfaces along z: material a at 1, 3, 5 (an instance), 7, and material b at 2, 4.
    std::string world = "MakeNamedMaterial 'a' 'string type' 'diffuse' MakeNamedMaterial 'b' 'string type' 'diffuse'\n";
    for (auto [z, material] : {std::pair(1, "a"), {2, "b"}, {3, "a"}, {4, "b"}, {7, "a"}})
        world +=
            fmt::format("AttributeBegin NamedMaterial '{}' Translate 0 0 {}\n{}AttributeEnd\n", material, z, kQuad);
    world += fmt::format("NamedMaterial 'a' ObjectBegin 'o'\n{}ObjectEnd Translate 0 0 5 ObjectInstance 'o'\n", kQuad);
    const BuiltScene built = Build(world);
    const MaterialId a = Hit(built, {0.1f, 0.1f, 0}, {0, 0, 1})->material;
    std::map<int, int> found;
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i) {
        const auto crossing =
            built.scene->SampleCrossing({0.1f, 0.1f, 0}, {0.1f, 0.1f, 6}, 0, a, (Float(i) + 0.5f) / kDraws);
        ASSERT_TRUE(crossing);
        EXPECT_EQ(crossing->count, 3);
        EXPECT_EQ(crossing->point.material, a);
        ++found[int(std::lround(crossing->point.p.z))];
    }
    ASSERT_EQ(found.size(), 3u);
    for (int z : {1, 3, 5}) EXPECT_NEAR(found[z], kDraws / 3.0, 3) << z;
    EXPECT_FALSE(built.scene->SampleCrossing({5, 5, 0}, {5, 5, 6}, 0, a, 0.5f));
    // Surfaces beyond the ends of the segment are not counted.
    EXPECT_EQ(built.scene->SampleCrossing({0.1f, 0.1f, 1.5f}, {0.1f, 0.1f, 4.5f}, 0, a, 0.3f)->count, 1);
    EXPECT_FALSE(built.scene->SampleCrossing({0.1f, 0.1f, 3.2f}, {0.1f, 0.1f, 4.5f}, 0, a, 0.3f));
}

TEST(Scene, NeedsFootprintsAndSubsurfaceOnlyForMaterialsWithThem) {
    const std::string checks = "Texture 't' 'spectrum' 'checkerboard' Material 'diffuse' 'texture reflectance' 't'\n";
    EXPECT_FALSE(Build(kQuad).scene->NeedsFootprints());
    EXPECT_FALSE(Build(kQuad).scene->HasSubsurface());
    EXPECT_TRUE(Build("Material 'subsurface'\n" + kQuad).scene->HasSubsurface());
    const BuiltScene built = Build(checks + kQuad + "Material 'diffuse' Translate 0 0 -2\n" + kQuad);
    EXPECT_TRUE(built.scene->NeedsFootprints());
    const auto checked = Hit(built, {0, 0, 4}, {0, 0, -1}), plain = Hit(built, {0, 0, -1}, {0, 0, -1});
    ASSERT_TRUE(checked && plain);
    EXPECT_TRUE(built.scene->NeedsFootprintAt(*checked));
    EXPECT_FALSE(built.scene->NeedsFootprintAt(*plain));
}

}  // namespace
}  // namespace pbrt::test
