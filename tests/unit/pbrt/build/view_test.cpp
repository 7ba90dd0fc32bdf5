// Tests the stages that build the view of a scene: camera, film, filter and sampler.
#include "pbrt/build/built_scene.h"

#include <gtest/gtest.h>

#include "support/errors.h"
#include "support/parse_text.h"
#include "support/scene_text.h"

namespace pbrt {
namespace {

SceneDescription Parse(const std::string &text) {
    DiagnosticSink sink;
    SceneDescription description = ParseSceneText(test::SceneText().Head(text).World(), sink);
    sink.ThrowIfErrors();
    return description;
}

/// The view of directives without mistakes.
RenderView ViewOf(const std::string &text, int seed = 0) {
    SceneDescription d = Parse(text);
    DiagnosticSink sink;
    RenderView view = MakeView(d, {}, {}, seed, sink);
    EXPECT_FALSE(sink.HasErrors());
    return view;
}

void ExpectPoint(const Point3 &p, const Point3 &expected) {
    EXPECT_LT(Distance(p, expected), 1e-5f) << p.x << " " << p.y << " " << p.z;
}

TEST(PlaceCamera, RenderingSpaceIsWhereTheCameraIs) {
    const SceneDescription d = Parse("LookAt 3 2 1  3 2 5  0 1 0 Camera 'perspective'");
    const Point3 eye(3, 2, 1), ahead(3, 2, 4);
    auto place = [&](const char *system) {
        DiagnosticSink sink;
        BuildOptions options;
        options.renderCoordSys = system;
        const Placement placement = PlaceCamera(d, options, sink);
        EXPECT_FALSE(sink.HasErrors());
        // The camera must see the same wherever rendering space is.
        ExpectPoint(placement.renderFromCamera.At(0).InversePoint(placement.renderFromWorld.Point(ahead)), {0, 0, 3});
        ExpectPoint(placement.worldFromCamera.At(0).Point({0, 0, 3}), ahead);
        return placement.renderFromWorld;
    };
    for (const char *system : {"", "cameraworld"}) {
        ExpectPoint(place(system).Point(eye), {0, 0, 0});
        ExpectPoint(place(system).Point(ahead), {0, 0, 3});
    }
    ExpectPoint(place("camera").Point(eye), {0, 0, 0});
    ExpectPoint(place("world").Point(eye), eye);
}

TEST(PlaceCamera, RenderingSpaceKeepsTheWorldsDistancesAndSides) {
    const SceneDescription d = Parse("Scale -2 1 0.5 LookAt 3 2 1  3 4 5  0 1 0 Camera 'perspective'");
    for (const char *system : {"camera", "cameraworld", "world"}) {
        DiagnosticSink sink;
        BuildOptions options;
        options.renderCoordSys = system;
        const Transform renderFromWorld = PlaceCamera(d, options, sink).renderFromWorld;
        EXPECT_NEAR(renderFromWorld.UniformScale(1e-5).value_or(0), 1, 1e-5) << system;
        EXPECT_FALSE(renderFromWorld.SwapsHandedness()) << system;
    }
}

TEST(PlaceCamera, TheSceneNamesTheSpaceUnlessAFlagDoes) {
    const SceneDescription d = Parse("Option 'rendercoordsys' 'world' LookAt 3 2 1  3 2 5  0 1 0 Camera 'perspective'");
    DiagnosticSink sink;
    BuildOptions options;
    ExpectPoint(PlaceCamera(d, options, sink).renderFromWorld.Point({1, 1, 1}), {1, 1, 1});
    options.renderCoordSys = "cameraworld";
    ExpectPoint(PlaceCamera(d, options, sink).renderFromWorld.Point({3, 2, 1}), {0, 0, 0});
    options.renderCoordSys = "nowhere";
    PlaceCamera(d, options, sink);
    ASSERT_EQ(sink.ErrorCount(), 1u);
    test::ExpectWords(sink.All()[0].message, {"\"nowhere\""});
}

TEST(PlaceCamera, AMovingCameraIsAtTheOriginHalfway) {
    const SceneDescription d =
        Parse("ActiveTransform EndTime Translate -4 0 0 ActiveTransform All\nCamera 'perspective'");
    DiagnosticSink sink;
    const Placement placement = PlaceCamera(d, {}, sink);
    ASSERT_FALSE(sink.HasErrors());
    EXPECT_TRUE(placement.renderFromCamera.IsAnimated());
    ExpectPoint(placement.renderFromCamera.At(0).Point(Point3(0)), {-2, 0, 0});
    ExpectPoint(placement.renderFromCamera.At(0.5f).Point(Point3(0)), {0, 0, 0});
    ExpectPoint(placement.renderFromCamera.At(1).Point(Point3(0)), {2, 0, 0});
}

TEST(PlaceCamera, ACameraWithoutAPlaceIsAnErrorAtItsDirective) {
    const SceneDescription d = Parse("Scale 1 0 1\nCamera 'perspective'");
    DiagnosticSink sink;
    const Placement placement = PlaceCamera(d, {}, sink);
    ASSERT_EQ(sink.ErrorCount(), 1u);
    EXPECT_EQ(sink.All()[0].loc.line, 2);
    ExpectPoint(placement.renderFromWorld.Point({1, 2, 3}), {1, 2, 3});
}

TEST(MakeView, TakesTheParametersOfTheScene) {
    const RenderView view = ViewOf(
        "Film 'gbuffer' 'integer xresolution' 40 'integer yresolution' 30 'float diagonal' 20\n"
        "Sampler 'independent' 'integer pixelsamples' 7\nPixelFilter 'triangle' 'float xradius' 3\n"
        "Camera 'perspective' 'float shutteropen' 1 'float shutterclose' 3");
    EXPECT_EQ(view.film->FullResolution(), Point2i(40, 30));
    EXPECT_EQ(view.film->DiagonalMm(), 20);
    EXPECT_TRUE(view.film->NeedsVisibleSurface());
    EXPECT_EQ(view.sampler->SamplesPerPixel(), 7);
    EXPECT_EQ(view.filter->Radius().x, 3);
    EXPECT_EQ(view.camera->ShutterClose(), 3);
}

TEST(MakeView, TheShutterTimeIsTheExposure) {
    auto brightness = [](const std::string &shutter) {
        const RenderView view =
            ViewOf("Film 'rgb' 'integer xresolution' 1 'integer yresolution' 1\nCamera 'perspective' " + shutter);
        FilmSample sample;
        sample.lambda = view.film->SampleWavelengths(0.5f);
        sample.L = SampledSpectrum(0.01f);
        view.film->AddSample(sample);
        return view.film->ToImage().Get({0, 0}, 1);
    };
    const Float one = brightness("");
    EXPECT_GT(one, 0);
    EXPECT_NEAR(brightness("'float shutterclose' 0.5") / one, 0.5f, 1e-2f);
    EXPECT_NEAR(brightness("'float shutteropen' 2 'float shutterclose' 4") / one, 2, 1e-2f);
}

TEST(MakeView, TheSamplersOwnSeedBeatsTheOthers) {
    auto number = [](const std::string &parameter, int seed) {
        const RenderView view = ViewOf("Sampler 'independent' " + parameter, seed);
        view.sampler->StartPixelSample({3, 4}, 0);
        return view.sampler->Get1D();
    };
    EXPECT_EQ(number("'integer seed' 3", 0), number("", 3));
    EXPECT_EQ(number("'integer seed' 3", 8), number("", 3));
    EXPECT_NE(number("", 8), number("", 3));
}

TEST(MakeView, OneMistakeDoesNotHideAnother) {
    SceneDescription d = Parse(
        "Film 'rgb' 'integer xresolution' -1\nPixelFilter 'boxx'\n"
        "Sampler 'independent' 'integer pixelsamples' 0\nCamera 'perspective' 'float fov' 500");
    DiagnosticSink sink;
    const RenderView view = MakeView(d, {}, {}, 0, sink);
    EXPECT_EQ(sink.ErrorCount(), 4u);
    EXPECT_FALSE(view.film || view.filter || view.sampler || view.camera);
}

}  // namespace
}  // namespace pbrt
