#include "pbrt/transport/path_walk.h"

#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "support/build_text.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

/// The camera is at the origin and looks along +z.
BuiltScene World(const std::string &shapes, const std::string &integrator) {
    return BuildText(SceneText().InWorldSpace().Camera(40).Film(8, 8).Integrator(integrator).World(shapes));
}

std::string Disk(double z, const std::string &before) {
    return Objects().Attribute(fmt::format("{}\nTranslate 0 0 {}", before, z), Objects().Disk(9));
}
const std::string kInterface = "Material 'interface'", kDiffuse = "Material 'diffuse'",
                  kGlow = "AreaLightSource 'diffuse' 'rgb L' [ 2 2 2 ]\nReverseOrientation";

struct Walker {
    explicit Walker(const std::string &shapes, const std::string &integrator = "path")
        : built(World(shapes, integrator)) {}
    CameraRay Start() const { return *built.camera->GenerateRay({.pFilm = {4.2f, 3.9f}}, lambda); }
    /// Goes to the next surface that scatters, or to the end of the path; returns the number of surfaces passed.
    int GoToVertex() {
        for (int passed = 0;; ++passed)
            if ((met = walk.Next()) != PathWalk::Met::Surface || walk.FindScattering(lambda)) return passed;
    }
    const BuiltScene built;
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    PathContext context{*built.scene, *built.camera, 1, true};
    PathWalk walk{context, Start()};
    PathWalk::Met met = PathWalk::Met::Nothing;
};

TEST(PathWalk, PassesItsMaximumOfInterfacesAndEndsAtTheNext) {
    for (int more : {0, 1}) {
        std::string shapes = Disk(200, kDiffuse);
        for (int i = 0; i < PathWalk::MaxPassed + more; ++i) shapes += Disk(1 + i, kInterface);
        Walker walker(shapes);
        EXPECT_EQ(walker.GoToVertex(), PathWalk::MaxPassed + more);
        if (more == 0) {
            ASSERT_EQ(walker.met, PathWalk::Met::Surface);
            EXPECT_NEAR(walker.walk.Vertex().point.p.z, 200, 1e-3);
        } else {
            EXPECT_EQ(walker.met, PathWalk::Met::TooManyInterfaces);
        }
    }
}

TEST(PathWalk, InterfacesAreCountedAnewAfterScattering) {
    std::string shapes = Disk(200, kDiffuse);
    for (int i = 0; i < PathWalk::MaxPassed; ++i) shapes += Disk(1 + i, kInterface);
    Walker walker(shapes);
    walker.GoToVertex();
    ASSERT_EQ(walker.met, PathWalk::Met::Surface);
    walker.walk.Leave(-walker.walk.Vertex().point.wo * Float(-1));
    EXPECT_EQ(walker.GoToVertex(), PathWalk::MaxPassed);
    EXPECT_EQ(walker.met, PathWalk::Met::Nothing);
}

TEST(PathWalk, TheFootprintBehindAnInterfaceIsThatWithoutIt) {
    const std::string floor =
        Disk(5, "Texture 't' 'spectrum' 'checkerboard' Material 'diffuse' 'texture reflectance' 't'");
    auto footprint = [&](const std::string &between) {
        Walker walker(floor + between);
        walker.GoToVertex();
        EXPECT_EQ(walker.met, PathWalk::Met::Surface);
        return walker.walk.Vertex().point.dpdx;
    };
    const Vector3 bare = footprint(""), behind = footprint(Disk(2, kInterface));
    EXPECT_GT(Length(bare), 0.01);
    EXPECT_NEAR(Length(behind - bare) / Length(bare), 0, 1e-3);
}

TEST(PathWalk, MeetsTheLightOfASurfaceOrOfTheEnvironmentButNotBoth) {
    const std::string skies = "LightSource 'infinite' 'rgb L' [ 1 1 1 ]\nLightSource 'infinite' 'rgb L' [ 3 3 3 ]\n";
    auto met = [&](const std::string &shapes) {
        Walker walker(skies + shapes);
        walker.walk.Next();
        std::vector<std::pair<uint32_t, Float>> lights;
        walker.walk.ForEachEmission(walker.lambda,
                                    [&](const SampledSpectrum &Le, LightId light, const Point3 &p, const Normal3 &) {
                                        lights.emplace_back(light.value, p.z);
                                        EXPECT_GT(Le.Average(), 0);
                                    });
        return lights;
    };
    using Lights = std::vector<std::pair<uint32_t, Float>>;
    EXPECT_EQ(met(""), (Lights{{0, 0}, {1, 0}}));
    EXPECT_EQ(met(Disk(5, kDiffuse)), Lights{});
    EXPECT_EQ(met(Disk(5, kGlow)), (Lights{{0, 5}}));
    EXPECT_EQ(met(Disk(5, "AreaLightSource 'diffuse'")), Lights{}) << "the disk emits to its other side";
}

TEST(PathWalk, APortalIsPassedFromTheLastVertexOnNotFromAnInterfaceBehindIt) {
    const std::string portal =
        "LightSource 'infinite' 'rgb L' [ 1 1 1 ] 'point3 portal' [ -9 -9 3  -9 9 3  9 9 3  9 -9 3 ]\n";
    for (const double z : {2, 4}) {
        Walker walker(portal + Disk(z, kInterface));
        EXPECT_EQ(walker.GoToVertex(), 1);
        int lights = 0;
        walker.walk.ForEachEmission(walker.lambda, [&](auto &&...) { ++lights; });
        EXPECT_EQ(lights, 1) << z;
    }
}

TEST(PathWalk, ScattersAsASceneIsWalkedByHand) {
    Walker walker(Objects()
                      .Attribute("Material 'dielectric' Translate 0 0 4", Objects().Sphere(1))
                      .Attribute("ReverseOrientation", Objects().Sphere(20)));
    SampledWavelengths lambda = walker.lambda;
    Ray ray = walker.Start().ray;
    Rng one(3), two(3);
    for (int vertex = 0; vertex < 12; ++vertex) {
        walker.GoToVertex();
        std::optional<SurfacePoint> point = walker.built.scene->Intersect(ray);
        ASSERT_EQ(walker.met == PathWalk::Met::Surface, point.has_value());
        if (!point) break;
        EXPECT_EQ(walker.walk.Vertex().point.p, point->p) << vertex;
        auto sample = [](const Bsdf &bsdf, const Vector3 &wo, Rng &rng) {
            const Float uc = rng.Uniform();
            return bsdf.Sample(wo, uc, rng.Uniform2());
        };
        const Bsdf bsdf = ComputeBsdf(*walker.built.scene, *point, lambda);
        const std::optional<BsdfSample> there = sample(walker.walk.Vertex().bsdf, walker.walk.Vertex().point.wo, one),
                                        here = sample(bsdf, point->wo, two);
        ASSERT_EQ(there.has_value(), here.has_value());
        if (!here) break;
        walker.walk.Scatter(*there);
        ray = point->SpawnRay(here->wi);
        EXPECT_EQ(walker.walk.GetRay().o, ray.o);
        EXPECT_EQ(walker.walk.GetRay().d, ray.d);
    }
}

TEST(PathWalk, DifferentialsContinueAtAMirrorAndEndAtADiffuseSurface) {
    const std::string texture = "Texture 't' 'spectrum' 'checkerboard' ";
    auto second = [&](const std::string &material) {
        Walker walker(texture + Disk(5, material) + Disk(-5, "Material 'diffuse' 'texture reflectance' 't'"));
        walker.GoToVertex();
        const SurfacePoint &point = walker.walk.Vertex().point;
        BsdfSample sample;
        sample.wi = Normalize(Vector3(0.1f, 0, -1));
        sample.flags = material == kDiffuse ? BxdfFlags::Diffuse | BxdfFlags::Reflection
                                            : BxdfFlags::Specular | BxdfFlags::Reflection;
        EXPECT_NEAR(point.p.z, 5, 1e-4);
        walker.walk.Scatter(sample);
        walker.GoToVertex();
        EXPECT_EQ(walker.met, PathWalk::Met::Surface);
        SurfacePoint approximate = walker.walk.Vertex().point;
        ComputeFootprint(approximate, RayDifferential(), *walker.built.camera, 1);
        return approximate.dpdx == walker.walk.Vertex().point.dpdx;
    };
    EXPECT_TRUE(second(kDiffuse)) << "a diffuse bounce must use the camera's approximation";
    EXPECT_FALSE(second("Material 'conductor'")) << "a mirror must use the differentials of the ray";
}

TEST(PathWalk, ReachesTheVerticesOfStepsByHandInAMediumAndOnSurfaces) {
    const Walker world(
        Objects()
            .Add("MakeNamedMedium 'fog' 'string type' 'homogeneous' 'rgb sigma_a' [ 0.01 0.01 0.01 ] "
                 "'rgb sigma_s' [ 0.3 0.2 0.1 ]")
            .Attribute("MediumInterface 'fog' ''\nMaterial 'interface'\nTranslate 0 0 5", Objects().Sphere(3))
            .Add(Disk(9, kDiffuse)),
        "volpath");
    int inMedium = 0, onSurface = 0;
    for (uint64_t seed = 0; seed < 64; ++seed) {
        PathWalk walk(world.context, world.Start()), steps(world.context, world.Start());
        Rng one(seed), two(seed);
        SampledWavelengths lambda = world.lambda;
        SpectralWeights weights, expected;
        const auto step = [&]() -> std::optional<Point3> {
            for (;;) {
                const PathWalk::Met met = steps.Next();
                if (steps.MediumAhead()) {
                    const MediumEvent event = steps.ThroughMedium(lambda, two, expected);
                    if (event.kind == MediumEvent::Kind::Absorbed) return {};
                    if (event.kind == MediumEvent::Kind::Scattered) return steps.GetRay()(event.t);
                }
                if (met != PathWalk::Met::Surface) return {};
                if (steps.FindScattering(lambda)) return steps.Vertex().point.p;
            }
        };
        for (int vertex = 0; vertex < 8; ++vertex) {
            const std::optional<ReachedVertex> reached = walk.NextVertex(lambda, weights, one);
            const std::optional<Point3> p = step();
            ASSERT_EQ(reached.has_value(), p.has_value());
            if (!p) break;
            EXPECT_EQ(weights.beta[1], expected.beta[1]);
            EXPECT_LT(Distance(reached->phase ? reached->p : walk.Vertex().point.p, *p), 1e-4);
            if (reached->phase) {
                ++inMedium;
                const Vector3 wi = reached->phase->SampleP(-walk.GetRay().d, one.Uniform2()).wi;
                EXPECT_EQ(wi, steps.MediumAhead()->Phase().SampleP(-steps.GetRay().d, two.Uniform2()).wi);
                walk.ScatterInMedium(*p, wi);
                steps.ScatterInMedium(*p, wi);
                continue;
            }
            ++onSurface;
            const auto &[point, bsdf] = steps.Vertex();
            const Float uc = two.Uniform();
            const std::optional<BsdfSample> sample = bsdf.Sample(point.wo, uc, two.Uniform2());
            const std::optional<BsdfSample> left = walk.SampleScattering(one);
            ASSERT_EQ(left.has_value(), sample.has_value());
            if (!left) break;
            EXPECT_LT(Length(left->wi - sample->wi), 1e-4);
            steps.Scatter(*left);
        }
    }
    EXPECT_GT(inMedium, 20);
    EXPECT_GT(onSurface, 0);
}

}  // namespace
}  // namespace pbrt::test
