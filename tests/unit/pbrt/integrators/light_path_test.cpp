// Paths from the lights, and paths from both sides, make the picture that paths from the camera make.
#include <gtest/gtest.h>

#include "pbrt/core/parallel.h"
#include "support/render_scene.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

constexpr int kSize = 16, kTile = 4;

struct View {
    std::string name;
    std::string camera = "Camera \"perspective\" \"float fov\" 50\n";
    std::string filter = "PixelFilter \"box\"\n";
    std::string film{};     ///< further parameters
    std::string objects{};  ///< in the room
    int samples = 256;
    int depth = 3;
    bool isForLightPath = true;
};
void PrintTo(const View &v, std::ostream *out) { *out << v.name; }

std::string Scene(const View &v, const std::string &integrator, int seed, int samples) {
    return "LookAt 0 -3.4 1.1  0 0 1  0 0 1\n" + v.camera + v.filter +
           fmt::format(
               "Film \"rgb\" \"integer xresolution\" {0} \"integer yresolution\" {0} \"bool savefp16\" false {1}\n"
               "Sampler \"independent\" \"integer pixelsamples\" {2} \"integer seed\" {3}\n"
               "Integrator \"{4}\" \"integer maxdepth\" {5}\nWorldBegin\n",
               kSize, v.film, samples, seed, integrator, v.depth) +
           "Material \"diffuse\" \"rgb reflectance\" [ .6 .5 .4 ]\n"
           "Shape \"trianglemesh\" \"point3 P\" [ -1.5 -2 0  1.5 -2 0  1.5 1.5 0  -1.5 1.5 0  -1.5 1.5 2.2  1.5 1.5 2.2 ]\n"
           " \"integer indices\" [ 0 1 2  0 2 3  3 2 5  3 5 4 ]\n" +
           v.objects;
}

Image Render(const View &v, const std::string &integrator, int seed, int samples) {
    return RenderText(Scene(v, integrator, seed, samples)).image;
}

/// Tile means of eight renders each; the largest distance, in standard errors, of any tile and colour.
double LargestDistance(const View &v, const std::string &integrator, double *noise = nullptr) {
    constexpr int kSeeds = 8;
    std::vector<RunningStatistics> ours, path;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        const auto a = TileMeans(Render(v, integrator, seed, v.samples), kTile),
                   b = TileMeans(Render(v, "path", 100 + seed, v.samples), kTile);
        ours.resize(a.size());
        path.resize(b.size());
        for (size_t i = 0; i < a.size(); ++i) {
            ours[i].Add(a[i]);
            path[i].Add(b[i]);
        }
    }
    double largest = 0, all = 0, error = 0;
    for (size_t i = 0; i < ours.size(); ++i) {
        const double e = std::hypot(ours[i].StandardError(), path[i].StandardError());
        if (e > 0) largest = std::max(largest, std::abs(ours[i].mean - path[i].mean) / e);
        all += path[i].mean;
        error += e;
    }
    if (noise) *noise = error / all;
    return largest;
}

const std::string kLamp =
    "AttributeBegin Translate .3 -.4 2 Rotate 160 1 0 0 AreaLightSource \"diffuse\" \"rgb L\" [ 8 7 5 ]\n"
    "Shape \"disk\" \"float radius\" .4 AttributeEnd\n";
const std::string kBall = "AttributeBegin Translate -.5 .3 .5 Shape \"sphere\" \"float radius\" .5 AttributeEnd\n";
/// Out of sight, so that only the light it sends to the floor is seen.
std::string Hidden(const std::string &material) {
    return "AttributeBegin " + material +
           " Translate .2 -.6 2.8 Scale .35 .35 .35 Shape \"sphere\" AttributeEnd\n"
           "AttributeBegin Translate .2 -.6 3.5 Rotate 180 1 0 0 AreaLightSource \"diffuse\" \"rgb L\" [ 9 9 9 ]\n"
           "Shape \"disk\" \"float radius\" .6 AttributeEnd\n";
}

const View kViews[] = {
    {.name = "DiskAndBall", .objects = kLamp + kBall},
    {.name = "Orthographic",
     .camera = "Camera \"orthographic\" \"float screenwindow\" [ -1.4 1.4 -1.1 1.1 ]\n",
     .objects = kLamp + kBall},
    {.name = "Lens",
     .camera = "Camera \"perspective\" \"float fov\" 50 \"float lensradius\" .2 \"float focaldistance\" 2.5\n",
     .objects = kLamp + kBall},
    {.name = "GaussianFilter", .filter = "PixelFilter \"gaussian\"\n", .objects = kLamp + kBall},
    {.name = "Crop", .film = "\"float cropwindow\" [ .25 .75 .5 1 ]", .objects = kLamp + kBall},
    {.name = "PointSpotAndDistant",
     .objects = "LightSource \"point\" \"point3 from\" [ 1 -1 1.5 ] \"rgb I\" [ 1 2 3 ]\n"
                "LightSource \"spot\" \"point3 from\" [ -1 -1 2 ] \"point3 to\" [ 0 0 0 ] \"rgb I\" [ 6 5 4 ]\n"
                "LightSource \"distant\" \"point3 from\" [ 1 -2 3 ] \"rgb L\" [ .3 .3 .3 ]\n" +
                kBall},
    {.name = "RoughMetal", .objects = kLamp + "Material \"conductor\" \"float roughness\" .5\n" + kBall},
    {.name = "Coat", .objects = kLamp + "Material \"coateddiffuse\" \"float roughness\" .3\n" + kBall},
    {.name = "RoughGlass", .objects = Hidden("Material \"dielectric\" \"float roughness\" .4")},
    {.name = "SmoothGlass", .objects = Hidden("Material \"dielectric\"")},
    // Normals that lean far away from the surface: without their correction (AdjointCosine) the floor would be wrong.
    {.name = "ShadingNormals",
     .objects = kLamp +
                "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 .05  1 -1 .05  1 1 .05  -1 1 .05 ]\n"
                " \"normal N\" [ -.9 0 .6  .9 0 .6  0 .9 .6  0 -.9 .6 ] \"integer indices\" [ 0 1 2  0 2 3 ]\n"},
    {.name = "DepthOne", .objects = kLamp + kBall, .depth = 1},
    {.name = "Mirror",
     .objects = kLamp + "Material \"conductor\" \"float roughness\" 0\n" + kBall,
     .depth = 4,
     .isForLightPath = false},
    {.name = "SkyAndGlass",
     .objects = "LightSource \"infinite\" \"rgb L\" [ .5 .7 1 ]\n" + kLamp + "Material \"dielectric\"\n" + kBall,
     .depth = 4,
     .isForLightPath = false},
    {.name = "SkyOnly", .objects = "LightSource \"infinite\" \"rgb L\" [ .5 .7 1 ]\n" + kBall, .isForLightPath = false},
};

class LightPathViews : public testing::TestWithParam<View> {};

TEST_P(LightPathViews, AgreeWithPath) {
    if (!GetParam().isForLightPath) GTEST_SKIP() << "light that only camera paths see";
    double noise = 1;
    // 48 numbers a view, 12 views: chance goes beyond 5.5 with 14 degrees of freedom in one of some 25 runs of all.
    EXPECT_LT(LargestDistance(GetParam(), "lightpath", &noise), 5.5);
    EXPECT_LT(noise, 0.06) << "the test would see nothing";
}

TEST_P(LightPathViews, BidirectionalPathsAgreeWithPath) {
    double noise = 1;
    View view = GetParam();
    view.samples /= 2;
    EXPECT_LT(LargestDistance(view, "bdpt", &noise), 5.5);
    EXPECT_LT(noise, 0.08) << "the test would see nothing";
}

INSTANTIATE_TEST_SUITE_P(All, LightPathViews, testing::ValuesIn(kViews),
                         [](const auto &test) { return test.param.name; });

TEST(LightPath, IsTheSameForAnyNumberOfThreads) {
    const View view{.name = "threads", .objects = kLamp + kBall};
    for (const char *integrator : {"lightpath", "bdpt"}) {
        ThreadLimit one(1);
        const Image expected = Render(view, integrator, 1, 16);
        for (int threads : {2, 5}) {
            ThreadLimit limit(threads);
            const Image image = Render(view, integrator, 1, 16);
            for (int y = 0; y < kSize; ++y)
                for (int x = 0; x < kSize; ++x) EXPECT_EQ(image.Get({x, y}, 0), expected.Get({x, y}, 0));
        }
    }
}

TEST(LightPath, NeedsACameraThatItCanReach) {
    const View view{.name = "spherical", .camera = "Camera \"spherical\"\n", .objects = kLamp};
    try {
        Render(view, "lightpath", 1, 1);
        FAIL() << "a picture";
    } catch (const UserError &e) {
        EXPECT_NE(std::string(e.what()).find("\"perspective\" and \"orthographic\""), std::string::npos) << e.what();
    }
}

}  // namespace
}  // namespace pbrt::test
