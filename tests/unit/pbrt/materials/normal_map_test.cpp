#include "material_test_support.h"
#include "pbrt/materials/material_params.h"
#include "pbrt/math/frame.h"
#include "support/folder_test.h"

namespace pbrt {
namespace {

/// An image of one column of pixels, top first; each pixel encodes a normal.
std::shared_ptr<const Image> Picture(const std::vector<Vector3> &normals) {
    Image image(PixelFormat::Float, {1, static_cast<int>(normals.size())}, {"R", "G", "B"});
    for (size_t y = 0; y < normals.size(); ++y)
        for (int c = 0; c < 3; ++c) image.Set({0, static_cast<int>(y)}, c, (normals[y][c] + 1) / 2);
    return std::make_shared<const Image>(std::move(image));
}

SurfacePoint PointAtOrigin() {
    SurfacePoint s;
    s.n = s.shading.n = {0, 0, 1};
    s.dpdu = s.shading.dpdu = {2, 0, 0};
    s.dpdv = s.shading.dpdv = {0, 3, 0};
    return s;
}

void ExpectSameVector(const Vector3 &a, const Vector3 &b) {
    EXPECT_LT(Distance(a, b), 1e-5f) << a.x << " " << a.y << " " << a.z;
}

TEST(NormalMap, FrameTurnsToTheMappedNormal) {
    SurfacePoint s = PointAtOrigin();
    ApplyNormalMap(*Picture({{.6f, 0, .8f}}), s);
    ExpectSameVector(s.shading.n, {.6f, 0, .8f});
    ExpectSameVector(s.shading.dpdu, Vector3(.8f, 0, -.6f) * 2.f);
    ExpectSameVector(s.shading.dpdv, {0, 3, 0});
    ExpectSameVector(s.n, {0, 0, 1});
    ExpectSameVector(s.dpdu, {2, 0, 0});
}

TEST(NormalMap, PixelsNeedNotBeUnit) {
    SurfacePoint s = PointAtOrigin();
    ApplyNormalMap(*Picture({{.3f, 0, .4f}}), s);
    ExpectSameVector(s.shading.n, {.6f, 0, .8f});
}

TEST(NormalMap, StraightUpChangesNothing) {
    SurfacePoint s = test::TestPoint(), t = s;
    ApplyNormalMap(*Picture({{0, 0, 1}}), t);
    ExpectSameVector(s.shading.n, t.shading.n);
    ExpectSameVector(s.shading.dpdu, t.shading.dpdu);
    ExpectSameVector(s.shading.dpdv, t.shading.dpdv);
}

TEST(NormalMap, FrameStaysOrthogonalWithItsLengths) {
    SurfacePoint s = test::TestPoint();
    Vector3 u = s.shading.dpdu, v = s.shading.dpdv, n = s.shading.n;
    Vector3 mapped = Normalize(Vector3(.3f, -.5f, .7f));
    ApplyNormalMap(*Picture({mapped}), s);
    ExpectSameVector(s.shading.n, Frame::FromXZ(Normalize(u), n).FromLocal(mapped));
    EXPECT_NEAR(Dot(s.shading.n, s.shading.dpdu), 0, 1e-5f);
    EXPECT_NEAR(Dot(s.shading.n, s.shading.dpdv), 0, 1e-5f);
    EXPECT_NEAR(Dot(s.shading.dpdu, s.shading.dpdv), 0, 1e-5f);
    EXPECT_NEAR(Length(s.shading.dpdu), Length(u), 1e-5f);
    EXPECT_NEAR(Length(s.shading.dpdv), Length(v), 1e-5f);
}

TEST(NormalMap, NormalStaysOnTheGeometricSide) {
    SurfacePoint s = PointAtOrigin();
    s.n = {0, 0, -1};
    ApplyNormalMap(*Picture({{.6f, 0, .8f}}), s);
    ExpectSameVector(s.shading.n, {-.6f, 0, -.8f});
}

TEST(NormalMap, ZeroVIsTheBottomRowAndItRepeats) {
    const auto map = Picture({{.6f, 0, .8f}, {0, .6f, .8f}});
    for (Float v : {.25f, 1.25f, -.75f}) {
        SurfacePoint s = PointAtOrigin();
        s.uv = {.5f, v};
        ApplyNormalMap(*map, s);
        ExpectSameVector(s.shading.n, {0, .6f, .8f});
    }
    SurfacePoint s = PointAtOrigin();
    s.uv = {.5f, .75f};
    ApplyNormalMap(*map, s);
    ExpectSameVector(s.shading.n, {.6f, 0, .8f});
}

TEST(NormalMap, NoDirectionChangesNothing) {
    SurfacePoint s = PointAtOrigin();
    ApplyNormalMap(*Picture({{0, 0, 0}}), s);
    ExpectSameVector(s.shading.n, {0, 0, 1});
}

class NormalMapFile : public test::FolderTest {};

/// The bytes of a PNG are plain numbers here, not sRGB.
TEST_F(NormalMapFile, IsReadByTheMaterial) {
    Image image(PixelFormat::Float, {2, 2}, {"R", "G", "B"});
    ColorEncoding srgb;
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c) image.Set({i & 1, i >> 1}, c, srgb.ToLinear((Vector3(.6f, 0, .8f)[c] + 1) / 2));
    WriteImage(Path("normals.png"), image);
    test::Workshop shop;
    MaterialPtr plain = shop.Make("diffuse"),
                mapped = shop.Make("coateddiffuse", test::Params("m").S("normalmap", {Path("normals.png")}));
    SurfacePoint s = PointAtOrigin();
    plain->PerturbShading(s);
    ExpectSameVector(s.shading.n, {0, 0, 1});
    mapped->PerturbShading(s);
    EXPECT_LT(Distance(s.shading.n, {.6f, 0, .8f}), 0.01f);
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    ExpectSameVector(mapped->GetBsdf(s, lambda).ShadingFrame().z, s.shading.n);
    EXPECT_EQ(shop.Errors(), 0u);
}

}  // namespace
}  // namespace pbrt
