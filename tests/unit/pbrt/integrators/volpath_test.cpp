// Media as integrators see them: furnaces, closed forms, integrators and light samplers against each other.
#include <gtest/gtest.h>

#include <cmath>

#include "pbrt/core/parallel.h"
#include "support/build_text.h"
#include "support/render_scene.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

struct Setting {
    std::string integrator = "volpath";
    int maxDepth = 100, samples = 64;
    std::string lightSampler = "bvh";
    std::string beforeCamera;  ///< such as the medium that the camera stands in
};

/// A view of `world`, 16 x 16 pixels from (0, 0, 3) towards the origin.
std::string VolumeScene(const std::string &world, const Setting &s = {}) {
    std::string parameters;
    if (s.integrator == "volpath") parameters = "'string lightsampler' '" + s.lightSampler + "'";
    if (s.integrator == "mlt")
        parameters = fmt::format("'integer mutationsperpixel' {} 'integer bootstrapsamples' 4000", s.samples);
    return SceneText()
        .Head(s.beforeCamera)
        .LookAt("0 0 3  0 0 0  0 1 0")
        .Camera("orthographic", "'float screenwindow' [-.5 .5 -.5 .5]")
        .Film(16, 16, "'bool savefp16' false")
        .Filter("box")
        .Samples(s.samples)
        .Integrator(s.integrator, s.maxDepth, parameters)
        .World(world);
}

const std::string kSky = Objects().Sky("1 1 1");
const std::string kAbsorbs = "'rgb sigma_s' [0 0 0] ";

std::string NamedMedium(const std::string &name, const std::string &parameters) {
    return "MakeNamedMedium '" + name + "' " + parameters + "\n";
}
std::string Homogeneous(const std::string &name, const std::string &parameters) {
    return NamedMedium(name, "'string type' 'homogeneous' " + parameters);
}

/// A ball of radius 1 that is filled with a medium.
std::string Ball(const std::string &medium) {
    return NamedMedium("m", medium) + "MediumInterface 'm' ''\nMaterial 'interface'\nShape 'sphere'\n";
}

/// A black wall of radiance 1 before the camera.
std::string GlowingWall() {
    return Objects().AreaLight("1 1 1").Diffuse("0 0 0").Quad("-2 -2 1  2 -2 1  -2 2 1  2 2 1");
}

/// The statistics of one channel of a view of `world`.
RunningStatistics Channel(const std::string &world, const Setting &setting = {}, int channel = 1) {
    return ChannelStatistics(RenderText(VolumeScene(world, setting)).image, channel);
}

/// A grid of 3 x 4 x 2 densities in the box around the ball; `values` for each density.
std::string Grid(const std::string &type, const std::string &name, int values) {
    std::string text = "'string type' '" + type +
                       "' 'integer nx' 3 'integer ny' 4 'integer nz' 2 'point3 p0' [-1 -1 -1] "
                       "'point3 p1' [1 1 1] '" +
                       name + "' [";
    for (int i = 0; i < 24 * values; ++i) text += fmt::format(" {}", 0.2 + 0.37 * (i * 7 % 11));
    return text + " ]";
}

/// Zeros for every voxel, because a grid absorbs where the scene does not say that it does not.
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

/// Expects that media that only scatter are invisible under an even sky, in every colour.
void ExpectInvisible(const std::string &integrator, int samples) {
    const double sky = Channel(kSky).mean;
    for (const auto &[name, medium] : ScatteringMedia()) {
        Setting setting;
        setting.integrator = integrator;
        setting.maxDepth = 1000;
        setting.samples = samples;
        const Image image = RenderText(VolumeScene(kSky + Ball(medium), setting)).image;
        for (int c = 0; c < 3; ++c) {
            const RunningStatistics s = ChannelStatistics(image, c);
            EXPECT_LT(std::abs(s.mean / sky - 1), 4 * s.StandardError() / sky + 1e-4) << integrator << " " << name;
            EXPECT_LT(s.StandardError(), .012 * sky) << name << ": too noisy to tell";
        }
    }
}

TEST(VolPath, AMediumThatOnlyScattersIsInvisibleUnderAnEvenSky) {
    ExpectInvisible("volpath", 128);
    ExpectInvisible("simplevolpath", 512);
}

TEST(VolPath, AFurnaceNoticesALittleAbsorption) {
    const double sky = Channel(kSky).mean;
    for (const char *integrator : {"volpath", "bdpt"}) {
        Setting setting;
        setting.integrator = integrator;
        const RunningStatistics s = Channel(
            kSky + Ball("'string type' 'homogeneous' 'rgb sigma_a' [.02 .02 .02] 'rgb sigma_s' [2 2 2]"), setting);
        EXPECT_LT(s.mean / sky, 1 - 4 * s.StandardError() / sky - 1e-3) << integrator;
    }
}

/// All strategies of bdpt together, of paths of any length.
TEST(Bdpt, AMediumThatOnlyScattersIsInvisibleUnderAnEvenSky) { ExpectInvisible("bdpt", 192); }

/// Pixels of a chain depend on each other, so pictures of several seeds tell the error.
TEST(Mlt, AMediumThatOnlyScattersIsInvisibleUnderAnEvenSky) {
    const double sky = Channel(kSky).mean;
    for (const auto &[name, medium] : ScatteringMedia()) {
        Setting setting;
        setting.integrator = "mlt";
        setting.maxDepth = 1000;
        setting.samples = 16;
        const RunningStatistics s = MeansOverSeeds(VolumeScene(kSky + Ball(medium), setting));
        EXPECT_LT(std::abs(s.mean / sky - 1), 5 * s.StandardError() / sky + 1e-4) << name;
        EXPECT_LT(s.StandardError(), .02 * sky) << name << ": too noisy to tell";
    }
}

TEST(VolPath, TheCameraMayStandInAMediumThatHasNoEnd) {
    // Light from a bright ball passes two units of fog that only absorbs.
    Setting setting;
    setting.beforeCamera = Homogeneous("fog", "'rgb sigma_a' [.5 .5 .5] " + kAbsorbs) + "MediumInterface '' 'fog'\n";
    const double there = Channel(GlowingWall()).mean;
    const RunningStatistics s = Channel(GlowingWall(), setting);
    EXPECT_LT(std::abs(s.mean / there - std::exp(-1.)), 4 * s.StandardError() / there + 1e-4);
}

TEST(VolPath, LightThatWasBelowASurfaceGoesOnThroughTheFogAroundIt) {
    Setting bare;
    bare.maxDepth = 2;
    bare.samples = 512;
    Setting foggy = bare;
    foggy.beforeCamera = Homogeneous("fog", "'rgb sigma_a' [.2 .2 .2] " + kAbsorbs) + "MediumInterface 'fog'\n";
    const std::string world =
        Objects()
            .PointLight("0 0 5", "90 90 90")
            .Material("subsurface", "'rgb reflectance' [.8 .8 .8] 'spectrum mfp' [300 .05 900 .05]")
            .Disk(9);
    const RunningStatistics without = Channel(world, bare), with = Channel(world, foggy);
    // Three units from the camera, and five to the light.
    const double expected = std::exp(-.2 * 8) * without.mean;
    EXPECT_LT(std::abs(with.mean - expected), 4 * with.StandardError() + 0.02 * expected);
    EXPECT_LT(with.StandardError(), 0.02 * expected);
}

TEST(VolPath, EmissionIsThatOfAGlowingSlab) {
    // Radiance of a slab of thickness 2 that absorbs and emits: Le (1 - exp(-2 sigma)).
    const std::string slab =
        Homogeneous("m", "'rgb sigma_a' [.7 .7 .7] 'rgb Le' [1 1 1] 'float Lescale' 1 " + kAbsorbs) +
        std::string(Objects()
                        .Add("MediumInterface 'm' ''")
                        .Material("interface")
                        .Quad("-4 -4 1  4 -4 1  -4 4 1  4 4 1")
                        .Add("ReverseOrientation")
                        .Quad("-4 -4 -1  4 -4 -1  -4 4 -1  4 4 -1"));
    const double one = Channel(GlowingWall()).mean;
    for (const char *integrator : {"volpath", "simplevolpath"}) {
        Setting setting;
        setting.integrator = integrator;
        setting.samples = 256;
        const RunningStatistics s = Channel(slab, setting);
        EXPECT_LT(std::abs(s.mean / one - (1 - std::exp(-1.4))), 4 * s.StandardError() / one + 1e-4) << integrator;
        EXPECT_LT(s.StandardError(), .01 * one);
    }
}

TEST(VolPath, ShadowRaysPassMediaAndTheirBoundaries) {
    // A point light above a floor, behind two slabs that absorb and a pane of nothing between them.
    const auto level = [](double z) { return fmt::format("-9 -9 {0}  9 -9 {0}  -9 9 {0}  9 9 {0}", z); };
    const auto slab = [&](double low, double high, const std::string &name) {
        return Objects()
            .Add("MediumInterface '" + name + "' ''")
            .Quad(level(high))
            .Add("ReverseOrientation")
            .Quad(level(low))
            .Add("ReverseOrientation");
    };
    const Objects floor = Objects().PointLight("0 0 500", "250000 250000 250000").Material("diffuse").Quad(level(0));
    const std::string media = Homogeneous("a", "'rgb sigma_a' [.4 .4 .4] " + kAbsorbs) +
                              Homogeneous("b", "'rgb sigma_a' [.3 .3 .3] " + kAbsorbs) + "Material 'interface'\n";
    Setting setting;
    setting.maxDepth = 1;
    setting.samples = 256;
    const double bare = Channel(floor, setting).mean;
    const RunningStatistics s = Channel(Objects(floor).Add(media).Add(slab(5, 6, "a")).Add(slab(10, 12, "b")), setting);
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
    EXPECT_LT(a.StandardError(), 0.02 * a.mean) << what << ": too noisy to tell";
}

/// Each medium with every other sampler, in turn: media and samplers do not know one another.
TEST(VolPath, LightSamplersAgree) {
    const std::string lamps = Objects().PointLight("1 2 2", "9 9 9").PointLight("-2 0 -.5", "2 4 9");
    std::vector<std::string> samplers = AllSamplers().samplers.Names();
    std::erase_if(samplers, [](const std::string &s) { return s == "bvh" || s == "oracle"; });  // it takes a minute
    const auto media = ScatteringMedia();
    for (size_t m = 0; m < media.size(); ++m) {
        auto means = [&](const std::string &sampler) {
            Setting setting;
            setting.lightSampler = sampler;
            setting.maxDepth = 4;
            setting.samples = 24;
            return MeansOverSeeds(VolumeScene(lamps + Foggy(media[m].second), setting));
        };
        const RunningStatistics bvh = means("bvh");
        for (size_t s = 0; s < samplers.size(); ++s)
            if ((m + s) % 2 == 0) ExpectEqualMeans(bvh, means(samplers[s]), media[m].first + ", " + samplers[s]);
    }
}

TEST(VolPath, FindsWhatThePlainWalkFinds) {
    const std::string lamp =
        Objects().Attribute("Translate -1.5 1.5 .5", Objects().AreaLight("9 8 6").Diffuse("0 0 0").Sphere(1));
    for (const auto &[name, medium] : ScatteringMedia()) {
        auto means = [&, &medium = medium](const char *integrator, int samples) {
            Setting setting;
            setting.integrator = integrator;
            setting.maxDepth = 6;
            setting.samples = samples;
            return MeansOverSeeds(VolumeScene(lamp + Ball(medium), setting));
        };
        // The furnace has the dense one as well; here its noise would take too long.
        if (name != "dense, back") ExpectEqualMeans(means("volpath", 24), means("simplevolpath", 96), name);
    }
}

TEST(VolPath, AnyNumberOfThreadsGivesTheSameBits) {
    auto render = [](int threads) {
        ThreadLimit limit(threads);
        Setting setting;
        setting.samples = 8;
        return RenderText(VolumeScene(Foggy(ScatteringMedia()[3].second), setting)).image;
    };
    EXPECT_TRUE(SameBits(render(1), render(3)));
}

TEST(VolPath, PathSeesNoMediaAndSaysSo) {
    Setting setting;
    setting.integrator = "path";
    const Rendered fog = RenderText(VolumeScene(kSky + Ball(ScatteringMedia()[0].second), setting));
    int warnings = 0;
    for (const Diagnostic &d : fog.diagnostics) warnings += d.message.find("renders no media") != std::string::npos;
    EXPECT_EQ(warnings, 1);
}

/// How far away such lights are would decide how much fog is before them.
TEST(Bdpt, WarnsOfLightsBeyondAFogWithoutEnd) {
    const std::string fog = Homogeneous("fog", "") + "MediumInterface 'fog' 'fog'\n";
    const std::string end = "MediumInterface 'fog' ''\nMaterial 'interface' Shape 'sphere' 'float radius' 9\n";
    const std::string sun = "LightSource 'distant'\n", lamp = "LightSource 'point' 'point3 from' [ 0 2 0 ]\n";
    const auto warns = [&](const std::string &world, const std::string &integrator) {
        Setting setting;
        setting.integrator = integrator;
        setting.samples = 1;
        setting.beforeCamera = fog;
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
    Setting setting;
    setting.integrator = "simplevolpath";
    EXPECT_THROW(RenderText(VolumeScene(kSky + "Shape 'sphere'", setting)), UserError);
}

}  // namespace
}  // namespace pbrt::test
