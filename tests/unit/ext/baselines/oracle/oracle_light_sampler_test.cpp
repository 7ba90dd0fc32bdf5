#include "ext/baselines/oracle/oracle_light_sampler.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pbrt/core/counters.h"
#include "pbrt/core/log.h"
#include "pbrt/transport/vertex.h"
#include "second_moment.h"
#include "support/build_text.h"
#include "support/light_query.h"
#include "support/scene_text.h"

namespace {

using namespace ext;
using test::Objects;

const SampledWavelengths &Wavelengths() {
    static const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.3f);
    return lambda;
}

/// A view of `objects` in world coordinates, and samplers for it.
struct World {
    BuiltScene built;

    explicit World(const std::string &objects) {
        SetLogLevel(LogLevel::Warning);
        built = test::BuildText(test::SceneText()
                                    .InWorldSpace()
                                    .LookAt("0 -4 1  0 0 1  0 0 1")
                                    .Camera(60)
                                    .Film(32, 24)
                                    .Samples(4)
                                    .Integrator("path", 3)
                                    .World(Objects().Diffuse(".5 .5 .5").Add(objects)));
        built.seed = 5;
    }
    const LightTable &Lights() const { return built.scene->Lights(); }
    std::unique_ptr<OracleLightSampler> Oracle(const OracleParams &params) const {
        auto sampler = std::make_unique<OracleLightSampler>(Lights(), params);
        test::PrepareIn(built, *sampler);
        return sampler;
    }
    std::unique_ptr<LightSampler> Named(const std::string &name) const {
        std::unique_ptr<LightSampler> sampler = test::MakeLightSampler(name, Lights());
        test::PrepareIn(built, *sampler);
        return sampler;
    }
};

std::string Quad(const std::string &corners, const std::string &before = "") {
    return Objects().Attribute(before, Objects().Quad(corners));
}
/// A square lamp that faces down; `side` is half the length of its sides.
std::string LampAbove(double x, double y, double z, double side, double radiance) {
    return Quad(
        fmt::format("{0} {2} {4}  {0} {3} {4}  {1} {2} {4}  {1} {3} {4}", x - side, x + side, y - side, y + side, z),
        fmt::format("AreaLightSource 'diffuse' 'rgb L' [ {0} {0} {0} ] 'bool twosided' true", radiance));
}
std::string PlateAbove(double x0, double x1, double y0, double y1, double z) {
    return Quad(fmt::format("{0} {2} {4}  {1} {2} {4}  {0} {3} {4}  {1} {3} {4}", x0, x1, y0, y1, z));
}
std::string Point(double x, double y, double z, double intensity) {
    return Objects().PointLight(fmt::format("{} {} {}", x, y, z), fmt::format("{0} {0} {0}", intensity));
}
const std::string kFloor = Quad("-5 -5 0  5 -5 0  -5 5 0  5 5 0");

LightQuery OnFloor(Float x = 0, Float y = 0) {
    LightQuery q = test::QueryAt({x, y, 0}, {0, 0, 1});
    q.depth = 1;
    q.pError = Vector3(1e-6f);
    return q;
}

/// What the floor adds to the probability of a light.
Float FloorOf(const World &world, const OracleParams &params, const LightQuery &q, uint32_t light) {
    const LightGroups &groups = params.meshlights ? world.Lights().ByLight() : world.Lights().ByComponent();
    return params.floor * EmitterTree(GroupImportance::EmittersOf(groups)).PMF(q, light);
}

TEST(Oracle, PointLightsAreChosenByWhatTheySend) {
    World world(kFloor + Point(0, 0, 1, 1) + Point(3, 0, 4, 50) + Point(0, -1, 1, 2));
    // The contributions I cos / d^2: 1/1, 50 (4/5) / 25, 2 (1/sqrt 2) / 2.
    const double c[3] = {1, 1.6, std::sqrt(0.5)}, total = c[0] + c[1] + c[2];
    OracleParams params;
    std::unique_ptr<OracleLightSampler> oracle = world.Oracle(params);
    for (uint32_t l = 0; l < 3; ++l) {
        double expected = (1 - double(params.floor)) * c[l] / total + double(FloorOf(world, params, OnFloor(), l));
        EXPECT_NEAR(double(oracle->PMF(OnFloor(), LightId(l))), expected, 1e-4) << l;
    }
}

TEST(Oracle, ALightBehindAWallKeepsTheFloorOnly) {
    World world(kFloor + Point(0, 0, 1, 1) + Point(3, 0, 4, 5000) + PlateAbove(1, 2, -1, 1, 2));
    OracleParams params;
    std::unique_ptr<OracleLightSampler> oracle = world.Oracle(params);
    Float hidden = oracle->PMF(OnFloor(), LightId(1u));
    EXPECT_FLOAT_EQ(hidden, FloorOf(world, params, OnFloor(), 1));
    EXPECT_GT(hidden, 0);
    EXPECT_NEAR(oracle->PMF(OnFloor(), LightId(0u)) + hidden, 1, 1e-5);
}

TEST(Oracle, HalfHiddenLightIsChosenByTheRootOfTheHalf) {
    // Two equal lamps; seen from the origin, a plate hides the half beyond x = 1 of the second.
    World world(kFloor + LampAbove(-1, 0, 2, 0.02, 10) + LampAbove(1, 0, 2, 0.02, 10) + PlateAbove(0.5, 0.8, -1, 1, 1));
    std::unique_ptr<OracleLightSampler> oracle = world.Oracle({.samples = 2048, .floor = 1e-4f, .mis = false});
    Float whole = oracle->PMF(OnFloor(), LightId(0u)), half = oracle->PMF(OnFloor(), LightId(1u));
    EXPECT_NEAR(half / whole, std::sqrt(0.5f), 0.01f);
}

TEST(Oracle, WhatBsdfSamplingReachesNeedsNoLightSamples) {
    // A lamp that fills most of the sky, and a small one that gives the same irradiance.
    World world(kFloor + LampAbove(0, 0, 1, 5, 1) + LampAbove(0.2, 0, 0.5, 0.02, 500));
    const std::unique_ptr<OracleLightSampler> both = world.Oracle({.samples = 256, .floor = 1e-4f}),
                                              alone = world.Oracle({.samples = 256, .floor = 1e-4f, .mis = false});
    EXPECT_LT(both->PMF(OnFloor(), LightId(0u)), alone->PMF(OnFloor(), LightId(0u)) / 2);
}

TEST(Oracle, OneLightNeedsNoRays) {
    World world(kFloor + LampAbove(0, 0, 1, 0.5, 1));
    std::unique_ptr<OracleLightSampler> oracle = world.Oracle(OracleParams());
    EXPECT_EQ(oracle->PMF(OnFloor(), LightId(0u)), 1);
    EXPECT_EQ(oracle->Sample(OnFloor(), 0.3f)->pmf, 1);
    nlohmann::ordered_json report;
    oracle->Report(report);
    EXPECT_EQ(report["ownShadowRays"], 0);
}

TEST(Oracle, RaysAreItsOwnNotTheRenders) {
    World world(kFloor + Point(0, 0, 1, 1) + LampAbove(1, 0, 2, 0.1, 10));
    std::unique_ptr<OracleLightSampler> oracle = world.Oracle(OracleParams());
    ResetCounters();
    const LightQuery query = OnFloor();
    LightMemory memory;
    const LightDistribution lights = oracle->At(query, memory);
    lights.Sample(0.5f);
    EXPECT_EQ(SumCounters().shadowRays, 0u);
    EXPECT_EQ(SumCounters().shadowRaysBlocked, 0u);
    nlohmann::ordered_json report;
    oracle->Report(report);
    EXPECT_EQ(report["ownShadowRays"], 2 * OracleParams().samples);
    // A second query at the same vertex traces no more shadow rays.
    lights.PMF(LightId(1u));
    oracle->Report(report);
    EXPECT_EQ(report["ownShadowRays"], 2 * OracleParams().samples);
}

TEST(Oracle, WhatScattersDecidesEvenInTheSamePlaceOfMemory) {
    // First a metal, which reflects towards the left or the right lamp depending on the direction of view; then a
    // diffuse surface at the same address.
    World world(kFloor + LampAbove(-1, 0, 1, 0.1, 10) + LampAbove(1, 0, 1, 0.1, 10));
    std::unique_ptr<OracleLightSampler> oracle = world.Oracle({.mis = false});
    LightQuery q = OnFloor();
    q.wo = Normalize(Vector3(1, 0, 1));
    Bsdf bsdf(q.ns, Vector3(1, 0, 0),
              ConductorBxdf(TrowbridgeReitz(0.1f, 0.1f), SampledSpectrum(0.2f), SampledSpectrum(4)));
    q.bsdf = &bsdf;
    q.lambda = &Wavelengths();
    EXPECT_GT(oracle->PMF(q, LightId(0u)), 0.95f);
    bsdf = Bsdf(q.ns, Vector3(1, 0, 0), DiffuseBxdf(SampledSpectrum(0.5f)));
    EXPECT_NEAR(oracle->PMF(q, LightId(0u)), 0.5f, 0.02f);
    q.bsdf = nullptr;
    EXPECT_NEAR(oracle->PMF(q, LightId(0u)), 0.5f, 0.02f);
    q.wo = Normalize(Vector3(-1, 0, 1));
    bsdf = Bsdf(q.ns, Vector3(1, 0, 0),
                ConductorBxdf(TrowbridgeReitz(0.1f, 0.1f), SampledSpectrum(0.2f), SampledSpectrum(4)));
    q.bsdf = &bsdf;
    EXPECT_LT(oracle->PMF(q, LightId(0u)), 0.05f);
}

/// A surface point that the camera sees, with its BSDF.
using Place = PathVertex;
std::vector<Place> CameraHits(const World &world, int count) {
    std::vector<Place> places;
    Rng rng(8);
    SampledWavelengths lambda = Wavelengths();
    while (int(places.size()) < count) {
        CameraSample cs;
        cs.pFilm = rng.Uniform2() * Vector2(world.built.film->FullResolution());
        std::optional<CameraRay> ray = world.built.camera->GenerateRay(cs, lambda);
        std::optional<SurfacePoint> point = world.built.scene->Intersect(ray->ray);
        if (!point) continue;
        Bsdf bsdf = ComputeBsdf(*world.built.scene, *point, lambda);
        places.push_back({*point, bsdf});
    }
    return places;
}

/// The reference for what the oracle measures: many independent points of every light.
std::vector<LightPoint> ManyPoints(const World &world, const Place &place, int perLight, bool mis) {
    std::vector<LightPoint> points;
    Rng rng(21);
    const LightSampleContext from = LightContextAt(place.point);
    for (uint32_t l = 0; l < world.Lights().Size(); ++l)
        for (int i = 0; i < perLight; ++i) {
            LightPoint &y = points.emplace_back();
            const LightComponent light = world.Lights()[LightId(l)];
            std::optional<LightLiSample> s = light.SampleLi(from, rng.Uniform2(), Wavelengths(), true);
            if (!s || !s->L || !(s->pdf > 0) || world.built.scene->Occluded(from, *s)) continue;
            SampledSpectrum f = place.bsdf.F(place.point.wo, s->wi) * AbsDot(s->wi, place.point.shading.n);
            y.value = SafeDivide(s->L * f, Wavelengths().Pdf()).Average() / s->pdf;
            if (mis && !IsDelta(light.Kind())) y.ratio = place.bsdf.Pdf(place.point.wo, s->wi) / s->pdf;
        }
    return points;
}

class OracleAgainst : public testing::TestWithParam<bool> {};

TEST_P(OracleAgainst, NoOtherSamplerHasALowerSecondMoment) {
    const bool mis = GetParam();
    std::string text = kFloor + Quad("-5 3 0  5 3 0  -5 3 4  5 3 4", "Material 'conductor' 'float roughness' 0.2") +
                       PlateAbove(-2, 2, -1, 2, 1) + LampAbove(-1, 0, 2, 0.4, 3) + LampAbove(1.5, 1, 1.5, 0.1, 30) +
                       LampAbove(2.5, 0, 0.7, 0.05, 60) + LampAbove(0, 1, 0.5, 0.1, 10) + Point(-3, 0, 1, 1) +
                       Point(0, 0, 3, 2) +
                       "LightSource 'distant' 'point3 from' [ 1 -1 2 ] 'point3 to' [ 0 0 0 ] 'rgb L' [ .3 .3 .3 ]";
    World world(text);
    std::unique_ptr<OracleLightSampler> oracle = world.Oracle({.samples = 64, .mis = mis});
    std::vector<Place> places = CameraHits(world, 24);
    for (const char *name : {"uniform", "power", "bvh", "exhaustive", "spatial", "neepp", "octree"}) {
        std::unique_ptr<LightSampler> other = world.Named(name);
        double sumOracle = 0, sumOther = 0;
        int seen = 0;
        for (const Place &place : places) {
            std::vector<LightPoint> points = ManyPoints(world, place, 512, mis);
            LightQuery q = LightQueryAt(place, Wavelengths(), 1);
            std::vector<double> ofOracle, ofOther, least(world.Lights().Size());
            for (uint32_t l = 0; l < world.Lights().Size(); ++l) {
                ofOracle.push_back(double(oracle->PMF(q, LightId(l))));
                ofOther.push_back(double(other->PMF(q, LightId(l))));
            }
            if (!MinVariancePmf(points, least)) continue;
            ++seen;
            double best = SecondMoment(points, least);
            double a = SecondMoment(points, ofOracle) / best, b = SecondMoment(points, ofOther) / best;
            // The floor raises the variance by its share; in half shadows the noise of the oracle's 64 points raises it
            // a little, too.
            EXPECT_LT(a, 1.25) << name;
            EXPECT_LT(a, b * 1.1) << name;
            sumOracle += a;
            sumOther += b;
        }
        ASSERT_GT(seen, 12);
        EXPECT_LT(sumOracle, sumOther) << name;
        EXPECT_LT(sumOracle / seen, 1.06);
    }
}
INSTANTIATE_TEST_SUITE_P(Both, OracleAgainst, testing::Bool(),
                         [](const auto &c) { return c.param ? "WithMis" : "LightSamplingAlone"; });

}  // namespace
