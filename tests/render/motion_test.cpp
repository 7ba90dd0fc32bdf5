// A moving picture against still ones: at every moment it is the still picture of that moment.
#include <gtest/gtest.h>

#include "pbrt/integrators/pixel_integrator.h"
#include "support/build_text.h"
#include "support/errors.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

constexpr Point2i kResolution(48, 32);

/// Where things are at a moment: t from 0 (start) to 1.
struct Pose {
    Float t;
    std::string Text(const char *format, Float a, Float b) const {
        return fmt::format(fmt::runtime(format), Lerp(t, a, b));
    }
    /// CTMs of things that move straight, turn, grow and stretch.
    std::string Ball() const { return Text("Translate {} 0 0 ", -2, 0) + Text("Scale {0} 1 1\n", 1, 0.5f); }
    std::string Bar() const { return "Translate 1.5 0 0 " + Text("Rotate {} 0 0 1\n", 10, 100); }
    std::string Camera() const { return Text("Rotate {} 0 1 0 ", 0, -25) + Text("Translate {} 0 6\n", 0, 1.5f); }
};

/// Two poses: moving between them.
std::string Place(const std::function<std::string(const Pose &)> &text, const std::vector<Float> &poses) {
    if (poses.size() == 1) return text({poses[0]});
    return "ActiveTransform StartTime\n" + text({poses[0]}) + "ActiveTransform EndTime\n" + text({poses[1]}) +
           "ActiveTransform All\n";
}

/// Moves from time 1 to 3; the shutter is open from 1.5 to 2.5.
std::string Scene(const std::vector<Float> &poses, bool cameraMoves) {
    const std::vector<Float> camera = cameraMoves ? poses : std::vector<Float>{0.0f};
    const std::vector<Float> things = cameraMoves ? std::vector<Float>{0.0f} : poses;
    const Objects bar =
        Objects()
            .Quad("-0.3 -1 0  0.3 -1 0  -0.3 1 0.3  0.3 1 0.3")
            .Attribute(Place([](const Pose &p) { return p.Text("Translate 0 {} 0\n", 0.5f, 1); }, things),
                       Objects().Sphere(0.4));
    return SceneText()
        .Head("TransformTimes 1 3\n" + Place(&Pose::Camera, camera))
        .InWorldSpace()  // instances turn about the camera, which lies on the bar's axis
        .Camera("perspective", "'float fov' 40 'float shutteropen' 1.5 'float shutterclose' 2.5")
        .Film(kResolution.x, kResolution.y, "", "gbuffer")
        .Samples(1)
        .Integrator("path", 0)
        .World(Objects()
                   .Light("infinite")
                   .Attribute("Translate 0 -1 0 Rotate 90 1 0 0", Objects().Disk(4))
                   .Attribute(Place(&Pose::Ball, things), Objects().Sphere(0.7))
                   .Add("ObjectBegin 'bar'")
                   .Add(bar)
                   .Add("ObjectEnd")
                   .Attribute(Place(&Pose::Bar, things), Objects().Add("ObjectInstance 'bar'")));
}

BuiltScene Build(const std::vector<Float> &poses, bool cameraMoves) { return BuildText(Scene(poses, cameraMoves)); }

TEST(Motion, EveryMomentIsAStillPicture) {
    constexpr int kMoments = 9;
    const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    for (bool cameraMoves : {false, true}) {
        const BuiltScene moving = Build({0, 1}, cameraMoves);
        double coverage[2] = {}, difference = 0;
        int hits = 0, silhouettes = 0;
        for (int m = 0; m < kMoments; ++m) {
            const Float u = (Float(m) + 0.5f) / kMoments;
            const BuiltScene still = Build({0.25f + 0.5f * u}, cameraMoves);
            for (int y = 0; y < kResolution.y; ++y)
                for (int x = 0; x < kResolution.x; ++x) {
                    const CameraSample sample{.pFilm = Point2(x, y) + Point2(0.5f), .time = u};
                    std::optional<VisibleSurface> seen[2];
                    for (int k = 0; k < 2; ++k) {
                        const BuiltScene &built = k == 0 ? moving : still;
                        std::optional<CameraRay> ray = built.camera->GenerateRay(sample, lambda);
                        ASSERT_TRUE(ray);
                        EXPECT_FLOAT_EQ(ray->ray.time, 1.5f + u);
                        // In camera space: so this sees the camera's place at that time, too.
                        SampledWavelengths used = lambda;
                        Progress progress;
                        const RenderPass pass{.camera = *built.camera,
                                              .filter = *built.filter,
                                              .film = *built.film,
                                              .samplers = {},
                                              .progress = progress};
                        const Transform cameraFromRender = built.camera->CameraFromRender(ray->ray.time);
                        dynamic_cast<const PixelIntegrator &>(*built.integrator)
                            .Li({{*ray, {x, y}, 0, &seen[k]}, pass}, used, *built.sampler->Clone());
                        if (seen[k]) {
                            seen[k]->p = cameraFromRender.Point(seen[k]->p);
                            seen[k]->n = Normalize(cameraFromRender.Normal(seen[k]->n));
                        }
                        coverage[k] += seen[k].has_value();
                    }
                    hits += seen[0].has_value();
                    if (seen[0].has_value() != seen[1].has_value() ||
                        (seen[0] && Distance(seen[0]->p, seen[1]->p) > 0.02f))
                        ++silhouettes;
                    else if (seen[0]) difference = std::max(difference, double(Distance(seen[0]->n, seen[1]->n)));
                }
        }
        EXPECT_GT(hits, kMoments * kResolution.x * kResolution.y / 8);
        EXPECT_LE(silhouettes, hits / 200) << "of " << hits;
        EXPECT_LT(difference, 0.02);
        EXPECT_NEAR(coverage[0], coverage[1], 0.002 * coverage[1]);
    }
}

/// Not the same moment twice: the test above would pass without motion if poses did not differ.
TEST(Motion, MomentsDiffer) {
    const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    for (bool cameraMoves : {false, true}) {
        const BuiltScene moving = Build({0, 1}, cameraMoves);
        int different = 0;
        for (int i = 0; i < kResolution.x * kResolution.y; ++i) {
            std::optional<SurfacePoint> seen[2];
            for (int k = 0; k < 2; ++k) {
                const CameraSample sample{.pFilm = Point2(i % kResolution.x, i / kResolution.x), .time = Float(k)};
                seen[k] = moving.scene->Intersect(moving.camera->GenerateRay(sample, lambda)->ray);
            }
            different += seen[0].has_value() != seen[1].has_value();
        }
        EXPECT_GT(different, kResolution.x * kResolution.y / 20);
    }
}

TEST(Motion, InstancesMoveAlikeInEveryRenderingSpace) {
    const auto hits = [](const std::string &space) {
        const BuiltScene built = BuildText(SceneText()
                                               .Head("Option 'rendercoordsys' '" + space + "'")
                                               .LookAt("1 2 -6  0 0 0  0 1 0")
                                               .Camera(40)
                                               .Film(kResolution.x, kResolution.y)
                                               .World(Objects()
                                                          .Light("infinite")
                                                          .Add("ObjectBegin 'bar'")
                                                          .Quad("-0.3 -1 0  0.3 -1 0  -0.3 1 0  0.3 1 0")
                                                          .Add("ObjectEnd ActiveTransform EndTime Translate 0.5 0 0 "
                                                               "Rotate 70 0 0 1 ObjectInstance 'bar'")));
        const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
        std::vector<int> all;
        for (int i = 0; i < kResolution.x * kResolution.y; ++i) {
            const CameraSample sample{.pFilm = Point2(i % kResolution.x, i / kResolution.x), .time = 0.5f};
            all.push_back(built.scene->Intersect(built.camera->GenerateRay(sample, lambda)->ray).has_value());
        }
        return all;
    };
    const std::vector<int> expected = hits("cameraworld");
    EXPECT_GT(std::count(expected.begin(), expected.end(), 1), 30);
    for (const char *space : {"camera", "world"}) {
        const std::vector<int> found = hits(space);
        int different = 0;
        for (size_t i = 0; i < found.size(); ++i) different += found[i] != expected[i];
        EXPECT_LE(different, 2) << space;  // rounding at the silhouette
    }
}

TEST(Motion, WhatCannotMoveIsAnError) {
    const auto message = [](const std::string &world, const std::string &camera) {
        return MessageOf([&] {
            BuildText(SceneText().Head(camera).Camera("perspective").World(Objects().Light("infinite").Add(world)));
        });
    };
    const std::string flat = "ActiveTransform EndTime Scale 1 1 0 ActiveTransform All\n";
    const std::string mirrored = "ActiveTransform EndTime Scale 1 1 -1 ActiveTransform All\n";
    for (const std::string &bad : {flat, mirrored}) {
        ExpectWords(message(bad + "Shape 'sphere'", ""), {"shape", "cannot move"});
        ExpectWords(message("ObjectBegin 'a' Shape 'sphere' ObjectEnd\n" + bad + "ObjectInstance 'a'", ""),
                    {"instance", "cannot move"});
    }
    ExpectWords(message("", flat), {"Camera", "inverted"});
    ExpectWords(message("", mirrored), {"Camera", "cannot move"});
    EXPECT_EQ(message("ActiveTransform EndTime Translate 1 1 0 ActiveTransform All Shape 'sphere'", ""), "");
}

}  // namespace
}  // namespace pbrt::test
