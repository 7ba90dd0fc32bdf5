#include "support.h"

namespace pbrt::test {
namespace {

void ExpectNear(const Point3 &a, const Point3 &b) {
    EXPECT_LT(Distance(a, b), 1e-5f) << fmt::format("({} {} {}) against ({} {} {})", a.x, a.y, a.z, b.x, b.y, b.z);
}

/// Where the last shape of the world block `text` puts `p`.
Point3 Placed(const std::string &text, const Point3 &p) {
    SceneDescription scene = ParseWorld(text + "\nShape 's'");
    EXPECT_FALSE(scene.shapes.back().ctm.IsAnimated());
    return scene.shapes.back().ctm.start.Point(p);
}

TEST(Transformations, TheLastOneIsAppliedFirst) {
    ExpectNear(Placed("Translate 1 2 3", {1, 1, 1}), {2, 3, 4});
    ExpectNear(Placed("Scale 2 3 4", {1, 1, 1}), {2, 3, 4});
    ExpectNear(Placed("Translate 1 2 3 Scale 2 2 2", {1, 0, 0}), {3, 2, 3});
    ExpectNear(Placed("Scale 2 2 2 Translate 1 2 3", {1, 0, 0}), {4, 4, 6});
}

TEST(Transformations, RotateFollowsTheRightHandInDegrees) {
    ExpectNear(Placed("Rotate 90 0 0 1", {1, 0, 0}), {0, 1, 0});
    ExpectNear(Placed("Rotate -90 1 0 0", {0, 1, 0}), {0, 0, -1});
}

TEST(Transformations, MatricesAreListedByColumns) {
    std::string matrix = "[ 1 0 0 0  0 2 0 0  0 0 3 0  5 6 7 1 ]";
    ExpectNear(Placed("Translate 9 9 9 Transform " + matrix, {1, 1, 1}), {6, 8, 10});
    ExpectNear(Placed("Translate 1 0 0 ConcatTransform " + matrix, {1, 1, 1}), {7, 8, 10});
    ExpectNear(Placed("Translate 9 9 9 Identity", {1, 2, 3}), {1, 2, 3});
    // With the first column (0, 1, 0), x becomes y.
    ExpectNear(Placed("Transform [ 0 1 0 0  -1 0 0 0  0 0 1 0  0 0 0 1 ]", {1, 0, 0}), {0, 1, 0});
}

TEST(Transformations, LookAtIsLeftHandedWorldToCamera) {
    ExpectNear(Placed("LookAt 0 0 -5  0 0 0  0 1 0", {0, 0, 0}), {0, 0, 5});
    ExpectNear(Placed("LookAt 0 0 -5  0 0 0  0 1 0", {1, 2, 0}), {1, 2, 5});
    ExpectNear(Placed("LookAt 5 0 0  0 0 0  0 1 0", {0, 0, 1}), {1, 0, 5});
}

TEST(Transformations, NamedSystemsAreGlobalAndPredefined) {
    SceneDescription scene = ParseClean(
        "Translate 0 0 4\nCamera 'perspective'\nWorldBegin\n"
        "AttributeBegin Translate 1 0 0 CoordinateSystem 'a' AttributeEnd\n"
        "CoordSysTransform 'a' Shape 's'\n"
        "CoordSysTransform 'world' Shape 's'\n"
        "CoordSysTransform 'camera' Shape 's'\n");
    ExpectNear(OriginOf(scene.shapes[0].ctm), {1, 0, 0});
    ExpectNear(OriginOf(scene.shapes[1].ctm), {0, 0, 0});
    ExpectNear(OriginOf(scene.shapes[2].ctm), {0, 0, -4});
    ExpectNear(OriginOf(scene.camera.cameraFromWorld), {0, 0, 4});
}

TEST(Transformations, ActiveTransformSelectsTheCtm) {
    SceneDescription scene = ParseWorld(
        "ActiveTransform StartTime Translate 1 0 0\n"
        "ActiveTransform EndTime Translate 0 1 0 CoordinateSystem 'pair'\n"
        "ActiveTransform All Translate 0 0 1 Shape 's'\n"
        "ActiveTransform EndTime Identity Shape 's'\n"
        "CoordSysTransform 'pair' Shape 's'");
    auto expect = [&](size_t shape, const Point3 &start, const Point3 &end) {
        ExpectNear(OriginOf(scene.shapes[shape].ctm), start);
        ExpectNear(scene.shapes[shape].ctm.end.Point({0, 0, 0}), end);
    };
    expect(0, {1, 0, 1}, {0, 1, 1});
    expect(1, {1, 0, 1}, {0, 0, 0});
    expect(2, {1, 0, 0}, {0, 1, 0});  // CoordSysTransform sets both
    EXPECT_TRUE(scene.shapes[0].ctm.IsAnimated());
}

TEST(Transformations, TimesReachShapesCameraAndInstances) {
    SceneDescription scene = ParseClean(
        "Camera 'perspective' TransformTimes .25 .75\nWorldBegin\n"
        "Shape 's' ObjectBegin 'o' Shape 's' ObjectEnd ObjectInstance 'o'");
    EXPECT_EQ(scene.camera.startTime, 0) << "TransformTimes after Camera do not change its times";
    EXPECT_EQ(scene.camera.endTime, 1);
    EXPECT_EQ(scene.shapes[0].startTime, .25f);
    EXPECT_EQ(scene.shapes[0].endTime, .75f);
    EXPECT_EQ(scene.instances[0].startTime, .25f);
    EXPECT_EQ(scene.instances[0].endTime, .75f);
}

TEST(State, WorldBeginResetsOnlyTransformations) {
    SceneDescription scene = ParseClean(
        "ColorSpace 'rec2020' MediumInterface 'in' 'out'\n"
        "Attribute 'shape' 'float radius' 3\nMakeNamedMedium 'in' 'string type' 'homogeneous'\n"
        "MakeNamedMedium 'out' 'string type' 'homogeneous'\n"
        "ActiveTransform EndTime Translate 1 2 3\nWorldBegin\nTranslate 4 0 0 Shape 's'");
    const ShapeEntity &s = scene.shapes[0];
    EXPECT_FALSE(s.ctm.IsAnimated());
    ExpectNear(OriginOf(s.ctm), {4, 0, 0});
    EXPECT_EQ(s.colorSpace, "rec2020");
    EXPECT_EQ(s.insideMedium, "in");
    EXPECT_EQ(s.outsideMedium, "out");
    EXPECT_EQ(FloatOf(s.params, "radius", 1), 3);
}

TEST(State, AttributeBlocksSaveAndRestoreAllOfIt) {
    for (const char *block : {"Attribute", "Transform"}) {
        Parsed parsed = Parse(
            fmt::format("MakeNamedMedium 'm' 'string type' 'homogeneous' WorldBegin\n"
                        "{0}Begin Translate 1 0 0 ActiveTransform EndTime ReverseOrientation Material 'conductor'\n"
                        "AreaLightSource 'diffuse' MediumInterface 'm' ColorSpace 'rec2020'\n"
                        "Attribute 'shape' 'float a' 1 Attribute 'light' 'float a' 1 Attribute 'texture' 'float a' 1\n"
                        "Attribute 'material' 'float a' 1 Attribute 'medium' 'float a' 1\n"
                        "{0}End\nTranslate 0 1 0 Shape 's' Material 'diffuse' LightSource 'point'\n"
                        "Texture 't' 'float' 'constant' MakeNamedMedium 'n' 'string type' 'homogeneous'",
                        block));
        EXPECT_EQ(parsed.sink.ErrorCount(), 0u) << Messages(parsed.sink);
        const SceneDescription &scene = parsed.scene;
        const ShapeEntity &s = scene.shapes.at(0);
        EXPECT_FALSE(s.ctm.IsAnimated());
        ExpectNear(OriginOf(s.ctm), {0, 1, 0});
        EXPECT_FALSE(s.reverseOrientation);
        EXPECT_EQ(s.material.index, -1);
        EXPECT_EQ(s.material.name, "");
        EXPECT_EQ(s.areaLight, -1);
        EXPECT_EQ(s.insideMedium + s.outsideMedium, "");
        EXPECT_EQ(s.colorSpace, "srgb");
        for (const Entity *e : std::initializer_list<const Entity *>{&s, &scene.materials.at(1), &scene.lights.at(0),
                                                                     &scene.textures.at(0), &scene.media.at(1)})
            EXPECT_FALSE(e->params.Has("a")) << e->params.What();
    }
}

TEST(State, ReverseOrientationToggles) {
    SceneDescription scene = ParseWorld("ReverseOrientation Shape 's' ReverseOrientation Shape 's'");
    EXPECT_TRUE(scene.shapes[0].reverseOrientation);
    EXPECT_FALSE(scene.shapes[1].reverseOrientation);
}

TEST(State, MaterialsAreReferredToByIndexOrName) {
    SceneDescription scene = ParseWorld(
        "Shape 's' NamedMaterial 'n' Shape 's' Material 'a' Shape 's'\n"
        "MakeNamedMaterial 'n' 'string type' 'conductor' Shape 's'\n"
        "Material 'b' Shape 's'");
    EXPECT_EQ(scene.shapes[0].material.index, -1);
    EXPECT_EQ(scene.shapes[0].material.name, "");
    EXPECT_EQ(scene.shapes[1].material.name, "n") << "a material may be used before it is defined";
    EXPECT_EQ(scene.materials.at(size_t(scene.shapes[2].material.index)).type, "a");
    EXPECT_EQ(scene.shapes[3].material.index, scene.shapes[2].material.index);
    EXPECT_EQ(scene.shapes[3].material.name, "");
    EXPECT_EQ(scene.materials.at(size_t(scene.shapes[4].material.index)).type, "b");
    EXPECT_EQ(scene.materials[1].name, "n");
    EXPECT_EQ(scene.materials[1].type, "conductor");
}

TEST(State, NamesAreComparedComposed) {
    SceneDescription scene = ParseWorld(
        "MakeNamedMaterial 'm\u00e9tal' 'string type' 'diffuse'\n"
        "NamedMaterial 'me\u0301tal' Shape 's'\n"
        "CoordinateSystem 'e\u0301' CoordSysTransform '\u00e9'\n"
        "ObjectBegin 'o\u0308' Shape 's' ObjectEnd ObjectInstance '\u00f6'");
    EXPECT_EQ(scene.shapes[0].material.name, scene.materials[0].name);
    EXPECT_EQ(scene.instances.size(), 1u);
}

TEST(State, AreaLightIsSharedByTheShapesThatFollow) {
    SceneDescription scene = ParseWorld(
        "AttributeBegin AreaLightSource 'diffuse' 'float scale' 1 AttributeEnd\n"
        "AttributeBegin ColorSpace 'dci-p3' AreaLightSource 'diffuse' 'float scale' 2\n"
        "Shape 'a' Shape 'b' AttributeEnd Shape 'c'\nAreaLightSource 'x' Shape 'd'");
    ASSERT_EQ(scene.areaLights.size(), 2u) << "an area light that no shape uses is left out";
    EXPECT_EQ(FloatOf(scene.areaLights[0].params, "scale", 0), 2);
    EXPECT_EQ(scene.areaLights[0].colorSpace, "dci-p3");
    EXPECT_EQ(scene.shapes[0].areaLight, 0);
    EXPECT_EQ(scene.shapes[1].areaLight, 0);
    EXPECT_EQ(scene.shapes[2].areaLight, -1);
    EXPECT_EQ(scene.shapes[3].areaLight, 1);
}

TEST(State, MediumInterface) {
    SceneDescription scene = ParseClean(
        "MakeNamedMedium 'a' 'string type' 'homogeneous' MakeNamedMedium 'b' 'string type' 'cloud'\n"
        "MediumInterface 'a' 'b' Camera 'perspective' WorldBegin\n"
        "MediumInterface 'a' Shape 's' LightSource 'point'\nMediumInterface '' 'b' Shape 's'\n"
        "MediumInterface 'a' '' Shape 's' LightSource 'point' MediumInterface '' Shape 's'");
    auto media = [&](size_t i) { return scene.shapes.at(i).insideMedium + "|" + scene.shapes.at(i).outsideMedium; };
    EXPECT_EQ(media(0), "a|a");
    EXPECT_EQ(media(1), "|b");
    EXPECT_EQ(media(2), "a|");
    EXPECT_EQ(media(3), "|");
    EXPECT_EQ(scene.camera.medium, "b");
    EXPECT_EQ(scene.lights[0].medium, "a");
    EXPECT_EQ(scene.lights[1].medium, "");
    EXPECT_EQ(scene.media[1].type, "cloud");
}

TEST(State, ColorSpaceIsNotedPerEntityAndParameter) {
    SceneDescription scene = ParseClean(
        "ColorSpace 'ACES2065-1' Film 'rgb' 'float x' 1 ColorSpace 'DCI-p3' WorldBegin\n"
        "Material 'diffuse' 'rgb reflectance' [ 1 1 1 ]\nColorSpace 'sRGB' Shape 's'");
    EXPECT_EQ(scene.film.colorSpace, "aces2065-1");
    EXPECT_EQ(scene.materials[0].colorSpace, "dci-p3");
    EXPECT_EQ(scene.materials[0].params.Own()[0].colorSpace, "dci-p3");
    EXPECT_EQ(scene.shapes[0].colorSpace, "srgb");
}

TEST(Attribute, GivesDefaultsToItsKindOnly) {
    const SceneDescription s = ParseWorld(
        "Attribute 'shape' 'float x' 1 Attribute 'light' 'float x' 2 Attribute 'material' 'float x' 3\n"
        "Attribute 'texture' 'float x' 4 Attribute 'medium' 'float x' 5\n"
        "AreaLightSource 'diffuse' Shape 's' LightSource 'point' Material 'diffuse'\n"
        "MakeNamedMaterial 'n' 'string type' 'diffuse' Texture 't' 'float' 'constant'\n"
        "MakeNamedMedium 'm' 'string type' 'homogeneous'");
    const std::pair<const Entity *, Float> expected[] = {
        {&s.shapes[0], 1},    {&s.lights[0], 2},   {&s.areaLights[0], 2}, {&s.materials[0], 3},
        {&s.materials[1], 3}, {&s.textures[0], 4}, {&s.media[0], 5}};
    for (const auto &[entity, x] : expected) EXPECT_EQ(FloatOf(entity->params, "x", 0), x) << entity->params.What();
}

// If every directive copied the parameters of those before it, a scope would make five billion copies, which takes
// minutes.
TEST(Attribute, ManyDirectivesTakeTimeByTheirNumber) {
    constexpr int kCount = 50000;
    std::string text, inner;
    for (int i = 0; i < kCount; ++i) text += fmt::format("Attribute 'shape' 'float a{}' {}\n", i % 1000, i);
    for (int i = 0; i < kCount; ++i) inner += fmt::format("Attribute 'shape' 'float b{}' {}\n", i % 1000, i);
    SceneDescription scene =
        ParseWorld(text + "Shape 's'\nAttributeBegin\n" + inner + "Shape 's'\nAttributeEnd\nShape 's'");
    ASSERT_EQ(scene.shapes.size(), 3u);
    for (size_t s = 0; s < 3; ++s) {
        const ParamSet &params = scene.shapes[s].params;
        for (int i : {0, 1, 500, 999}) {
            EXPECT_EQ(FloatOf(params, fmt::format("a{}", i), -1), kCount - 1000 + i) << s;
            EXPECT_EQ(FloatOf(params, fmt::format("b{}", i), -1), s == 1 ? kCount - 1000 + i : -1) << s;
        }
    }
}

// The outer scope shares its list with the inner one until one of them adds to it.
TEST(Attribute, ScopesAddToListsOfTheirOwn) {
    SceneDescription scene = ParseWorld(
        "Attribute 'shape' 'float a' 1\nAttributeBegin Shape 's' Attribute 'shape' 'float a' 2 Shape 's'\n"
        "AttributeBegin AttributeBegin Attribute 'shape' 'float a' 3 AttributeEnd Shape 's' AttributeEnd AttributeEnd\n"
        "Shape 's' Attribute 'shape' 'float a' 4 Shape 's'");
    const Float expected[] = {1, 2, 2, 1, 4};
    for (size_t i = 0; i < 5; ++i) EXPECT_EQ(FloatOf(scene.shapes[i].params, "a", 0), expected[i]) << i;
}

TEST(Attribute, OwnParametersWinThenTheLatestStatement) {
    SceneDescription scene = ParseWorld(
        "Attribute 'shape' 'float r' 1 'float q' 1\nAttribute 'shape' 'float r' 2\n"
        "Shape 's' Shape 's' 'float r' 3\n"
        "AttributeBegin Attribute 'shape' 'float r' 4 Shape 's' AttributeEnd Shape 's'");
    Float expected[] = {2, 3, 4, 2};
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(FloatOf(scene.shapes[i].params, "r", 0), expected[i]) << i;
        EXPECT_EQ(FloatOf(scene.shapes[i].params, "q", 0), 1) << i;
    }
}

TEST(Attribute, DefaultsAreNeverUnused) {
    SceneDescription scene = ParseWorld("Attribute 'material' 'float roughness' 1 Material 'diffuse'");
    DiagnosticSink sink;
    ParamReader(scene.materials[0].params).Finish(sink);
    EXPECT_FALSE(sink.HasErrors());
}

TEST(Attribute, DefaultsAreReadInTheColorSpaceOfTheEntity) {
    SceneDescription scene = ParseWorld(
        "ColorSpace 'rec2020' Attribute 'material' 'rgb reflectance' [ 1 0 0 ]\n"
        "Attribute 'light' 'rgb L' [ 1 0 0 ]\n"
        "Material 'diffuse' ColorSpace 'dci-p3' Material 'diffuse' LightSource 'infinite'\n"
        "AttributeBegin ColorSpace 'srgb' Material 'diffuse' AttributeEnd Material 'diffuse'");
    auto space = [](const Entity &e, const char *name) { return e.params.Find(name, ParamType::Rgb)->colorSpace; };
    const char *expected[] = {"rec2020", "dci-p3", "srgb", "dci-p3"};
    for (size_t i = 0; i < 4; ++i) EXPECT_EQ(space(scene.materials[i], "reflectance"), expected[i]) << i;
    EXPECT_EQ(space(scene.lights[0], "L"), "dci-p3");
}

TEST(Attribute, DoesNotReachWhatIsInForceAlready) {
    SceneDescription scene = ParseWorld("AreaLightSource 'diffuse' Attribute 'light' 'float scale' 2 Shape 's'");
    EXPECT_FALSE(scene.areaLights[0].params.Has("scale"));
}

}  // namespace
}  // namespace pbrt::test
