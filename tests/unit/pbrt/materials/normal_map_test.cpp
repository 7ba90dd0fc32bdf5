#include "material_test_support.h"
#include "pbrt/materials/material_params.h"
#include "pbrt/math/frame.h"
#include "support/folder_test.h"

namespace pbrt::test {
namespace {

SurfacePoint Mapped(const Vector3 &normal, SurfacePoint s = FlatPoint()) {
    ApplyNormalMap(*NormalMapOf({normal}), s);
    return s;
}

TEST(NormalMap, FrameTurnsToTheMappedNormalWhichNeedNotBeUnit) {
    SurfacePoint s = Mapped({.6f, 0, .8f});
    ExpectNear(s.shading.n, {.6f, 0, .8f});
    ExpectNear(s.shading.dpdu, Vector3(.8f, 0, -.6f) * 2.f);
    ExpectNear(s.shading.dpdv, {0, 3, 0});
    ExpectNear(s.n, {0, 0, 1});
    ExpectNear(s.dpdu, {2, 0, 0});
    ExpectNear(Mapped({.3f, 0, .4f}).shading.n, {.6f, 0, .8f});
}

TEST(NormalMap, StraightUpAndNoDirectionChangeNothing) {
    SurfacePoint s = TestPoint(), t = Mapped({0, 0, 1}, s);
    ExpectNear(s.shading.n, t.shading.n);
    ExpectNear(s.shading.dpdu, t.shading.dpdu);
    ExpectNear(s.shading.dpdv, t.shading.dpdv);
    ExpectNear(Mapped({0, 0, 0}).shading.n, {0, 0, 1});
}

TEST(NormalMap, FrameStaysOrthogonalWithItsLengths) {
    SurfacePoint s = TestPoint();
    Vector3 u = s.shading.dpdu, v = s.shading.dpdv, n = s.shading.n;
    Vector3 mapped = Normalize(Vector3(.3f, -.5f, .7f));
    s = Mapped(mapped, s);
    ExpectNear(s.shading.n, Frame::FromXZ(Normalize(u), n).FromLocal(mapped));
    EXPECT_NEAR(Dot(s.shading.n, s.shading.dpdu), 0, 1e-5f);
    EXPECT_NEAR(Dot(s.shading.n, s.shading.dpdv), 0, 1e-5f);
    EXPECT_NEAR(Dot(s.shading.dpdu, s.shading.dpdv), 0, 1e-5f);
    EXPECT_NEAR(Length(s.shading.dpdu), Length(u), 1e-5f);
    EXPECT_NEAR(Length(s.shading.dpdv), Length(v), 1e-5f);
}

TEST(NormalMap, NormalStaysOnTheGeometricSide) {
    SurfacePoint s = FlatPoint();
    s.n = {0, 0, -1};
    ExpectNear(Mapped({.6f, 0, .8f}, s).shading.n, {-.6f, 0, -.8f});
}

TEST(NormalMap, ZeroVIsTheBottomRowAndItRepeats) {
    const auto map = NormalMapOf({{.6f, 0, .8f}, {0, .6f, .8f}});
    for (Float v : {.25f, 1.25f, -.75f}) {
        SurfacePoint s = FlatPoint();
        s.uv = {.5f, v};
        ApplyNormalMap(*map, s);
        ExpectNear(s.shading.n, {0, .6f, .8f});
    }
    SurfacePoint s = FlatPoint();
    s.uv = {.5f, .75f};
    ApplyNormalMap(*map, s);
    ExpectNear(s.shading.n, {.6f, 0, .8f});
}

class NormalMapFile : public FolderTest {};

/// The bytes of a PNG are plain numbers here, not sRGB.
TEST_F(NormalMapFile, IsReadByTheMaterial) {
    Image image(PixelFormat::Float, {2, 2}, {"R", "G", "B"});
    ColorEncoding srgb;
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c) image.Set({i & 1, i >> 1}, c, srgb.ToLinear((Vector3(.6f, 0, .8f)[c] + 1) / 2));
    WriteImage(Path("normals.png"), image);
    Workshop shop;
    MaterialPtr plain = shop.Make("diffuse"),
                mapped = shop.Make("coateddiffuse", Params("m").String("normalmap", Path("normals.png")));
    SurfacePoint s = FlatPoint();
    plain->PerturbShading(s);
    ExpectNear(s.shading.n, {0, 0, 1});
    mapped->PerturbShading(s);
    ExpectNear(s.shading.n, {.6f, 0, .8f}, 0.01f);
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    ExpectNear(mapped->GetBsdf(s, lambda).ShadingFrame().z, s.shading.n);
    EXPECT_EQ(shop.Errors(), 0u);
}

}  // namespace
}  // namespace pbrt::test
