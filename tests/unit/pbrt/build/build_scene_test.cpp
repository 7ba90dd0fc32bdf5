// Tests how a scene description becomes everything that a render needs.
#include <gtest/gtest.h>

#include "pbrt/build/integrator_builder.h"
#include "pbrt/core/parallel.h"
#include "support/build_text.h"
#include "support/errors.h"
#include "support/parse_text.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

constexpr const char *kBall = "Shape 'sphere'\n";
constexpr const char *kLamp = "LightSource 'point' 'rgb I' [2 2 2]\n";

std::string Text(const std::string &options, const std::string &world) {
    return SceneText().Head(options).Film(8, 6).World(world);
}

struct Outcome {
    std::vector<Diagnostic> diagnostics;
    bool isBuilt = false;
    int64_t Count(const std::string &text) const {
        return std::ranges::count_if(diagnostics, [&](const auto &d) { return d.message.find(text) != text.npos; });
    }
};

/// Builds a scene and keeps the messages about it.
Outcome Try(const std::string &text, const BuildOptions &options = {}) {
    Outcome outcome;
    DiagnosticSink sink;
    SceneDescription description = ParseSceneText(text, sink);
    Progress progress;
    try {
        BuildScene(description, options, AllSamplers(), sink, progress);
        outcome.isBuilt = true;
        outcome.diagnostics = sink.All();
    } catch (const UserError &e) {
        outcome.diagnostics = e.Diagnostics();
    }
    return outcome;
}

TEST(BuildScene, FlagsOverrideSeedAndJitterOfTheScene) {
    const std::string text = Text("Option 'seed' 5 Option 'disablepixeljitter' true", kBall);
    BuildOptions options;
    BuiltScene built = BuildText(text, options);
    EXPECT_EQ(built.seed, 5);
    EXPECT_TRUE(built.Settings().disablePixelJitter);
    EXPECT_FALSE(built.Settings().disableWavelengthJitter);
    options.seed = 9;
    options.disableWavelengthJitter = true;
    options.samplesPerPixel = 3;
    built = BuildText(text, options);
    EXPECT_EQ(built.seed, 9);
    EXPECT_TRUE(built.Settings().disablePixelJitter);
    EXPECT_TRUE(built.Settings().disableWavelengthJitter);
    EXPECT_EQ(built.Settings().samplesPerPixel, 3);
}

TEST(BuildScene, UnknownNamesAreErrorsAlsoWhereNothingIsBuiltFromThem) {
    const struct {
        const char *options, *world, *message;
    } kCases[] = {{"Film 'rgbb'", "", "Film 'rgbb' is unknown; did you mean 'rgb'"},
                  {"Film 'rgb' 'integer xresolutions' 4", "", "'integer xresolutions': unused parameter of Film 'rgb'"},
                  {"Integrator 'pth' Integrator 'path'", "", "Integrator 'pth' is unknown"},
                  {"Integrator 'path' 'integer depth' 1 Integrator 'path'", "", "'integer depth': unused parameter"},
                  {"Camera 'perspectiv' Camera 'perspective'", "", "Camera 'perspectiv' is unknown"},
                  {"Sampler 'halten' Sampler 'halton'", "", "Sampler 'halten' is unknown"},
                  {"PixelFilter 'bux' PixelFilter 'box'", "", "PixelFilter 'bux' is unknown"},
                  {"Accelerator 'bhv' Accelerator 'bvh'", "", "Accelerator 'bhv' is unknown"},
                  {"", "Attribute 'shape' 'float raduis' 3", "of Attribute 'shape'; did you mean 'radius'"},
                  {"", "Attribute 'shape' 'integer radius' 3", "Attribute 'shape' takes 'float radius'"},
                  {"", "Attribute 'material' 'rgb reflectanse' [ 1 0 0 ]", "did you mean 'reflectance'"},
                  {"", "Attribute 'light' 'float foo' 3", "'float foo': unused parameter of Attribute 'light'"}};
    for (const auto &[options, world, message] : kCases) {
        const Outcome outcome = Try(Text(options, std::string(kLamp) + Quoted(world)));
        EXPECT_FALSE(outcome.isBuilt) << message;
        EXPECT_EQ(outcome.Count(Quoted(message)), 1) << message;
        EXPECT_EQ(outcome.diagnostics.size(), 1u) << message;
    }
    const Outcome valid =
        Try(Text("Film 'gbuffer' Integrator 'function' Integrator 'path' 'string lightsampler' 'power' "
                 "Integrator 'path'",
                 std::string(kLamp) + "Attribute 'shape' 'float alpha' 1 'float radius' 2 Attribute 'light' 'float "
                                      "scale' 2 'bool twosided' true Attribute 'material' 'string type' 'diffuse' "
                                      "Attribute 'texture' 'float uscale' 2 Attribute 'medium' 'float g' 0.1"));
    EXPECT_TRUE(valid.isBuilt);
    EXPECT_EQ(valid.Count("unused"), 0);
}

TEST(BuildScene, OnlyAnUnnamedMixMayComeBeforeItsMaterials) {
    const std::string operands =
        "MakeNamedMaterial 'a' 'string type' 'diffuse' MakeNamedMaterial 'b' 'string type' 'diffuse'\n";
    const std::string mix = "'string materials' ['a' 'b']\n";
    EXPECT_TRUE(Try(Text("", kLamp + ("Material 'mix' " + mix) + kBall + operands)).isBuilt);
    const Outcome named =
        Try(Text("", kLamp + ("MakeNamedMaterial 'm' 'string type' 'mix' " + mix) + kBall + operands));
    EXPECT_EQ(named.Count("there is no material \"a\" here; none has been defined"), 1);
    const Outcome misspelt = Try(Text("", kLamp + operands + "Material 'mix' 'string materials' ['a' 'bb']\n" + kBall));
    EXPECT_EQ(misspelt.Count("there is no material \"bb\" here; "), 1);
    EXPECT_EQ(misspelt.Count("valid: a, b"), 1);
}

TEST(BuildScene, PreparationNamesTheScenesOwnParts) {
    const BuiltScene built =
        BuildText(Text("Integrator 'path' 'integer maxdepth' 7 Sampler 'independent' 'integer pixelsamples' 12 "
                       "Option 'seed' 4",
                       kLamp));
    Progress progress;
    const PrepareContext context = built.Preparation(progress);
    EXPECT_EQ(&context.scene, built.scene.get());
    EXPECT_EQ(&context.camera, built.camera.get());
    EXPECT_EQ(&context.filter, built.filter.get());
    EXPECT_EQ(context.pixelBounds.high, Point2i(8, 6));
    EXPECT_EQ(context.seed, 4);
    EXPECT_EQ(context.samplesPerPixel, 12);
    EXPECT_EQ(context.maxDepth, 7);
    EXPECT_EQ(&context.progress, &progress);
}

TEST(IntegratorTraits, AreDeclaredByEveryIntegrator) {
    const auto with = [](bool IntegratorTraits::*trait) {
        std::string names;
        for (const std::string &name : Integrators().Names())
            if (TraitsOf(name).*trait) names += ' ' + name;
        return names;
    };
    EXPECT_EQ(with(&IntegratorTraits::hasLightSampler), " bdpt mlt path sppm volpath");
    EXPECT_EQ(with(&IntegratorTraits::hasEmissionSampler), " bdpt lightpath mlt sppm");
    EXPECT_EQ(with(&IntegratorTraits::connectsToCamera), " bdpt lightpath mlt");
    EXPECT_EQ(with(&IntegratorTraits::isGuided), " path volpath");
    EXPECT_EQ(with(&IntegratorTraits::rendersMedia), " bdpt lightpath mlt simplevolpath volpath");
    EXPECT_EQ(with(&IntegratorTraits::passesInterfaces), " bdpt lightpath mlt volpath");
    EXPECT_EQ(with(&IntegratorTraits::scattersSubsurface), " volpath");
    EXPECT_EQ(with(&IntegratorTraits::hasSampledLightOnly), " path sppm volpath");
    EXPECT_EQ(with(&IntegratorTraits::hasDepth),
              " bdpt lightpath mlt path randomwalk simplepath simplevolpath sppm volpath");
    EXPECT_FALSE(TraitsOf("function").rendersMedia);
}

TEST(BuildScene, MoreIntegratorsOverOneScene) {
    BuildOptions options;
    options.lightSampler = "power";
    const BuiltScene built = BuildText(Text("Integrator 'path' 'integer maxdepth' 7", kLamp), options);
    EXPECT_EQ(built.integratorName, "path");
    EXPECT_EQ(built.lightSamplerName, "power");
    LightChoice choice;
    EXPECT_EQ(MakeIntegrator(built, choice).lightSamplerName, "power");
    EXPECT_EQ(MakeIntegrator(built, choice).maxDepth, 7);
    choice.lightSampler = "uniform";
    choice.maxDepth = 2;
    const BuiltIntegrator made = MakeIntegrator(built, choice);
    EXPECT_EQ(made.lightSamplerName, "uniform");
    EXPECT_EQ(made.maxDepth, 2);
    EXPECT_EQ(built.maxDepth, 7);
    EXPECT_NE(made.integrator->Lights(), nullptr);
    EXPECT_NE(made.integrator->Lights(), built.integrator->Lights());
    choice.lightSampler = "unifrom";
    EXPECT_THROW(MakeIntegrator(built, choice), UserError);
}

TEST(BuildScene, MoreRgbFilmsLikeTheScenes) {
    const BuiltScene built =
        BuildText(SceneText().Film(8, 6, "'float iso' 200 'float cropwindow' [0 .5 0 1]", "gbuffer").World(kLamp));
    const std::unique_ptr<Film> film = built.film->MakeRgbFilm();
    EXPECT_EQ(film->PixelBounds().high, Point2i(4, 6));
    EXPECT_EQ(film->FullResolution(), Point2i(8, 6));
    EXPECT_FALSE(film->NeedsVisibleSurface());
    FilmSample sample;
    sample.lambda = film->SampleWavelengths(0.5f);
    sample.L = SampledSpectrum(0.01f);
    film->AddSample(sample);
    built.film->AddSample(sample);
    const Image image = film->ToImage(), original = built.film->ToImage();
    EXPECT_EQ(image.Format(), PixelFormat::Float);
    EXPECT_EQ(image.ChannelCount(), 3);
    EXPECT_NEAR(image.Get({0, 0}, 1) / original.Get({0, 0}, 1), 1, 1e-3f);
    EXPECT_EQ(film->MakeRgbFilm()->ToImage().Get({0, 0}, 1), 0);
}

TEST(BuildScene, AllMistakesAreReportedAtOnce) {
    const Outcome outcome = Try(Text("Camera 'perspective' 'float fov' 500 Sampler 'soboll'",
                                     "Material 'metal'\nShape 'spere'\nLightSource 'pont'\n"
                                     "Texture 't' 'float' 'checkered'"));
    EXPECT_FALSE(outcome.isBuilt);
    for (const char *word : {"fov", "soboll", "metal", "spere", "pont", "checkered"})
        EXPECT_EQ(outcome.Count(word), 1) << word;
}

TEST(BuildScene, AMistakeInAFlagIsReportedBeforeShapesAreRead) {
    BuildOptions options;
    options.lightSampler = "unifrom";
    const Outcome outcome = Try(Text("Sampler 'soboll'", "Shape 'spere'"), options);
    EXPECT_EQ(outcome.Count("unifrom"), 1);
    EXPECT_EQ(outcome.Count("soboll"), 1);
    EXPECT_EQ(outcome.Count("spere"), 0);
}

TEST(BuildScene, NoLightIsAWarning) {
    EXPECT_EQ(Try(Text("", kBall)).Count("no lights"), 1);
    EXPECT_EQ(Try(Text("", std::string(kBall) + kLamp)).Count("no lights"), 0);
}

TEST(BuildScene, LightTooFarForLightPathsIsAWarningWhereNothingElseFindsIt) {
    const std::string sun =
        "AttributeBegin AreaLightSource 'diffuse' Translate 0 0 1.5e11 Shape 'sphere' 'float radius' 7e8 AttributeEnd\n";
    for (const char *integrator : {"lightpath", "sppm"}) {
        const std::string head = "Integrator '" + std::string(integrator) + "'\n";
        EXPECT_EQ(Try(Text(head, kBall + sun)).Count("too far away"), 1) << integrator;
        EXPECT_EQ(Try(Text(head, std::string(kBall) + kLamp)).Count("too far away"), 0) << integrator;
    }
    for (const char *integrator : {"path", "bdpt", "mlt"})
        EXPECT_EQ(Try(Text("Integrator '" + std::string(integrator) + "'\n", kBall + sun)).Count("too far away"), 0)
            << integrator;
}

TEST(BuildScene, TheNameOfTheImageHasASuffixIfPartsAreLeftOut) {
    const std::string medium = "MakeNamedMedium 'fog' 'string type' 'homogeneous'\n";
    const std::string text = SceneText().Head("Film 'rgb' 'string filename' 'a/b.exr'").Head(medium).World(kLamp);
    EXPECT_EQ(BuildText(text).filename, "a/b.exr");
    BuildOptions options;
    options.ignoreMedia = true;
    BuiltScene built = BuildText(text, options);
    EXPECT_EQ(built.filename, "a/b-without-media.exr");
    ASSERT_EQ(built.leftOut.size(), 1u);
    ExpectWords(built.leftOut[0], {"fog"});
    options.film.filename = "mine.exr";
    EXPECT_EQ(BuildText(text, options).filename, "mine.exr");
    EXPECT_EQ(BuildText(Text("", kLamp)).filename, "pbrt.exr");
}

TEST(BuildScene, AnUnwritableOutputIsReportedFirst) {
    BuildOptions options;
    options.film.filename = "/nowhere/at/all.exr";
    EXPECT_TRUE(Try(Text("", kLamp), options).isBuilt);
    options.checksOutput = true;
    EXPECT_EQ(Try(Text("", kLamp), options).Count("/nowhere/at/all.exr"), 1);
    options.film.filename = ::testing::TempDir() + "fine.exr";
    options.mseReferenceImage = "/nowhere/reference.exr";
    EXPECT_EQ(Try(Text("", kLamp), options).Count("needs both"), 1);
    options.mseReferenceOut = ::testing::TempDir() + "errors.txt";
    EXPECT_EQ(Try(Text("", kLamp), options).Count("/nowhere/reference.exr"), 1);
}

TEST(BuildScene, ThreadsMakeNoDifference) {
    std::string world = kLamp;
    for (int i = 0; i < 40; ++i)
        world +=
            fmt::format("AttributeBegin Translate {} 0 9 Shape '{}' AttributeEnd\n", 3 * i, i % 3 ? "sphere" : "disk");
    auto shapes = [&](int threads) {
        const ThreadLimit limit(threads);
        const BuiltScene built = BuildText(Text("", world));
        std::vector<Float> areas;
        for (uint32_t i = 0; i < built.scene->ShapeCount(); ++i)
            areas.push_back(built.scene->ShapeOf(ShapeId(i)).PrimitiveBounds(0).SurfaceArea());
        return areas;
    };
    EXPECT_EQ(shapes(1).size(), 40u);
    EXPECT_EQ(shapes(1), shapes(4));
}

}  // namespace
}  // namespace pbrt::test
