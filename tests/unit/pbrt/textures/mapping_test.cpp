#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "pbrt/textures/texture_mapping.h"
#include "texture_test_support.h"

namespace pbrt::test {
namespace {

TextureContext ContextAt(const Point3 &p, const Point2 &uv = {}) {
    TextureContext ctx;
    ctx.p = p;
    ctx.uv = uv;
    ctx.n = {0, 0, 1};
    return ctx;
}

TextureMapping2D Read(const Params &params, const Transform &t, DiagnosticSink &sink) {
    return ReadParams<MappingParams>(params, sink).Make(params, t, sink);
}

TexCoord2 MapWith(const Params &params, const TextureContext &ctx, const Transform &t = {}) {
    DiagnosticSink sink;
    TexCoord2 c = Map(Read(params, t, sink), ctx);
    EXPECT_TRUE(sink.All().empty());
    return c;
}

void ExpectPlace(const TexCoord2 &c, Float s, Float t) {
    EXPECT_FLOAT_EQ(c.st.x, s);
    EXPECT_FLOAT_EQ(c.st.y, t);
}

void ExpectFootprint(const TexCoord2 &c, Float dsdx, Float dsdy, Float dtdx, Float dtdy) {
    EXPECT_FLOAT_EQ(c.dsdx, dsdx);
    EXPECT_FLOAT_EQ(c.dsdy, dsdy);
    EXPECT_FLOAT_EQ(c.dtdx, dtdx);
    EXPECT_FLOAT_EQ(c.dtdy, dtdy);
}

TEST(TextureMapping, UvScalesThenShifts) {
    TextureContext ctx = ContextAt({}, {0.25f, 0.5f});
    ctx.dudx = 0.1f, ctx.dudy = 0.2f, ctx.dvdx = 0.3f, ctx.dvdy = 0.4f;
    TexCoord2 c =
        MapWith(Params().Number("uscale", 3).Number("vscale", 2).Number("udelta", 0.25f).Number("vdelta", -0.4f), ctx);
    ExpectPlace(c, 1, 0.6f);
    ExpectFootprint(c, 0.3f, 0.6f, 0.6f, 0.8f);
}

TEST(TextureMapping, SphericalGivesPolarAngleThenAzimuth) {
    Params spherical = Params().String("mapping", "spherical");
    ExpectPlace(MapWith(spherical, ContextAt({0, 2, 0})), 0.5f, 0.25f);
    ExpectPlace(MapWith(spherical, ContextAt({1, -1, std::sqrt(2.f)})), 0.25f, 0.875f);
    EXPECT_FLOAT_EQ(MapWith(spherical, ContextAt({0, 0, -1})).st.x, 1);
}

TEST(TextureMapping, CylindricalGivesAzimuthAndHeight) {
    Params cylindrical = Params().String("mapping", "cylindrical");
    ExpectPlace(MapWith(cylindrical, ContextAt({3, 0, -7})), 0.5f, -7);
    EXPECT_FLOAT_EQ(MapWith(cylindrical, ContextAt({0, -2, 1})).st.x, 0.25f);
}

TEST(TextureMapping, PlanarProjectsOnBothVectors) {
    TextureContext ctx = ContextAt({1, 2, 3});
    ctx.dpdx = {1, 0, 0};
    ctx.dpdy = {0, 0, 1};
    Params planar = Params().String("mapping", "planar").Vector("v1", .7f, .2f, 0).Vector("v2", 0, .6f, .4f);
    TexCoord2 c = MapWith(planar.Number("udelta", .1f).Number("vdelta", .35f), ctx);
    ExpectPlace(c, 1.2f, 2.75f);
    ExpectFootprint(c, .7f, 0, 0, .4f);
}

TEST(TextureMapping, PositionsAreTakenToTextureSpace) {
    Transform t = Transform::Translate({1, 2, 3}) * Transform::Scale({2, 4, 8});
    TextureContext ctx = ContextAt({3, 10, 3});
    ctx.dpdx = {1, 1, 0};
    TexCoord2 c = MapWith(Params().String("mapping", "planar"), ctx, t);
    ExpectPlace(c, 1, 2);
    ExpectFootprint(c, 0.5f, 0, 0.25f, 0);
}

/// The reference: differences of the coordinates themselves. The spherical mapping swaps its two derivatives.
TEST(TextureMapping, FootprintsAreDerivativesOfTheCoordinates) {
    Rng rng(7);
    for (const char *name : {"spherical", "cylindrical"}) {
        Params params = Params().String("mapping", name);
        bool crossed = std::string(name) == "spherical";
        for (int i = 0; i < 100; ++i) {
            Point3 p = Point3(rng.Uniform(), rng.Uniform(), rng.Uniform()) * 2.f + Point3(0.3f);
            Vector3 d = Vector3(rng.Uniform(), rng.Uniform(), rng.Uniform()) - Vector3(0.5f);
            TextureContext ctx = ContextAt(p);
            ctx.dpdx = d;
            TexCoord2 c = MapWith(params, ctx);
            Float h = 0.01f;
            Point2 change =
                (MapWith(params, ContextAt(p + d * h)).st - MapWith(params, ContextAt(p - d * h)).st) / (2 * h);
            EXPECT_NEAR(crossed ? c.dtdx : c.dsdx, change.x, 2e-3f);
            EXPECT_NEAR(crossed ? c.dsdx : c.dtdx, change.y, 2e-3f);
        }
    }
}

TEST(TextureMapping, AxisGivesFiniteFootprints) {
    for (const char *name : {"spherical", "cylindrical"}) {
        TextureContext ctx = ContextAt({0, 0, 1});
        ctx.dpdx = {1, 0, 0};
        TexCoord2 c = MapWith(Params().String("mapping", name), ctx);
        EXPECT_TRUE(std::isfinite(c.dsdx) && std::isfinite(c.dtdx) && std::isfinite(c.st.x));
    }
}

TEST(TextureMapping, UnknownNameWarnsAndMeansUv) {
    DiagnosticSink sink;
    TextureMapping2D m = Read(Params().String("mapping", "sphericl"), {}, sink);
    ASSERT_EQ(sink.All().size(), 1u);
    EXPECT_EQ(sink.All()[0].severity, Severity::Warning);
    EXPECT_EQ(sink.All()[0].loc.line, 1);
    ExpectWords(sink.All()[0].message, {"spherical"});
    EXPECT_TRUE(std::holds_alternative<UvMapping>(m));
}

TEST(TextureMapping, UvScaleIsUnusedElsewhere) {
    DiagnosticSink sink;
    Params params = Params().String("mapping", "planar").Number("uscale", 2);
    Read(params, {}, sink);
    ASSERT_EQ(sink.ErrorCount(), 1u);
    EXPECT_EQ(sink.All()[0].loc.line, 2);
}

}  // namespace
}  // namespace pbrt::test
