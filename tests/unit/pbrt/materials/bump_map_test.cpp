#include <gtest/gtest.h>

#include <functional>

#include "material_test_support.h"
#include "pbrt/materials/material_params.h"

namespace pbrt::test {
namespace {

class Height final : public FloatTexture {
  public:
    explicit Height(std::function<Float(const TextureContext &)> f) : f_(std::move(f)) {}
    Float Evaluate(const TextureContext &ctx) const override { return f_(ctx); }

  private:
    std::function<Float(const TextureContext &)> f_;
};

struct Bumps {
    explicit Bumps(std::function<Float(const TextureContext &)> f) : height(std::make_shared<Height>(std::move(f))) {}
    void Perturb(SurfacePoint &point) const { ApplyBumpMap(*height, point); }

    FloatTexturePtr height;
};

void ExpectAbout(const Vector3 &a, const Vector3 &b, Float tolerance = 1e-3f) { ExpectNear(a, b, tolerance); }

TEST(BumpMap, EvenHeightOverAPlaneChangesNothing) {
    SurfacePoint s = FlatPoint();
    Bumps([](const TextureContext &) { return 7.f; }).Perturb(s);
    ExpectAbout(s.shading.n, {0, 0, 1});
    ExpectAbout(s.shading.dpdu, {2, 0, 0});
    ExpectAbout(s.shading.dpdv, {0, 3, 0});
}

TEST(BumpMap, SlopeOfTheHeightTiltsTheNormal) {
    // The height is given once by position and once by (u, v); both have the same slopes: z = x / 2 - y.
    for (bool byPosition : {true, false}) {
        SurfacePoint s = FlatPoint();
        Bumps([=](const TextureContext &c) { return byPosition ? c.p.x / 2 - c.p.y : c.uv.x - 3 * c.uv.y; }).Perturb(s);
        ExpectAbout(s.shading.n, Normalize(Vector3(-.5f, 1, 1)));
        ExpectAbout(s.shading.dpdu, {2, 0, 1}, 2e-3f);
        ExpectAbout(s.shading.dpdv, {0, 3, -3}, 2e-3f);
        ExpectAbout(s.n, {0, 0, 1});
        ExpectAbout(s.dpdu, {2, 0, 0});
    }
}

TEST(BumpMap, StepIsHalfTheFootprint) {
    SurfacePoint s = FlatPoint();
    s.dudx = .1f, s.dudy = -.3f, s.dvdx = .02f;
    Float left = 1, top = 1, right = 0, bottom = 0;
    Bumps([&](const TextureContext &c) {
        left = std::min(left, c.uv.x), right = std::max(right, c.uv.x);
        top = std::min(top, c.uv.y), bottom = std::max(bottom, c.uv.y);
        return 0.f;
    }).Perturb(s);
    EXPECT_FLOAT_EQ(left, .3f);
    EXPECT_FLOAT_EQ(right, .5f);
    EXPECT_FLOAT_EQ(top, .6f);
    EXPECT_NEAR(bottom, .61f, 1e-6f);
}

/// A unit sphere displaced by a constant height stays a sphere; with a height that falls with the polar angle it
/// becomes a drop. The expected normal comes from differences of points of the displaced surface.
TEST(BumpMap, CurvedSurfaceHasTheNormalOfTheMovedOne) {
    auto place = [](double theta, double phi, double r) {
        return Vector3(r * std::sin(theta) * std::cos(phi), r * std::sin(theta) * std::sin(phi), r * std::cos(theta));
    };
    const double theta = 1.1, phi = 0.4, e = 1e-3;
    for (double slope : {0.0, 0.5}) {
        auto height = [&](double t) { return 0.3 - slope * t; };
        SurfacePoint s;  // u = phi, v = theta on the unit sphere
        s.p = place(theta, phi, 1);
        s.uv = {Float(phi), Float(theta)};
        s.n = s.shading.n = s.p;
        s.dndu = s.shading.dndu = s.dpdu = s.shading.dpdu = place(M_PI / 2, phi + M_PI / 2, std::sin(theta));
        s.dndv = s.shading.dndv = s.dpdv = s.shading.dpdv = place(theta + M_PI / 2, phi, 1);
        Bumps([&](const TextureContext &c) { return Float(height(double(c.uv.y))); }).Perturb(s);
        auto moved = [&](double t, double f) { return place(t, f, 1 + height(t)); };
        Vector3 du = moved(theta, phi + e) - moved(theta, phi - e), dv = moved(theta + e, phi) - moved(theta - e, phi);
        ExpectAbout(s.shading.n, FaceForward(Normalize(Cross(du, dv)), s.n), 5e-3f);
        ExpectAbout(s.shading.dpdu, du / Float(2 * e), 5e-3f);
        ExpectAbout(s.shading.dpdv, dv / Float(2 * e), 5e-3f);
    }
}

TEST(BumpMap, NormalStaysOnTheGeometricSide) {
    for (const Float scale : {1.f, 1e12f}) {
        SurfacePoint s = FlatPoint();
        s.n = {0, 0, -1};
        s.shading.dpdu *= scale;
        s.shading.dpdv *= scale;
        Bumps([](const TextureContext &c) { return c.p.x; }).Perturb(s);
        ExpectAbout(s.shading.n, Normalize(Vector3(1, 0, -1)));
    }
}

TEST(BumpMap, MaterialsReadDisplacementButTheNormalMapWins) {
    Workshop shop;
    shop.Define("slope", false, "bilerp", Ramp(0, 2));
    for (const std::string &type : Materials().Names()) {
        if (type == "mix" || type == "interface" || type == "hair" || type == "measured") continue;
        SurfacePoint s = FlatPoint();
        shop.Make(type, Params("m").Texture("displacement", "slope"))->PerturbShading(s);
        ExpectAbout(s.shading.n, Normalize(Vector3(-1, 0, 1)));
        s = FlatPoint();
        shop.Make(type, Params("m").Number("displacement", 2))->PerturbShading(s);
        ExpectAbout(s.shading.n, {0, 0, 1});
    }
    EXPECT_EQ(shop.Errors(), 0u);

    class Plain final : public SurfaceMaterial {
        Bsdf GetBsdf(const SurfacePoint &, SampledWavelengths &) const override { return {}; }
    } both;
    both.SetNormalMap(NormalMapOf({{0, .6f, .8f}}));
    both.SetBumpMap(Bumps([](const TextureContext &c) { return c.p.x; }).height);
    SurfacePoint s = FlatPoint();
    both.PerturbShading(s);
    ExpectAbout(s.shading.n, {0, .6f, .8f});
}

}  // namespace
}  // namespace pbrt::test
