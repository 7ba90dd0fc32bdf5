#include "light_test_support.h"
#include "pbrt/lights/diffuse_area_light.h"
#include "unit/pbrt/shapes/shape_cases.h"

namespace pbrt::test {
namespace {

class AreaLightShapes : public testing::TestWithParam<ShapeCase> {};

/// The light arriving from the primitive, measured by rays in all directions that can meet it: slow, but simple.
template <class F>
RunningStatistics ByUniformDirections(const Shape &shape, const Light &light, const Point3 &p, int n, F integrand) {
    Point3 center;
    Float radius;
    shape.PrimitiveBounds(0).BoundingSphere(&center, &radius);
    Float sine = radius * Float(1.001) / Distance(p, center), cosine = sine < 1 ? std::sqrt(1 - sine * sine) : -1;
    Frame frame = Frame::FromZ(Normalize(center - p));
    Rng rng(7);
    RunningStatistics stats;
    for (int i = 0; i < n; ++i) {
        Vector3 w = frame.FromLocal(SampleUniformCone(rng.Uniform2(), cosine));
        double value = 0;
        if (auto hit = shape.Intersect(0, {p, w}, 1e-4f)) {
            SurfacePoint s = shape.Surface(0, *hit);
            value = integrand(light.L(s.p, s.n, s.uv, -w, kLambda), w) / double(UniformConePdf(cosine));
        }
        stats.Add(value);
    }
    return stats;
}

TEST_P(AreaLightShapes, IrradianceBySamplingIsThatByRays) {
    const std::shared_ptr<Shape> &shape = GetParam().shape;
    for (bool twoSided : {false, true}) {
        auto light = MakeAreaLight(Params().Bool("twosided", twoSided), *shape);
        for (Point3 p :
             {Point3(0.5f, 0.3f, 2.5f), Point3(-2, 1, -1.5f), Point3(4, -3, 6), Point3(0.25f, -0.05f, 0.32f)}) {
            auto irradiance = [](const SampledSpectrum &L, const Vector3 &w) {
                return double(L.Average() * std::abs(w.z));
            };
            RunningStatistics slow = ByUniformDirections(*shape, *light, p, 60000, irradiance), fast;
            Rng rng(3);
            for (int i = 0; i < 20000; ++i) {
                auto s = light->SampleLi(At(p), rng.Uniform2(), kLambda, false);
                // The shape may hide a part of itself.
                if (s && shape->Intersect(0, {p, s->wi, Distance(p, s->pLight) * 0.999f}, 1e-4f)) s.reset();
                fast.Add(s ? irradiance(s->L, s->wi) / double(s->pdf) : 0);
            }
            double error = std::hypot(slow.StandardError(), fast.StandardError()) + 1e-4 * slow.mean + 1e-12;
            EXPECT_LT(std::abs(slow.mean - fast.mean) / error, 4.5) << "two-sided " << twoSided << " z " << p.z;
        }
    }
}

TEST_P(AreaLightShapes, PdfOfASampleIsThePdfOfItsRay) {
    const std::shared_ptr<Shape> &shape = GetParam().shape;
    auto light = MakeAreaLight(Params().Bool("twosided", true), *shape);
    Rng rng(5);
    int compared = 0;
    for (int i = 0; i < 2000; ++i) {
        LightSampleContext from = At(SampleUniformSphere(rng.Uniform2()) * (2 + 3 * rng.Uniform()));
        auto s = light->SampleLi(from, rng.Uniform2(), kLambda, false);
        if (!s) continue;
        auto hit = shape->Intersect(0, {from.p, s->wi}, 1e-4f);
        if (!hit) continue;  // missed by rounding at the border
        SurfacePoint point = shape->Surface(0, *hit);
        if (Distance(point.p, s->pLight) > 1e-2f) continue;  // another part of the shape is in front
        Float cosine = AbsDot(point.n, s->wi);
        if (cosine < 0.05f) continue;  // grazing: the density of the rounded direction differs
        ++compared;
        EXPECT_NEAR(light->PdfLi(from, s->wi, point.p, point.n, false) / s->pdf, 1, 0.02);
    }
    EXPECT_GT(compared, 500);
}

TEST_P(AreaLightShapes, PhiIsTheIntegralOfEmittedRadiance) {
    const std::shared_ptr<Shape> &shape = GetParam().shape;
    for (bool twoSided : {false, true}) {
        auto light = MakeAreaLight(Params().Bool("twosided", twoSided).Number("scale", 3), *shape);
        Rng rng(9);
        RunningStatistics stats;
        for (int i = 0; i < 20000; ++i) {
            auto point = shape->SampleArea(0, rng.Uniform2());
            ASSERT_TRUE(point);
            Frame frame = Frame::FromZ(point->n);
            Vector3 w = SampleCosineHemisphere(rng.Uniform2());
            Float pdf = CosineHemispherePdf(w.z) / 2;
            if (rng.Uniform() < 0.5f) w.z = -w.z;
            SampledSpectrum L = light->L(point->p, point->n, point->uv, frame.FromLocal(w), kLambda);
            stats.Add(double(L.Average() * std::abs(w.z) / (pdf * point->pdf)));
        }
        double phi = light->Phi(kLambda).Average();
        // The area of curved patches is an approximation, as in stock pbrt-v4.
        double areaError = GetParam().name.ends_with("Saddle") ? 1e-2 : 1e-3;
        EXPECT_LT(std::abs(stats.mean - phi), 4.5 * stats.StandardError() + areaError * phi) << twoSided;
    }
}

TEST_P(AreaLightShapes, ImportanceIsPositiveWhereLightArrives) {
    const std::shared_ptr<Shape> &shape = GetParam().shape;
    int lit = 0;
    for (bool twoSided : {false, true}) {
        auto light = MakeAreaLight(Params().Bool("twosided", twoSided), *shape);
        LightBounds bounds = *light->Bounds();
        Rng rng(11);
        for (int i = 0; i < 20000; ++i) {
            Point3 p = SampleUniformSphere(rng.Uniform2()) * (i % 2 ? 10 * rng.Uniform() : rng.Uniform());
            lit += ExpectImportantIfLit(*light, bounds, p, rng);
        }
    }
    EXPECT_GT(lit, 5000);
}

/// Triangles, quadrics, patches, parts of shapes, and shapes that a transform mirrors or stretches.
std::vector<ShapeCase> AllShapes() {
    std::vector<ShapeCase> cases{{"turnedTriangle", Triangle(Transform::Rotate(70, {1, 1, 0}))},
                                 {"triangle", Triangle()}};
    for (const char *type : {"sphere", "disk", "cylinder"}) cases.push_back({type, MakeShape(type, Params(), {})});
    for (const ShapeCase &c : WholeAndPartCases())
        if (c.name != "Triangle" && c.name != "Sphere") cases.push_back(c);
    return cases;
}

INSTANTIATE_TEST_SUITE_P(All, AreaLightShapes, testing::ValuesIn(AllShapes()),
                         [](const auto &c) { return c.param.name; });

TEST(DiffuseAreaLight, ScaleOneIsOneNit) {
    auto shape = Triangle();
    auto light = MakeAreaLight(Params(), *shape);
    const Vector3 z(0, 0, 1);
    EXPECT_NEAR(Photometric([&](const SampledWavelengths &l) { return light->L({}, z, {}, z, l); }), 1, 2e-3);
}

TEST(DiffuseAreaLight, EmitsFromTheSideOfTheNormal) {
    auto shape = Triangle();
    auto one = MakeAreaLight(Params(), *shape);
    auto two = MakeAreaLight(Params().Bool("twosided", true), *shape);
    Normal3 n(0, 0, 1);
    EXPECT_TRUE(one->L({}, n, {}, {0, 0, 1}, kLambda));
    EXPECT_FALSE(one->L({}, n, {}, {0, 0, -1}, kLambda));
    EXPECT_TRUE(two->L({}, n, {}, {0, 0, -1}, kLambda));
}

TEST(DiffuseAreaLight, PowerIsPerPrimitive) {
    MeshData data;
    data.p = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 0}};
    data.indices = {0, 1, 2, 1, 3, 2};
    TriangleMesh mesh(data, Transform(), false);
    for (bool twoSided : {false, true}) {
        auto light = MakeAreaLight(Params().Number("power", 20).Bool("twosided", twoSided), mesh);
        ASSERT_EQ(light->ComponentCount(), 2u);
        for (uint32_t i = 0; i < 2; ++i)
            EXPECT_NEAR(Photometric([&](const SampledWavelengths &l) { return Value(light->Phi(l, i)); }), 20, 0.05);
    }
}

TEST(DiffuseAreaLight, ImageIsMappedWithVUpwardsAndItsPowerIsKept) {
    Image image = RgbImage({2, 2}, [](int x, int y) {
        return y == 0 ? Rgb(2, 0, 0) : x == 0 ? Rgb(0, 2, 0) : Rgb(0, 0, 2);
    });
    TemporaryImage file("panel.exr", image);
    auto shape = Triangle();
    auto light = MakeAreaLight(FileParams(file), *shape);
    auto xyzAt = [&](Point2 uv) {
        Vector3 sum(0);
        for (int i = 0; i < 500; ++i) {
            auto lambda = SampledWavelengths::SampleUniform((Float(i) + 0.5f) / 500);
            SampledSpectrum L = SafeDivide(light->L({}, {0, 0, 1}, uv, {0, 0, 1}, lambda), lambda.Pdf());
            sum += Vector3((L * CieX().Sample(lambda)).Average(), (L * CieY().Sample(lambda)).Average(),
                           (L * CieZ().Sample(lambda)).Average());
        }
        return ColorSpace::SRGB().ToRgb(sum / 500.f);
    };
    Rgb top = xyzAt({0.25f, 0.75f}), left = xyzAt({0.25f, 0.25f}), right = xyzAt({0.75f, 0.25f});
    EXPECT_NEAR(top.x, 2, 0.1);
    EXPECT_NEAR(top.y, 0, 0.1);
    EXPECT_NEAR(left.y, 2, 0.1);
    EXPECT_NEAR(right.z, 2, 0.1);

    auto powered = MakeAreaLight(FileParams(file).Number("power", 5), *shape);
    EXPECT_NEAR(Photometric([&](const SampledWavelengths &l) { return Value(powered->Phi(l)); }, 300), 5, 0.1);
    // The mean that is kept for light selection is the mean of the emission.
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    SampledSpectrum mean;
    for (int i = 0; i < 2500; ++i) {
        mean += powered->L({}, {0, 0, 1}, PixelCenter(i % 50, i / 50, {50, 50}), {0, 0, 1}, lambda) / 2500;
    }
    double expected = double(mean.Average() * Pi * shape->Area(0));
    // The spectrum of an interpolated colour is not the interpolation of the spectra; they differ by a few per cent.
    EXPECT_NEAR(powered->Phi(lambda).Average(), expected, 0.08 * expected);
}

TEST(DiffuseAreaLight, ConstantAlphaOfZeroLeavesLightSamplingOnly) {
    auto shape = Triangle();
    const CutTexture zero(0, 0), half(0, 0.5f);
    auto invisible = MakeAreaLight(Params(), *shape, &zero);
    EXPECT_EQ(invisible->Kind(), LightKind::DeltaPosition);
    auto s = invisible->SampleLi(At({0, 0, 2}), {0.4f, 0.3f}, kLambda, false);
    ASSERT_TRUE(s);
    EXPECT_GT(s->pdf, 0);
    EXPECT_NE(s->pdf, 1);
    EXPECT_EQ(invisible->PdfLi(At({0, 0, 2}), s->wi, s->pLight, s->nLight, false), 0);
    EXPECT_EQ(MakeAreaLight(Params(), *shape, &half)->Kind(), LightKind::Area);
    EXPECT_EQ(MakeAreaLight(Params(), *shape)->Kind(), LightKind::Area);
}

TEST(DiffuseAreaLight, AlphaWeighsSamplesAndLeavesTheRadianceOfHits) {
    auto shape = Triangle();
    const CutTexture third(0, 0.3f), cut(0.5f, 1);
    auto grey = MakeAreaLight(Params(), *shape, &third), holed = MakeAreaLight(Params(), *shape, &cut),
         plain = MakeAreaLight(Params(), *shape);
    Rng rng(2);
    for (int i = 0; i < 2000; ++i) {
        Point2 u = rng.Uniform2();
        auto whole = plain->SampleLi(At({0, 0, 2}), u, kLambda, false);
        auto part = grey->SampleLi(At({0, 0, 2}), u, kLambda, false);
        ASSERT_TRUE(whole && part);
        EXPECT_EQ(part->pdf, whole->pdf);
        EXPECT_NEAR(part->L[0], 0.3f * whole->L[0], 1e-6f * whole->L[0]);
        // A ray that was stopped has passed the alpha test, so it gets the whole radiance.
        EXPECT_EQ(grey->L(whole->pLight, whole->nLight, {0, 0}, -whole->wi, kLambda)[0], whole->L[0]);
        auto through = holed->SampleLi(At({0, 0, 2}), u, kLambda, false);
        auto uv = shape->Sample(0, At({0, 0, 2}), u)->uv;
        ASSERT_EQ(through.has_value(), !(uv.x < 0.5f));
        if (through) {
            EXPECT_EQ(through->L[0], whole->L[0]);
        }
    }
}

}  // namespace
}  // namespace pbrt::test
