#include <gtest/gtest.h>

#include "pbrt/build/built_scene.h"
#include "pbrt/build/geometry_builder.h"
#include "support/build_text.h"
#include "support/parse_text.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

const SampledWavelengths kLambda = SampledWavelengths::SampleVisible(Float(0.3));

/// The media of a scene and where its world is in rendering space.
struct Built {
    BuiltMedia media;
    Transform renderFromWorld;
    DiagnosticSink sink;

    explicit Built(const std::string &text) {
        SceneDescription d = ParseSceneText(text, sink);
        renderFromWorld = PlaceCamera(d, {}, sink).renderFromWorld;
        media = MakeMedia(d, renderFromWorld, sink);
    }
    Float DensityAt(const std::string &name, const Point3 &world) const {
        const MediumId id = media.Find(name);
        return media.media.at(id.value)->At(renderFromWorld.Point(world), kLambda).absorption[0];
    }
};

std::string Grid(const std::string &name) {
    return "MakeNamedMedium '" + name + "' 'string type' 'uniformgrid' 'float density' [ 2 ]\n";
}

TEST(MediumBuilder, MediaTakeTheTransformationOfTheirPlaceInTheFile) {
    // Before the camera, between camera and world, and in the world. The camera is at (10, 20, 30).
    const Built all(SceneText()
                        .Head("Translate 4 5 6\n" + Grid("early") + "Identity")
                        .LookAt("10 20 30 0 0 0 0 1 0")
                        .Camera("perspective")
                        .Head("Identity Translate 7 5 6\n" + Grid("middle"))
                        .World("Translate 10 5 6 Scale 2 2 2\n" + Grid("late")));
    ASSERT_FALSE(all.sink.HasErrors());
    EXPECT_NEAR(all.DensityAt("early", {4.5f, 5.5f, 6.5f}), 2, 1e-4f);
    EXPECT_NEAR(all.DensityAt("early", {4.25f, 5.5f, 6.5f}), 1.5f, 1e-4f);
    EXPECT_EQ(all.DensityAt("early", {3.9f, 5.5f, 6.5f}), 0);
    EXPECT_NEAR(all.DensityAt("middle", {7.5f, 5.5f, 6.5f}), 2, 1e-4f);
    EXPECT_NEAR(all.DensityAt("late", {11, 6, 7}), 2, 1e-4f);
    EXPECT_FALSE(all.media.Find(""));
}

TEST(MediumBuilder, MistakesInUnusedMediaAreReported) {
    const Built built(
        SceneText().World("MakeNamedMedium 'a' 'string type' 'homogeneous' 'float g' 3\n"
                          "MakeNamedMedium 'b' 'string type' 'cloudd' "
                          "MakeNamedMedium 'c' 'string type' 'homogeneous'\n"));
    EXPECT_EQ(built.sink.ErrorCount(), 2u);
    EXPECT_EQ(built.media.media.size(), 1u);
    EXPECT_FALSE(built.media.Find("a"));
    EXPECT_EQ(built.media.Find("c"), MediumId(0u));
}

}  // namespace
}  // namespace pbrt::test
