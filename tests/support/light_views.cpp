#include "support/light_views.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "pbrt/core/error.h"
#include "pbrt/math/statistics.h"
#include "support/statistics.h"
#include "support/threads.h"

namespace pbrt::test {

namespace {

constexpr int kTile = 4;
/// Of the difference of a tile.
constexpr double kMinChance = 7e-5;

}  // namespace

const std::string kRealisticCamera = "Camera 'realistic' 'string lensfile' '" PBRT_SOURCE_DIR
                                     "/tests/conformance/suite/scenes/assets/lens_symmetric.dat'";

void PrintTo(const View &v, std::ostream *out) { *out << v.name; }

namespace {

std::string Scene(const View &v, const std::string &integrator, int seed, int samples) {
    std::string parameters;
    if (integrator != v.reference)
        parameters =
            v.parameters + (integrator == "mlt" ? fmt::format(" 'integer mutationsperpixel' {}", samples) : "");
    return SceneText()
        .Head(v.media)
        .LookAt("0 -3.4 1.1  0 0 1  0 0 1")
        .Head(v.camera)
        .Filter(v.filter)
        .Film(kViewSize, kViewSize, "'bool savefp16' false " + v.film, v.filmType)
        // Its pixels are independent as well, and their variance is a quarter for most views.
        .Head(fmt::format("Sampler 'paddedsobol' 'integer pixelsamples' {} 'integer seed' {}", samples, seed))
        .Integrator(integrator, v.depth, parameters)
        .World(Objects()
                   .Diffuse(".6 .5 .4")
                   .Triangles("-1.5 -2 0  1.5 -2 0  1.5 1.5 0  -1.5 1.5 0  -1.5 1.5 2.2  1.5 1.5 2.2",
                              "0 1 2  0 2 3  3 2 5  3 5 4")
                   .Add(v.objects));
}

}  // namespace

Image RenderView(const View &v, const std::string &integrator, int seed, int samples) {
    return RenderText(Scene(v, integrator, seed, samples)).image;
}

namespace {

/// Statistics of the tiles' means over some renders.
std::vector<RunningStatistics> TileStatistics(const View &v, const std::string &integrator, int firstSeed, int renders,
                                              int samples) {
    std::vector<RunningStatistics> tiles;
    for (int seed = firstSeed; seed < firstSeed + renders; ++seed) {
        const std::vector<double> means = TileMeans(RenderView(v, integrator, seed, samples), kTile);
        tiles.resize(means.size());
        for (size_t i = 0; i < means.size(); ++i) tiles[i].Add(means[i]);
    }
    return tiles;
}

/// Those of the reference, rendered once in this process for all integrators that need as many samples of it.
const std::vector<RunningStatistics> &ReferenceStatistics(const View &v) {
    constexpr int kFirstSeed = 101;
    static std::map<std::string, std::vector<RunningStatistics>> references;
    auto [it, isNew] = references.try_emplace(Scene(v, v.reference, kFirstSeed, v.referenceSamples));
    if (isNew) it->second = TileStatistics(v, v.reference, kFirstSeed, kRenders, v.referenceSamples);
    return it->second;
}

}  // namespace

void CheckMean(const View &v, const std::string &integrator, double maxBias, double allowed) {
    const std::vector<RunningStatistics> ours = TileStatistics(v, integrator, 1, v.renders, v.samples),
                                         &path = ReferenceStatistics(v);
    ASSERT_EQ(ours.size(), path.size());
    double least = 1, all = 0, bias = 0;
    for (const RunningStatistics &p : path) all += p.mean;
    const double without = allowed * all / double(path.size());
    for (size_t i = 0; i < ours.size(); ++i) {
        // Welch's test, as the variances differ.
        const double a = Sqr(ours[i].StandardError()), b = Sqr(path[i].StandardError()), e = std::sqrt(a + b);
        const double t = (std::abs(ours[i].mean - path[i].mean) - without) / e;
        const double dof = Sqr(a + b) / (Sqr(a) / (v.renders - 1) + Sqr(b) / (kRenders - 1));
        if (t > 0) least = std::min(least, StudentTwoSidedP(t, dof));
        if (e > 0) bias += StudentCritical(kMinChance, dof) * e;
    }
    EXPECT_GT(least, kMinChance) << v.name << " " << v.parameters;
    EXPECT_LT(bias / all, maxBias) << v.name << " " << v.parameters << ": the test would see nothing";
}

void CheckThreads(const View &v, const std::string &integrator, int samples) {
    const auto render = [&] { return RenderView(v, integrator, 1, samples); };
    const Image expected = OnThreads(1, render);
    for (int threads : {2, 5})
        EXPECT_TRUE(SameBits(expected, OnThreads(threads, render))) << integrator << ", " << threads;
}

void CheckLightSamplers(View v, const std::string &integrator, const std::vector<std::string> &choices,
                        double allowed) {
    v.objects += Objects().PointLight("1 -1 1.5", ".5 1 1.5").Sky(".2 .2 .3");
    const std::string parameters = v.parameters;
    int tested = 0;
    for (const std::string &choice : choices) {
        v.parameters = parameters + " " + choice;
        try {
            RenderView(v, integrator, 1, 1);
        } catch (const UserError &) {
            continue;  // a build without extensions
        }
        ++tested;
        CheckMean(v, integrator, 0.44, allowed);
    }
    EXPECT_GE(tested, 2);
}

namespace {

const std::string kParallel = "Camera 'orthographic' 'float screenwindow' [ -1.4 1.4 -1.1 1.1 ]";
const std::string kLens = "Camera 'perspective' 'float fov' 50 'float lensradius' .2 'float focaldistance' 2.5";
const std::string kLamp =
    Objects().Attribute("Translate .3 -.4 2 Rotate 160 1 0 0", Objects().AreaLight("8 7 5").Disk(.4));
const std::string kBall = Objects().Attribute("Translate -.5 .3 .5", Objects().Sphere(.5));
const std::string kSky = Objects().Sky(".5 .7 1");
/// Out of sight, so that only the light it sends to the floor is seen.
std::string Hidden(const std::string &material) {
    return Objects()
        .Attribute("Material " + material + " Translate .2 -.6 2.8 Scale .35 .35 .35", Objects().Shape("sphere"))
        .Attribute("Translate .2 -.6 3.5 Rotate 180 1 0 0", Objects().AreaLight("9 9 9").Disk(.6));
}

}  // namespace

const std::vector<View> &AllViews() {
    static const std::vector<View> views = {
        {.name = "DiskAndBall", .objects = kLamp + kBall},
        {.name = "Orthographic", .camera = kParallel, .objects = kLamp + kBall},
        {.name = "Lens", .camera = kLens, .objects = kLamp + kBall},
        // From the middle of the room; the filter reaches across the edges of the picture.
        {.name = "SphericalEqualArea",
         .camera = "Translate 0 -2.6 -.2 Camera 'spherical'",
         .filter = "gaussian",
         .objects = kLamp + kBall,
         .referenceSamples = 96},  // few of the filter's points reach the lamp from dark tiles
        {.name = "SphericalEquirectangular",
         .camera = "Translate 0 -2.6 -.2 Camera 'spherical' 'string mapping' 'equirectangular'",
         .filter = "gaussian",
         .objects = kLamp + kBall,
         .referenceSamples = 96},
        {.name = "GaussianFilter", .filter = "gaussian", .objects = kLamp + kBall},
        {.name = "Crop", .film = "'float cropwindow' [ .25 .75 .5 1 ]", .objects = kLamp + kBall},
        {.name = "PointSpotAndDistant",
         .objects = Objects()
                        .PointLight("1 -1 1.5", "1 2 3")
                        .Light("spot", "'point3 from' [ -1 -1 2 ] 'point3 to' [ 0 0 0 ] 'rgb I' [ 6 5 4 ]")
                        .Light("distant", "'point3 from' [ 1 -2 3 ] 'rgb L' [ .3 .3 .3 ]")
                        .Add(kBall),
         .samples = 28},
        {.name = "RoughMetal", .objects = kLamp + "Material 'conductor' 'float roughness' .5\n" + kBall},
        {.name = "Coat", .objects = kLamp + "Material 'coateddiffuse' 'float roughness' .3\n" + kBall},
        {.name = "RoughGlass", .objects = Hidden("'dielectric' 'float roughness' .4")},
        {.name = "SmoothGlass", .objects = Hidden("'dielectric'")},
        // Normals that lean far away from the surface: without their correction (AdjointCosine) the floor would be
        // wrong.
        {.name = "ShadingNormals",
         .objects = kLamp +
                    "Shape 'trianglemesh' 'point3 P' [ -1 -1 .05  1 -1 .05  1 1 .05  -1 1 .05 ]\n"
                    " 'normal N' [ -.9 0 .6  .9 0 .6  0 .9 .6  0 -.9 .6 ] 'integer indices' [ 0 1 2  0 2 3 ]\n"},
        {.name = "DepthOne", .objects = kLamp + kBall, .depth = 1},
        {.name = "Mirror",
         .objects = kLamp + "Material 'conductor' 'float roughness' 0\n" + kBall,
         .depth = 4,
         .isForLightPath = false},
        {.name = "SkyAndGlass",
         .objects = kSky + kLamp + "Material 'dielectric'\n" + kBall,
         .depth = 4,
         .isForLightPath = false},
        {.name = "SkyOnly", .objects = kSky + kBall, .isForLightPath = false},
    };
    return views;
}

namespace {

std::string Medium(const std::string &name, const std::string &parameters) {
    return "MakeNamedMedium '" + name + "' 'string type' " + parameters + "\n";
}
const std::string kThinFog = Medium("fog", "'homogeneous' 'rgb sigma_s' [ .25 .25 .25 ] 'rgb sigma_a' [ .03 .03 .03 ]");
const std::string kColoredFog = Medium("fog", "'homogeneous' 'rgb sigma_s' [ .15 .3 .6 ] 'rgb sigma_a' [ .1 .03 .02 ]");
const std::string kInFog = "MediumInterface 'fog' 'fog'\n";
const std::string kSpot =
    "LightSource 'spot' 'point3 from' [ -1 -1 2 ] 'point3 to' [ .2 0 .3 ] 'rgb I' [ 9 8 7 ] "
    "'float coneangle' 25\n";

/// Densities of 3 x 4 x 2 voxels in the box from -.6 to .6.
std::string Grid(const std::string &name, const std::string &parameters) {
    std::string text =
        "'uniformgrid' 'integer nx' 3 'integer ny' 4 'integer nz' 2 'point3 p0' [ -.6 -.6 -.6 ] "
        "'point3 p1' [ .6 .6 .6 ] 'float density' [";
    for (int i = 0; i < 24; ++i) text += fmt::format(" {}", 0.2 + 0.17 * (i * 7 % 11));
    return Medium(name, text + " ] " + parameters);
}
/// A ball of radius .6 above the floor, of a medium that is defined there.
std::string BallOf(const std::string &medium, const std::string &material = "Material 'interface'",
                   const std::string &outside = "") {
    return "AttributeBegin Translate -.2 .2 .7\n" + medium + material + "\nMediumInterface 'm' '" + outside +
           "'\nShape 'sphere' 'float radius' .6 AttributeEnd\n";
}

}  // namespace

const std::vector<View> &FoggyViews() {
    static const std::vector<View> views = [] {
        const std::string chromatic = Medium("m", "'homogeneous' 'rgb sigma_s' [ 12 5 2 ] 'rgb sigma_a' [ .1 .4 1 ]");
        std::vector<View> all = {
            {.name = "FogAndSpot",
             .objects = kSpot + kBall,
             .referenceSamples = 96,  // few of them scatter near the spot
             .isForLightPath = false,
             .media = kThinFog + kInFog},
            {.name = "OrthographicInFog", .camera = kParallel, .objects = kLamp + kBall, .media = kColoredFog + kInFog},
            {.name = "ForwardScattering",
             .objects = kLamp,
             .isForLightPath = false,
             .media = Medium("fog",
                             "'homogeneous' 'rgb sigma_s' [ .4 .4 .4 ] 'rgb sigma_a' [ .03 .03 .03 ] "
                             "'float g' .8") +
                      kInFog},
            {.name = "DenseAndColored", .objects = kLamp + BallOf(chromatic), .referenceSamples = 48, .depth = 6},
            {.name = "Grid", .objects = kLamp + BallOf(Grid("m", "'rgb sigma_s' [ 4 5 6 ] 'float g' .3")), .depth = 4},
            // The ball's medium reaches the lamp, which shines out of it; a point light shines there, too.
            {.name = "LightsInside",
             .objects = "LightSource 'point' 'point3 from' [ 1 -1 1.5 ] 'rgb I' [ .5 .5 .5 ]\n" +
                        BallOf(Medium("m", "'homogeneous' 'rgb sigma_s' [ 1 2 3 ] 'rgb sigma_a' [ .3 .2 .1 ]")) +
                        "AttributeBegin MediumInterface 'm' 'm'\nLightSource 'point' 'point3 from' [ -.2 .1 .5 ] "
                        "'rgb I' [ .6 .4 .2 ]\nTranslate -.2 .2 .8 AreaLightSource 'diffuse' 'rgb L' [ 5 7 9 ]\n"
                        "Shape 'sphere' 'float radius' .15 AttributeEnd\n"},
            {.name = "CameraInside",
             .camera = "Camera 'perspective' 'float fov' 50\nMediumInterface '' ''\n",
             .objects = kLamp + kBall +
                        "AttributeBegin Translate 0 -3.4 1.1 Material 'interface' MediumInterface 'fog' ''\n"
                        "Shape 'sphere' 'float radius' 2 AttributeEnd\n",
             .isForLightPath = false,
             .media = kColoredFog + "MediumInterface '' 'fog'\n"},
            {.name = "LensAndLampInFog",
             .camera = kLens,
             .objects = kLamp + kBall,
             .isForLightPath = false,
             .media = kColoredFog + kInFog},
            {.name = "OrthographicGridAndDistant",
             .camera = kParallel,
             .objects = "LightSource 'distant' 'point3 from' [ 1 -2 3 ] 'rgb L' [ 2 2 2 ]\n" +
                        BallOf(Grid("m", "'float g' -.4"))},
            {.name = "SkyAndGrid",
             .objects = kSky + BallOf(Grid("m", "'rgb sigma_s' [ 3 4 5 ]")),
             .isForLightPath = false},
            // Most of what the last ray of a path finds is behind the ball's surface.
            {.name = "SkyThroughInterface",
             .objects = kSky + BallOf(Medium("m", "'homogeneous' 'rgb sigma_s' [ 1 1 1 ] 'rgb sigma_a' [ 0 0 0 ]")),
             .depth = 1,
             .isForLightPath = false},
            {.name = "SmoothGlassInFog",
             .objects = kLamp + BallOf(chromatic, "Material 'dielectric' 'float eta' 1.3", "fog"),
             .depth = 5,
             .isForLightPath = false,
             .media = kThinFog + kInFog},
            {.name = "RoughGlassInFog",
             .objects = kLamp + BallOf(chromatic, "Material 'dielectric' 'float roughness' .5", "fog"),
             .depth = 5,
             .isForLightPath = false,
             .media = kThinFog + kInFog},
            {.name = "Dispersion",
             .objects = kLamp + "Material 'dielectric' 'spectrum eta' 'glass-F11'\n" + kBall,
             .depth = 4,
             .isForLightPath = false,
             .media = kColoredFog + kInFog},
            {.name = "Glow",
             .objects = kLamp + BallOf(Medium("m",
                                              "'homogeneous' 'rgb sigma_s' [ 1 1 1 ] 'rgb sigma_a' [ 1 2 3 ] "
                                              "'rgb Le' [ 1 .5 .2 ] 'float Lescale' 1")),
             .isForLightPath = false},
        };
        for (View &v : all) v.reference = "volpath";
        return all;
    }();
    return views;
}

std::vector<View> ViewsNamed(const std::vector<std::string> &names) {
    std::vector<View> found;
    for (const std::string &name : names)
        for (const std::vector<View> *views : {&AllViews(), &FoggyViews()})
            for (const View &v : *views)
                if (v.name == name) found.push_back(v);
    PBRT_CHECK(found.size() == names.size());
    return found;
}

}  // namespace pbrt::test
