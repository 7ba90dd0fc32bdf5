// Every integrator finds lamps of a few nanometres beside one of all wavelengths, also at the end of the visible range
// for a film of that range only, and lamps of any radiance, with every light sampler. Pictures are small; means over
// seeds are compared with their standard errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

#include "support/build_text.h"
#include "support/render_scene.h"
#include "support/scene_text.h"
#include "support/test_name.h"

namespace pbrt::test {
namespace {

constexpr int kSeeds = 12;
/// Standard errors that a mean may be away; some 300 means of 12 seeds are compared.
constexpr double kLimit = 6;

/// Lights as text, and the film that measures them.
struct Lamps {
    const char *text;
    const char *film = "rgb", *range = "";
};

/// A floor and a wall; radiances of the lights in units of `scale`.
std::string Scene(const std::string &integrator, const Lamps &lamps, double scale) {
    std::string parameters = integrator.starts_with("simple") ? "" : "'integer maxdepth' 3";
    // A hundred pairs for the brightness of each sample of the 64 pixels.
    if (integrator == "mlt") parameters += " 'integer bootstrapsamples' 10000";
    return SceneText()
        .LookAt("0 1 4  0 1 0  0 1 0")
        .Camera(50)
        .Film(8, 8, std::string("'bool savefp16' false ") + lamps.range, lamps.film)
        .Samples(1)
        .Integrator(integrator, parameters)
        .World(Objects()
                   .Add(fmt::format(fmt::runtime(lamps.text), fmt::arg("s", scale)))
                   .Diffuse(".6 .5 .4")
                   .Quad("-2 0 -2  2 0 -2  -2 0 2  2 0 2")
                   .Quad("-2 0 -2  2 0 -2  -2 3 -2  2 3 -2"));
}

/// White light, and lines between the wavelengths 360, 479, 546 and 617 nm: SampleVisible(0.5) meets none of them.
const Lamps kLines = {R"(LightSource "point" "point3 from" [ -1 2 1 ] "float scale" {s}
LightSource "point" "point3 from" [ 1 2 1 ] "spectrum I" [ 574 0 588 1 602 0 ] "float scale" {s}
LightSource "point" "point3 from" [ 0 1 1 ] "spectrum I" [ 500 0 512 1 524 0 ] "float scale" {s}
AttributeBegin
AreaLightSource "diffuse" "spectrum L" [ 420 0 440 1 460 0 ] "float scale" {s}
Shape "bilinearmesh" "point3 P" [ -.5 3 -.5  .5 3 -.5  -.5 3 .5  .5 3 .5 ]
AttributeEnd
LightSource "distant" "point3 from" [ 1 2 3 ] "spectrum L" [ 630 0 650 1 670 0 ] "float scale" {s}
)"};
const Lamps kColours = {R"(LightSource "point" "point3 from" [ -1 2 1 ] "float scale" {s}
LightSource "point" "point3 from" [ 1 2 1 ] "rgb I" [ .2 .5 2 ] "float scale" {s}
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 2 1 1 ] "float scale" {s}
Shape "bilinearmesh" "point3 P" [ -.5 3 -.5  .5 3 -.5  -.5 3 .5  .5 3 .5 ]
AttributeEnd
LightSource "distant" "point3 from" [ 1 2 3 ] "float scale" {s}
)"};
/// Lines in the film's range, and a light that emits nothing there.
const Lamps kInfrared = {R"(LightSource "point" "point3 from" [ -1 2 1 ] "spectrum I" [ 400 1 700 1 ] "float scale" {s}
LightSource "point" "point3 from" [ 1 2 1 ] "spectrum I" [ 788 0 800 1 812 0 ] "float scale" {s}
AttributeBegin
AreaLightSource "diffuse" "spectrum L" [ 782 0 790 1 798 0 ] "float scale" {s}
Shape "bilinearmesh" "point3 P" [ -.5 3 -.5  .5 3 -.5  -.5 3 .5  .5 3 .5 ]
AttributeEnd
LightSource "distant" "point3 from" [ 1 2 3 ] "spectrum L" [ 800 0 815 1 830 0 ] "float scale" {s}
)",
                         "spectral", "'float lambdamin' 780 'integer nbuckets' 2"};
/// A sun of real size in metres, and lamps that are about as bright here.
const Lamps kSun = {R"(LightSource "point" "point3 from" [ -1 2 1 ] "rgb I" [ 3 1 1 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 3e4 3e4 6e4 ]
Translate 5e10 1e11 1e11
Shape "sphere" "float radius" 7e8
AttributeEnd
)"};

struct Estimate {
    std::array<double, 3> mean{}, error{};
};

/// Mean of the picture and its standard error over the seeds; divided by `scale`.
Estimate Measure(const std::string &integrator, const std::string &sampler, const Lamps &lamps, double scale, int spp) {
    std::array<RunningStatistics, 3> channels;
    for (int seed = 0; seed < kSeeds; ++seed) {
        BuildOptions options;
        options.seed = seed;
        options.samplesPerPixel = spp;
        options.lightSampler = sampler;
        const Image image = RenderText(Scene(integrator, lamps, scale), options).image;
        const std::vector<double> means = TileMeans(image, 8);
        for (size_t c = 0; c < 3; ++c) channels[c].Add(means[c] / scale);
    }
    Estimate e;
    for (size_t c = 0; c < 3; ++c) {
        e.mean[c] = channels[c].mean;
        e.error[c] = channels[c].StandardError();
    }
    return e;
}

/// `bias`: a share of the mean by which a picture may differ besides.
void ExpectSame(const Estimate &a, const Estimate &b, double bias = 0) {
    // Lines lie outside of the gamut of sRGB, so a channel's mean may be negative or small.
    double largest = 0;
    for (const double mean : b.mean) largest = std::max(largest, std::abs(mean));
    for (size_t c = 0; c < 3; ++c) {
        const double error = std::hypot(a.error[c], b.error[c]);
        EXPECT_NEAR(a.mean[c], b.mean[c], kLimit * error + (bias + 1e-3) * std::abs(b.mean[c])) << "channel " << c;
        // The loss of a lamp, a quarter of the light or more, is noticed.
        EXPECT_LT(kLimit * error, 0.25 * largest) << "the test notices nothing, channel " << c;
    }
}

struct Case {
    std::string integrator, sampler;
    int spp;
};

std::vector<Case> Cases() {
    std::vector<Case> cases;
    std::vector<std::string> samplers = AllSamplers().samplers.Names();
    std::erase(samplers, "oracle");
    // What it does before rendering is cut down.
    std::ranges::replace(samplers, std::string("spatial"), std::string("spatial:voxels=8,samples=64"));
    for (const std::string &name : samplers) cases.push_back({"path", name, 64});
    const bool ext = AllSamplers().samplers.Has("octree");
    // Samplers and integrators are independent: each is here once, and twice where light paths start.
    const char *sampler = ext ? "octree" : "bvh";
    for (const char *integrator : {"volpath", "bdpt", "simplepath", "lightpath"})
        cases.push_back({integrator, sampler, 96});
    for (const char *integrator : {"sppm", "mlt"}) cases.push_back({integrator, sampler, 256});
    cases.push_back({"bdpt", "power", 96});
    if (ext) cases.push_back({"path", "octree+guide", 64});
    return cases;
}

/// The picture of the lights with uniform choices, which need no weights.
const Estimate &Reference(const Lamps &lamps) {
    static std::map<std::string, Estimate> references;
    auto [it, isNew] = references.try_emplace(lamps.text);
    if (isNew) it->second = Measure("path", "uniform", lamps, 1, 512);
    return it->second;
}

class LightWeights : public testing::TestWithParam<Case> {
  protected:
    double Bias() const { return GetParam().integrator == "sppm" ? 0.02 : 0; }
    Estimate Here(const Lamps &lamps, double scale = 1) const {
        return Measure(GetParam().integrator, GetParam().sampler, lamps, scale, GetParam().spp);
    }
};

TEST_P(LightWeights, LinesAreSampledBesideWhiteLight) { ExpectSame(Here(kLines), Reference(kLines), Bias()); }
TEST_P(LightWeights, LinesAreSampledForAFilmOfTheirRange) { ExpectSame(Here(kInfrared), Reference(kInfrared), Bias()); }
TEST_P(LightWeights, StrongRadianceIsTheSamePicture) { ExpectSame(Here(kColours, 1e25), Reference(kColours), Bias()); }
TEST_P(LightWeights, WeakRadianceIsTheSamePicture) { ExpectSame(Here(kColours, 1e-25), Reference(kColours), Bias()); }
TEST_P(LightWeights, ASunOfRealSizeLeavesLocalLightsTheirShare) {
    const Case &c = GetParam();
    if (c.integrator != "path" && c.integrator != "volpath") GTEST_SKIP() << "light paths start at the sun";
    if (c.sampler == "power" || c.sampler == "seen") GTEST_SKIP() << "the sun has all of the power";
    ExpectSame(Here(kSun), Reference(kSun));
}

INSTANTIATE_TEST_SUITE_P(All, LightWeights, testing::ValuesIn(Cases()),
                         [](const auto &c) { return TestName(c.param.integrator + "_" + c.param.sampler); });

}  // namespace
}  // namespace pbrt::test
