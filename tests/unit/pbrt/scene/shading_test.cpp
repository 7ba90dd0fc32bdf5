// Tests what a surface point scatters and emits, and its filter footprint.
#include "pbrt/scene/shading.h"

#include <gtest/gtest.h>

#include "support/build_text.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

const SampledWavelengths kLambda = SampledWavelengths::SampleVisible(0.3f);

BuiltScene BuildView(const std::string &world) {
    return BuildText(SceneText()
                         .Head("Option 'rendercoordsys' 'world'")
                         .LookAt("0 0 4  0 0 0  0 1 0")
                         .Camera(60)
                         .Film(100, 100)
                         .World(world));
}

/// The surface point that is seen from (x, y, z) along `direction` on the z axis.
SurfacePoint PointAt(const BuiltScene &built, Float x = 0.2f, Float y = 0.1f, Float z = 4, Float direction = -1) {
    std::optional<SurfacePoint> point = built.scene->Intersect({.o = {x, y, z}, .d = {0, 0, direction}});
    EXPECT_TRUE(point);
    return *point;
}

const std::string kFacingQuad = "Shape 'bilinearmesh' 'point3 P' [ -1 -1 0  1 -1 0  -1 1 0  1 1 0 ]\n";

TEST(Shading, SurfacesScatterByTheirMaterial) {
    const BuiltScene built = BuildView("Material 'diffuse' 'rgb reflectance' [.6 .6 .6]\n" + kFacingQuad);
    SurfacePoint point = PointAt(built);
    SampledWavelengths lambda = kLambda;
    const Bsdf bsdf = ComputeBsdf(*built.scene, point, lambda);
    ASSERT_TRUE(bsdf);
    EXPECT_NEAR(bsdf.F(point.wo, Normalize(Vector3(1, 0, 1))).Average(), 0.6f / Pi, 1e-3f);
    EXPECT_FALSE(lambda.SecondaryTerminated());
}

TEST(Shading, InterfacesDoNotScatter) {
    for (const char *material : {"Material 'interface'\n", "Material ''\n"}) {
        const BuiltScene built = BuildView(material + kFacingQuad);
        SurfacePoint point = PointAt(built);
        SampledWavelengths lambda = kLambda;
        EXPECT_FALSE(ComputeBsdf(*built.scene, point, lambda)) << material;
    }
}

TEST(Shading, DispersionEndsTheOtherWavelengths) {
    const BuiltScene built = BuildView("Material 'dielectric' 'spectrum eta' 'glass-F11'\n" + kFacingQuad);
    SurfacePoint point = PointAt(built);
    SampledWavelengths lambda = kLambda;
    EXPECT_TRUE(ComputeBsdf(*built.scene, point, lambda));
    EXPECT_TRUE(lambda.SecondaryTerminated());
}

TEST(Shading, MixturesTakeOneOfTheirMaterialsPerPoint) {
    const BuiltScene built = BuildView(
        "MakeNamedMaterial 'a' 'string type' 'diffuse' 'rgb reflectance' [.2 .2 .2]\n"
        "MakeNamedMaterial 'b' 'string type' 'diffuse' 'rgb reflectance' [.8 .8 .8]\n"
        "Material 'mix' 'string materials' ['a' 'b'] 'float amount' 0.25\n" +
        kFacingQuad);
    int light = 0;
    constexpr int kPoints = 2000;
    for (int i = 0; i < kPoints; ++i) {
        SurfacePoint point = PointAt(built, -0.9f + 1.8f * Float(i) / kPoints, 0.3f);
        SampledWavelengths lambda = kLambda;
        const Bsdf bsdf = ComputeBsdf(*built.scene, point, lambda);
        const Float albedo = Pi * bsdf.F(point.wo, Normalize(Vector3(1, 0, 1))).Average();
        EXPECT_TRUE(std::abs(albedo - 0.2f) < 3e-3f || std::abs(albedo - 0.8f) < 3e-3f) << albedo;
        light += albedo > 0.5f;
    }
    EXPECT_NEAR(light / double(kPoints), 0.25, 0.05);
}

TEST(Shading, AreaLightsEmitFromTheirFrontUnlessTwosided) {
    for (const char *sides : {"", "'bool twosided' true"}) {
        const BuiltScene built =
            BuildView(fmt::format("AreaLightSource 'diffuse' 'rgb L' [3 3 3] {}\n{}", sides, kFacingQuad));
        const SurfacePoint above = PointAt(built), below = PointAt(built, 0.2f, 0.1f, -4, 1);
        const Float up = EmittedRadiance(*built.scene, above, kLambda).Average(),
                    down = EmittedRadiance(*built.scene, below, kLambda).Average();
        EXPECT_GT(std::max(up, down), 0);
        if (*sides) EXPECT_EQ(up, down);
        else EXPECT_EQ(std::min(up, down), 0);
    }
    const BuiltScene dark = BuildView(kFacingQuad);
    EXPECT_EQ(EmittedRadiance(*dark.scene, PointAt(dark), kLambda).Average(), 0);
}

TEST(Shading, OnlySubsurfaceMaterialsLetLightComeOutElsewhere) {
    const BuiltScene wax = BuildView("Material 'subsurface'\n" + kFacingQuad),
                     glass = BuildView("Material 'dielectric'\n" + kFacingQuad);
    EXPECT_TRUE(ComputeBssrdf(*wax.scene, PointAt(wax), kLambda));
    EXPECT_FALSE(ComputeBssrdf(*glass.scene, PointAt(glass), kLambda));
}

/// A camera ray, and the surface point that it meets, with its footprint.
std::pair<CameraRay, SurfacePoint> Seen(const BuiltScene &built, const Point2 &pFilm) {
    CameraSample sample;
    sample.pFilm = pFilm;
    const CameraRay ray = *built.camera->GenerateRay(sample, kLambda);
    SurfacePoint point = *built.scene->Intersect(ray.ray);
    ComputeFootprint(point, ray.differential, *built.camera, 1);
    return {ray, point};
}

TEST(Footprint, IsThePixelsSizeOnTheCamerasAxis) {
    const BuiltScene built = BuildView(kFacingQuad);
    auto [ray, point] = Seen(built, {50, 50});
    // The size of a pixel at distance 4, with 100 pixels over 60 degrees.
    const Float pixel = 2 * 4 * std::tan(Radians(30)) / 100;
    EXPECT_NEAR(Length(point.dpdx), pixel, 1e-3f * pixel);
    EXPECT_NEAR(Length(point.dpdy), pixel, 1e-3f * pixel);
    EXPECT_NEAR(Dot(point.dpdx, point.dpdy), 0, 1e-3f * pixel * pixel);
    // The quad is 2 wide, and its parameters go from 0 to 1.
    EXPECT_NEAR(std::abs(point.dudx), pixel / 2, 1e-3f * pixel);
    EXPECT_NEAR(std::abs(point.dvdy), pixel / 2, 1e-3f * pixel);
    EXPECT_NEAR(point.dudy, 0, 1e-3f * pixel);
    SurfacePoint large = point;
    large.dpdu *= 1e12f;
    large.dpdv *= 1e12f;
    ComputeFootprint(large, ray.differential, *built.camera, 1);
    EXPECT_NEAR(large.dudx * 1e12f, point.dudx, 1e-3f * pixel);
    // Without differentials the footprint is the camera's estimate. That is the one of the film's corner, whose pixels
    // subtend the smallest angles, and it shrinks with the number of samples.
    ComputeFootprint(point, {}, *built.camera, 1);
    EXPECT_LT(Length(point.dpdx), pixel);
    EXPECT_GT(Length(point.dpdx), 0.5f * pixel);
    const Float one = Length(point.dpdx);
    ComputeFootprint(point, {}, *built.camera, 16);
    EXPECT_NEAR(Length(point.dpdx) / one, 0.25f, 1e-2f);
}

TEST(Footprint, AFlatMirrorKeepsTheSpreadOfRays) {
    const BuiltScene built = BuildView(kFacingQuad);
    const auto [ray, point] = Seen(built, {60, 45});
    const Vector3 d = ray.ray.d, wi(d.x, d.y, -d.z);
    const RayDifferential reflected = ReflectDifferential(point, ray.differential, wi);
    ASSERT_TRUE(reflected.valid);
    const Vector3 rx = ray.differential.rxDirection;
    EXPECT_LT(Length(reflected.rxDirection - Vector3(rx.x, rx.y, -rx.z)), 1e-4f);
    EXPECT_LT(Length(reflected.rxOrigin - (point.p + point.dpdx)), 1e-4f);
    EXPECT_FALSE(ReflectDifferential(point, {}, wi).valid);
}

}  // namespace
}  // namespace pbrt::test
