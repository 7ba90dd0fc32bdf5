#include "support.h"

namespace pbrt::test {
namespace {

TEST(Defaults, OfAbsentDirectives) {
    const SceneDescription s = ParseClean("WorldBegin");
    std::string names;
    for (const Entity *e : std::initializer_list<const Entity *>{&s.camera, &s.sampler, &s.filter, &s.integrator,
                                                                 &s.accelerator, &s.film})
        names += e->params.What() + ' ' + e->type + '\n';
    EXPECT_EQ(names,
              Quoted("Camera 'perspective' perspective\nSampler 'zsobol' zsobol\nPixelFilter 'gaussian' gaussian\n"
                     "Integrator 'volpath' volpath\nAccelerator 'bvh' bvh\nFilm 'rgb' rgb\n"));
    EXPECT_EQ(s.film.colorSpace, "srgb");
    EXPECT_TRUE(s.camera.cameraFromWorld.start.IsIdentity());
    EXPECT_FALSE(s.options.seed || s.options.forceDiffuse || s.options.renderCoordSys);
}

TEST(OptionsBlock, EveryDirectiveFillsItsEntityAndTheLastWins) {
    SceneDescription scene = ParseClean(
        "Film 'a' Sampler 'b' PixelFilter 'c' Integrator 'd' Accelerator 'e' Camera 'f'\n"
        "Accelerator 'kdtree' 'float x' 5 Camera 'orthographic' 'float x' 6 Film 'gbuffer' 'float x' 1\n"
        "Sampler 'halton' 'float x' 2 PixelFilter 'box' 'float x' 3 Integrator 'path' 'float x' 4 WorldBegin");
    auto expect = [](const Entity &e, const std::string &directive, const std::string &type, Float x) {
        EXPECT_EQ(e.type, type);
        EXPECT_EQ(FloatOf(e.params, "x", 0), x) << type;
        EXPECT_EQ(e.params.What(), directive + " \"" + type + '"');
        EXPECT_GT(e.loc.line, 1);
    };
    expect(scene.film, "Film", "gbuffer", 1);
    expect(scene.sampler, "Sampler", "halton", 2);
    expect(scene.filter, "PixelFilter", "box", 3);
    expect(scene.integrator, "Integrator", "path", 4);
    expect(scene.accelerator, "Accelerator", "kdtree", 5);
    expect(scene.camera, "Camera", "orthographic", 6);
}

TEST(OptionsBlock, CameraKeepsTheTransformationWhereItStands) {
    SceneDescription scene = ParseClean(
        "Translate 1 0 0 Camera 'perspective' Translate 0 5 0\n"
        "ActiveTransform EndTime Translate 0 0 1 WorldBegin");
    EXPECT_EQ(scene.camera.cameraFromWorld.start, Transform::Translate({1, 0, 0}));
    EXPECT_FALSE(scene.camera.cameraFromWorld.IsAnimated());
}

TEST(Option, NamesIgnoreCaseDashesAndUnderscores) {
    SceneDescription scene = ParseClean(
        "Option 'disablepixeljitter' true Option 'Disable-Texture_Filtering' false Option "
        "'disable_wavelength_jitter' true\n"
        "Option 'ForceDiffuse' true Option 'pixelstats' false WorldBegin Option 'wavefront' true Option 'seed' 17\n"
        "Option 'displacement-edge-scale' .5 Option 'mse-reference-image' 'a.exr' Option 'msereferenceout' 'b.txt'\n"
        "Option 'render-coord-sys' 'camera'");
    const SceneOptions &o = scene.options;
    EXPECT_EQ(o.disablePixelJitter, true);
    EXPECT_EQ(o.disableTextureFiltering, false);
    EXPECT_EQ(o.disableWavelengthJitter, true);
    EXPECT_EQ(o.forceDiffuse, true);
    EXPECT_EQ(o.pixelStats, false);
    EXPECT_EQ(o.wavefront, true);
    EXPECT_EQ(o.seed, 17);
    EXPECT_EQ(o.displacementEdgeScale, .5f);
    EXPECT_EQ(o.mseReferenceImage, "a.exr");
    EXPECT_EQ(o.mseReferenceOut, "b.txt");
    EXPECT_EQ(o.renderCoordSys, "camera");
}

TEST(Option, Errors) {
    ExpectError("Option 'forcedifuse' true\nWorldBegin", 1, 7, "did you mean 'forcediffuse'");
    ExpectError("Option 'forcediffuse' 'true'", 1, 22, "without quotes");
    ExpectError("Option 'seed' 1.5", 1, 14, "integer");
    ExpectError("Option 'seed' 99999999999 WorldBegin", 1, 14, "32-bit");
    ExpectError("Option 'rendercoordsys' 'eye'\nWorldBegin", 1, 24, "valid: camera, cameraworld, world");
    ExpectError("Option 'displacementedgescale' 0\nWorldBegin", 1, 7, "must be above 0");
    ExpectError("Option 'msereferenceout' x", 1, 25, "in quotes");
    ExpectError("Option seed 1", 1, 7, "in quotes");
}

TEST(World, TexturesMaterialsLightsMedia) {
    SceneDescription scene = ParseWorld(
        "Translate 1 0 0\nTexture 't' 'float' 'scale' 'float x' 1\n"
        "Texture 't' 'spectrum' 'imagemap'\nLightSource 'spot' 'float x' 2\n"
        "MakeNamedMedium 'm' 'string type' [ 'cloud' ] 'float x' 3");
    EXPECT_EQ(scene.textures[0].name, "t");
    EXPECT_FALSE(scene.textures[0].isSpectrum);
    EXPECT_EQ(scene.textures[0].type, "scale");
    EXPECT_TRUE(scene.textures[1].isSpectrum) << "float and spectrum textures have separate names";
    EXPECT_EQ(scene.lights[0].type, "spot");
    EXPECT_EQ(scene.media[0].type, "cloud");
    EXPECT_EQ(scene.media[0].name, "m");
    for (const TransformPair &ctm : {scene.textures[0].ctm, scene.lights[0].ctm, scene.media[0].ctm})
        EXPECT_EQ(ctm.start, Transform::Translate({1, 0, 0}));
    EXPECT_EQ(scene.lights[0].loc.line, 5);
    EXPECT_EQ(scene.lights[0].loc.column, 0);
    EXPECT_EQ(FloatOf(scene.media[0].params, "x", 0), 3);
    EXPECT_FALSE(scene.media[0].params.Has("type")) << "the type is stored in the entity, not among its parameters";
}

TEST(World, OnlyShapesMove) {
    const std::string move = "ActiveTransform EndTime Translate 1 0 0 ActiveTransform All\n";
    for (const char *still :
         {"LightSource 'point'", "Texture 't' 'float' 'constant'", "MakeNamedMedium 'm' 'string type' 'cloud'"})
        ExpectWorldWarning(move + still, 3, 0, "cannot be animated");
    ExpectWorldError(move + "AreaLightSource 'diffuse' Shape 's'", 3, 26, "emits light cannot move");
    SceneDescription scene = Parse("WorldBegin " + move + "LightSource 'point'").scene;
    EXPECT_FALSE(scene.lights[0].ctm.IsAnimated());
    EXPECT_TRUE(scene.lights[0].ctm.start.IsIdentity());
}

TEST(Objects, RecordShapesAndRestoreTheState) {
    SceneDescription scene = ParseWorld(
        "Translate 1 0 0\nObjectBegin 'o' Translate 0 1 0 Material 'm' Shape 'a'\n"
        "AttributeBegin Shape 'b' AttributeEnd ObjectEnd\nShape 'c'\n"
        "Translate 0 0 1 ObjectInstance 'o' ObjectInstance 'o'");
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].name, "o");
    ASSERT_EQ(scene.objects[0].shapes.size(), 2u);
    EXPECT_EQ(scene.objects[0].shapes[0].ctm.start, Transform::Translate({1, 1, 0}));
    EXPECT_EQ(scene.objects[0].shapes[1].material.index, 0);
    ASSERT_EQ(scene.shapes.size(), 1u);
    EXPECT_EQ(scene.shapes[0].type, "c");
    EXPECT_EQ(scene.shapes[0].ctm.start, Transform::Translate({1, 0, 0}));
    EXPECT_EQ(scene.shapes[0].material.index, -1);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[0].ctm.start, Transform::Translate({1, 0, 1}));
}

TEST(Objects, EmptyOnesAreSkippedAndDefinitionsMayFollow) {
    SceneDescription scene = ParseWorld(
        "ObjectInstance 'e' ObjectInstance 'f'\n"
        "ObjectBegin 'e' ObjectEnd ObjectBegin 'f' Shape 's' ObjectEnd");
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].name, "f");
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].name, "f");
}

TEST(Objects, LightsInThemWarn) {
    ExpectWorldWarning("ObjectBegin 'o' AreaLightSource 'diffuse'\nShape 's' Shape 't' ObjectEnd", 3, 0, "do not emit");
    ExpectWorldWarning("ObjectBegin 'o'\nLightSource 'point' ObjectEnd", 3, 0, "not instanced");
    Parsed parsed = Parse("WorldBegin ObjectBegin 'o' AreaLightSource 'diffuse' Shape 's' ObjectEnd");
    EXPECT_EQ(parsed.scene.objects[0].shapes[0].areaLight, -1);
}

}  // namespace
}  // namespace pbrt::test
