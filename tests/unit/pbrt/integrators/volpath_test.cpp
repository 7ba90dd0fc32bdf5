// Media as integrators see them: furnaces, closed forms, integrators and light samplers against each other.
#include "support/build_text.h"
#include "volume_scenes.h"

namespace pbrt::test {
namespace {

/// A ball of radius 1 that is filled with a medium.
std::string Ball(const std::string &medium) { return NamedMedium(medium) + FilledWith() + "Shape 'sphere'\n"; }

/// A grid of 3 x 4 x 2 densities in the box around the ball; `values` for each density.
std::string Grid(const std::string &type, const std::string &name, int values) {
    std::string text = "'string type' '" + type +
                       "' 'integer nx' 3 'integer ny' 4 'integer nz' 2 'point3 p0' [-1 -1 -1] "
                       "'point3 p1' [1 1 1] '" +
                       name + "' [";
    for (int i = 0; i < 24 * values; ++i) text += fmt::format(" {}", 0.2 + 0.37 * (i * 7 % 11));
    return text + " ]";
}

/// Zeros for every voxel, because a grid absorbs unless the scene sets its absorption to 0.
std::string NoAbsorption() {
    std::string text = " 'rgb sigma_a' [";
    for (int i = 0; i < 72; ++i) text += " 0";
    return text + " ]";
}

/// Media that only scatter.
std::vector<std::pair<std::string, std::string>> ScatteringMedia() {
    const std::string only = " 'rgb sigma_a' [0 0 0] 'rgb sigma_s' [2 2 2]";
    return {
        {"even", "'string type' 'homogeneous' 'float g' .7" + only},
        {"dense, back", "'string type' 'homogeneous' 'float g' -.5 'float scale' 8" + only},
        {"coloured", "'string type' 'homogeneous' 'rgb sigma_a' [0 0 0] 'rgb sigma_s' [.5 1 3]"},
        {"grid", Grid("uniformgrid", "float density", 1) + only + " 'float g' .3"},
        {"coloured grid", Grid("rgbgrid", "rgb sigma_s", 3) + NoAbsorption() + " 'float g' .2"},
        {"cloud", "'string type' 'cloud' 'point3 p0' [-1 -1 -1] 'point3 p1' [1 1 1]" + only},
    };
}

/// Expects that media that only scatter are invisible under a uniform environment, in every colour.
void ExpectInvisible(const std::string &integrator, int samples) {
    for (const auto &[name, medium] : ScatteringMedia()) {
        const Image image = RenderText(VolumeScene(kEvenSky + Ball(medium), {integrator, 1000, samples})).image;
        for (int c = 0; c < 3; ++c) ExpectOfSky(ChannelStatistics(image, c), 1, integrator + " " + name, 1e-4, .012);
    }
}

TEST(VolPath, AMediumThatOnlyScattersIsInvisibleUnderUniformLight) {
    ExpectInvisible("volpath", 128);
    ExpectInvisible("simplevolpath", 512);
}

TEST(VolPath, AFurnaceNoticesALittleAbsorption) {
    const double sky = Green(kEvenSky).mean;
    for (const char *integrator : {"volpath", "bdpt"}) {
        const RunningStatistics s =
            Green(kEvenSky + Ball("'string type' 'homogeneous' 'rgb sigma_a' [.02 .02 .02] 'rgb sigma_s' [2 2 2]"),
                  {integrator});
        EXPECT_LT(s.mean / sky, 1 - 4 * s.StandardError() / sky - 1e-3) << integrator;
    }
}

/// All strategies of bdpt together, of paths of any length.
TEST(Bdpt, AMediumThatOnlyScattersIsInvisibleUnderUniformLight) { ExpectInvisible("bdpt", 192); }

/// Pixels of a chain depend on each other, so the error is estimated from images of several seeds. The mean of an image
/// is that of bdpt's pairs, which are tested in the dense medium above, where they take long.
TEST(Mlt, AMediumThatOnlyScattersIsInvisibleUnderUniformLight) {
    const double sky = Green(kEvenSky).mean;
    for (const auto &[name, medium] : ScatteringMedia()) {
        if (name == "dense, back") continue;
        const RunningStatistics s = MeansOverSeeds(VolumeScene(kEvenSky + Ball(medium), {"mlt", 1000, 16}));
        EXPECT_LT(std::abs(s.mean / sky - 1), 5 * s.StandardError() / sky + 1e-4) << name;
        EXPECT_LT(s.StandardError(), .02 * sky) << name << ": too noisy to compare";
    }
}

TEST(VolPath, TheCameraMayStandInAMediumThatHasNoEnd) {
    // Light from a bright wall passes two units of fog that only absorbs.
    ExpectOfSky(Green(Objects().AreaLight("1 1 1").Diffuse("0 0 0").Quad("-2 -2 1  2 -2 1  -2 2 1  2 2 1"),
                      {.beforeCamera = Absorbing(.5, "fog") + "MediumInterface '' 'fog'\n"}),
                std::exp(-1.));
}

TEST(VolPath, LightFromBelowASurfacePassesTheMediumAroundIt) {
    const std::string world =
        Objects()
            .PointLight("0 0 5", "90 90 90")
            .Material("subsurface", "'rgb reflectance' [.8 .8 .8] 'spectrum mfp' [300 .05 900 .05]")
            .Disk(9);
    const auto inFog = [&](const std::string &fog) {
        return Green(world, {.maxDepth = 2, .samples = 512, .beforeCamera = fog});
    };
    const RunningStatistics with = inFog(Absorbing(.2, "fog") + "MediumInterface 'fog'\n");
    // Three units from the camera, and five to the light.
    const double expected = std::exp(-.2 * 8) * inFog("").mean;
    EXPECT_LT(std::abs(with.mean - expected), 4 * with.StandardError() + 0.02 * expected);
    EXPECT_LT(with.StandardError(), 0.02 * expected);
}

/// Glass that light reaches by further scattering only, which the depth excludes, must not change what the fog before
/// it scatters: paths reach it, and end the secondary wavelengths, with a probability that depends on the first one.
TEST(VolPath, DispersionBehindColouredFogDoesNotChangeTheFog) {
    const std::string fog = Homogeneous("'rgb sigma_a' [.02 .1 .5] 'rgb sigma_s' [.1 .5 2]", "fog");
    const auto before = [&](const char *integrator, const std::string &eta) {
        const std::string world = Objects()
                                      .PointLight("0 1.5 1", "20 20 20")
                                      .Material("dielectric", eta)
                                      .Quad("-9 -9 -2  9 -9 -2  -9 9 -2  9 9 -2");
        const Setting setting{.integrator = integrator,
                              .maxDepth = 1,
                              .samples = 32,
                              .beforeCamera = fog + "MediumInterface 'fog' 'fog'\n"};
        return Green(world, setting).mean;
    };
    for (const char *integrator : {"volpath", "bdpt"}) {
        const double plain = before(integrator, "'float eta' 1.7");
        EXPECT_GT(plain, 0) << integrator;
        EXPECT_NEAR(before(integrator, "'spectrum eta' 'glass-F11'"), plain, 1e-4 * plain) << integrator;
    }
}

TEST(VolPath, EmissionIsThatOfAGlowingSlab) {
    // Radiance of a slab of thickness 2 that absorbs and emits: Le (1 - exp(-2 sigma)).
    const std::string slab = Absorbing(.7, "m", "'rgb Le' [1 1 1] 'float Lescale' 1") + std::string(Slab(-1, 1));
    for (const char *integrator : {"volpath", "simplevolpath"})
        ExpectOfSky(Green(slab, {integrator, 100, 256}), 1 - std::exp(-1.4), integrator);
}

TEST(VolPath, ShadowRaysPassMediaAndTheirBoundaries) {
    // A point light above a floor, behind two slabs that absorb and a pane of nothing between them.
    const Objects floor = Objects()
                              .PointLight("0 0 500", "250000 250000 250000")
                              .Material("diffuse")
                              .Quad("-9 -9 0  9 -9 0  -9 9 0  9 9 0");
    const Setting setting{.maxDepth = 1, .samples = 256};
    const double bare = Green(floor, setting).mean;
    const RunningStatistics s = Green(
        Objects(floor).Add(Absorbing(.4, "a") + Absorbing(.3, "b")).Add(Slab(5, 6, 9, "a")).Add(Slab(10, 12, 9, "b")),
        setting);
    // The camera is below the slabs.
    EXPECT_LT(std::abs(s.mean / bare - std::exp(-.4 - .6)), 4 * s.StandardError() / bare + 1e-3);
}

/// A ball of fog under a lamp that can be hit and one that cannot, over a floor.
std::string Foggy(const std::string &medium) {
    return Objects()
        .Attribute("Translate -1.5 1.5 .5", Objects().AreaLight("9 8 6").Sphere(.5))
        .Material("diffuse")
        .Quad("-3 -3 -1.2  3 -3 -1.2  -3 3 -1.2  3 3 -1.2")
        .Add(Ball(medium));
}

void ExpectEqualMeans(const RunningStatistics &a, const RunningStatistics &b, const std::string &what) {
    EXPECT_LT(std::abs(a.mean - b.mean), 5 * std::hypot(a.StandardError(), b.StandardError())) << what;
    EXPECT_LT(a.StandardError(), 0.02 * a.mean) << what << ": too noisy to compare";
}

/// Each medium with every other sampler, in turn, because media and samplers are independent.
TEST(VolPath, LightSamplersAgree) {
    const std::string lamps = Objects().PointLight("1 2 2", "9 9 9").PointLight("-2 0 -.5", "2 4 9");
    std::vector<std::string> samplers = AllSamplers().samplers.Names();
    std::erase_if(samplers, [](const std::string &s) { return s == "bvh" || s == "oracle"; });  // it takes a minute
    // What they do where a path enters a voxel for the first time is cut down.
    const auto cutDown = [](const std::string &sampler) {
        if (sampler == "neepp") return "'integer neepp.voxels' 8";
        return sampler == "spatial" ? "'integer spatial.voxels' 8 'integer spatial.samples' 64" : "";
    };
    const auto media = ScatteringMedia();
    for (size_t m = 0; m < media.size(); ++m) {
        auto means = [&](const std::string &sampler) {
            const Setting setting{"volpath", 4, 24, sampler, "", cutDown(sampler)};
            return MeansOverSeeds(VolumeScene(lamps + Foggy(media[m].second), setting));
        };
        const RunningStatistics bvh = means("bvh");
        for (size_t s = 0; s < samplers.size(); ++s)
            if ((m + s) % 2 == 0) ExpectEqualMeans(bvh, means(samplers[s]), media[m].first + ", " + samplers[s]);
    }
}

TEST(VolPath, MatchesThePlainRandomWalk) {
    const std::string lamp =
        Objects().Attribute("Translate -1.5 1.5 .5", Objects().AreaLight("9 8 6").Diffuse("0 0 0").Sphere(1));
    for (const auto &[name, medium] : ScatteringMedia()) {
        auto means = [&, &medium = medium](const char *integrator, int samples) {
            return MeansOverSeeds(VolumeScene(lamp + Ball(medium), {integrator, 6, samples}));
        };
        // The furnace has the dense one as well; here its noise would take too long.
        if (name != "dense, back") ExpectEqualMeans(means("volpath", 24), means("simplevolpath", 96), name);
    }
}

TEST(VolPath, AnyNumberOfThreadsGivesTheSameBits) {
    ExpectSameForThreads(VolumeScene(Foggy(ScatteringMedia()[3].second), {.samples = 8}));
}

TEST(VolPath, PathIgnoresMediaWithAWarning) {
    const Rendered fog = RenderText(VolumeScene(kEvenSky + Ball(ScatteringMedia()[0].second), {"path"}));
    int warnings = 0;
    for (const Diagnostic &d : fog.diagnostics) warnings += d.message.find("renders no media") != std::string::npos;
    EXPECT_EQ(warnings, 1);
}

/// How far away such lights are would decide how much fog is before them.
TEST(Bdpt, WarnsOfLightsBeyondAFogWithoutEnd) {
    const std::string fog = Homogeneous("", "fog") + "MediumInterface 'fog' 'fog'\n";
    const std::string end = FilledWith("fog") + "Shape 'sphere' 'float radius' 9\n";
    const std::string sun = "LightSource 'distant'\n", lamp = "LightSource 'point' 'point3 from' [ 0 2 0 ]\n";
    const auto warns = [&](const std::string &world, const std::string &integrator) {
        const Setting setting{.integrator = integrator, .samples = 1, .beforeCamera = fog};
        for (const Diagnostic &d : RenderText(VolumeScene(world, setting)).diagnostics)
            if (d.message.find("without a boundary") != std::string::npos) return true;
        return false;
    };
    for (const char *integrator : {"bdpt", "mlt", "lightpath"}) {
        EXPECT_TRUE(warns(sun, integrator)) << integrator;
        EXPECT_FALSE(warns(sun + end, integrator)) << integrator;
        EXPECT_FALSE(warns(lamp, integrator)) << integrator;
    }
    EXPECT_FALSE(warns(sun, "volpath"));
}

TEST(SimpleVolPath, ASurfaceThatScattersIsAnError) {
    EXPECT_THROW(Green(kEvenSky + "Shape 'sphere'", {"simplevolpath"}), UserError);
}

}  // namespace
}  // namespace pbrt::test
