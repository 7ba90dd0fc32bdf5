// Light sampled on whole segments (PathSettings::equiangular) against light sampled at the vertices of delta tracking.
#include <gtest/gtest.h>

#include "support/build_text.h"
#include "support/render_scene.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

/// A view of 12 x 12 pixels into fog that begins at the camera, towards a wall at z = 0.
std::string View(const std::string &fog, const std::string &world, const std::string &lightSampler, bool equiangular,
                 int maxDepth, int samples, int seed) {
    return fmt::format(
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" {}\nMediumInterface \"fog\" \"fog\"\n"
        "LookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 50\n"
        "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 12 \"bool savefp16\" false\n"
        "PixelFilter \"box\"\nSampler \"independent\" \"integer pixelsamples\" {} \"integer seed\" {}\n"
        "Integrator \"volpath\" \"integer maxdepth\" {} \"string lightsampler\" \"{}\" \"bool equiangular\" {}\n"
        "WorldBegin\n{}",
        fog, samples, seed, maxDepth, lightSampler, equiangular ? "true" : "false", world);
}

const char *const kWall =
    "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [-4 -4 0  4 -4 0  -4 4 0  4 4 0]\n";
const char *const kLamps =
    "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [30 10 3]\n"
    "Translate .5 .3 2\nShape \"sphere\" \"float radius\" .1\nAttributeEnd\n"
    "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [2 4 9] \"bool twosided\" true\n"
    "Shape \"bilinearmesh\" \"point3 P\" [-2 -1 1  -1 -1 1  -2 1 1.5  -1 1 1.5]\nAttributeEnd\n";
/// Out of view, because light sampled at the places of delta tracking has no finite variance around them.
const char *const kPoints =
    "LightSource \"point\" \"point3 from\" [-2.4 .2 1.5] \"rgb I\" [1 2 3]\n"
    "LightSource \"spot\" \"point3 from\" [1.5 0 2] \"point3 to\" [-1 0 1.5] \"rgb I\" [9 9 4] \"float coneangle\" 12\n"
    "LightSource \"distant\" \"point3 from\" [1 1 3] \"rgb L\" [.3 .2 .1]\n";
/// It fills the view, so that phase functions find it as well as light sampling does.
const char *const kPanel =
    "AreaLightSource \"diffuse\" \"rgb L\" [3 2 1] \"bool twosided\" true\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
    "ReverseOrientation\nShape \"bilinearmesh\" \"point3 P\" [-3 -3 0  3 -3 0  -3 3 0  3 3 0]\n";
const char *const kEven = "\"rgb sigma_s\" [.2 .2 .2] \"rgb sigma_a\" [.02 .02 .02] \"float g\" .5";
const char *const kColoured = "\"rgb sigma_s\" [.1 .3 .9] \"rgb sigma_a\" [.4 .1 0] \"float g\" -.3";

struct Case {
    const char *name, *fog;
    std::string world;
    const char *lightSampler;
    int maxDepth;
};

/// Per pixel and channel, over independent seeds.
std::vector<RunningStatistics> Pixels(const Case &c, bool equiangular, int samples, int seeds) {
    std::vector<RunningStatistics> pixels(12 * 12 * 3);
    for (int seed = 1; seed <= seeds; ++seed) {
        const Image image = RenderText(View(c.fog, c.world, c.lightSampler, equiangular, c.maxDepth, samples,
                                            seed + (equiangular ? 100 : 0)))
                                .image;
        for (size_t i = 0; i < pixels.size(); ++i)
            pixels[i].Add(double(image.Get({int(i / 3 % 12), int(i / 36)}, int(i % 3))));
    }
    return pixels;
}

TEST(Equiangular, HasTheMeanOfDeltaTracking) {
    const std::string sky = "LightSource \"infinite\" \"rgb L\" [.4 .5 .6]\n";
    const Case cases[] = {
        {"lamps", kEven, kLamps + std::string(kWall), "bvh", 3},
        {"points", kEven, kPoints + std::string(kWall), "uniform", 1},
        {"coloured", kColoured, kLamps + std::string(kPoints) + kWall, "power", 1},
        {"large", "\"rgb sigma_s\" [.9 .6 .4] \"rgb sigma_a\" [0 .1 .3] \"float g\" .7", kPanel, "bvh", 1},
        {"sky", kColoured, sky + kLamps, "bvh", 3},
    };
    for (const Case &c : cases) {
        const auto with = Pixels(c, true, 300, 12), without = Pixels(c, false, 400, 12);
        RunningStatistics z;
        double difference = 0, variance = 0, sum = 0, worst = 0;
        for (size_t i = 0; i < with.size(); ++i) {
            const double e2 = Sqr(with[i].StandardError()) + Sqr(without[i].StandardError());
            const double d = with[i].mean - without[i].mean;
            difference += d;
            variance += e2;
            sum += without[i].mean;
            if (e2 > 0) worst = std::max(worst, std::abs(d) / std::sqrt(e2));
        }
        // Channels of a pixel are correlated: three times the variance of independent ones is an upper bound.
        EXPECT_LT(std::abs(difference), 4 * std::sqrt(3 * variance)) << c.name << ' ' << difference / sum;
        EXPECT_LT(std::sqrt(3 * variance), .025 * sum) << c.name << ": too noisy to tell";
        EXPECT_LT(worst, 9) << c.name << ": of 432 values of Student's t with 22 degrees of freedom";
    }
}

TEST(Equiangular, ThinFogBesideAPointLightHasLessNoise) {
    const Case c{"thin", "\"rgb sigma_s\" [.02 .02 .02] \"rgb sigma_a\" [0 0 0]",
                 "LightSource \"point\" \"point3 from\" [0 0 2] \"rgb I\" [5 5 5]\n", "bvh", 1};
    auto noise = [](const std::vector<RunningStatistics> &pixels) {
        double sum = 0;
        for (const RunningStatistics &s : pixels) sum += Sqr(s.StandardError() / s.mean);
        return sum;
    };
    EXPECT_LT(noise(Pixels(c, true, 16, 8)), .15 * noise(Pixels(c, false, 16, 8)));
}

TEST(Equiangular, GridsAreRenderedAsWithoutIt) {
    const std::string head =
        "LookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" 8 \"integer "
        "yresolution\" 8\nSampler \"independent\" \"integer pixelsamples\" 4\nIntegrator \"volpath\" ";
    const std::string world =
        "WorldBegin\nLightSource \"point\" \"point3 from\" [0 2 2] \"rgb I\" [9 9 9]\nMakeNamedMedium \"m\" \"string "
        "type\" \"cloud\" \"point3 p0\" [-1 -1 -1] \"point3 p1\" [1 1 1]\nMediumInterface \"m\" \"\"\nMaterial "
        "\"interface\"\nShape \"sphere\"\n";
    const Image a = RenderText(head + "\"bool equiangular\" true\n" + world).image, b = RenderText(head + world).image;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            for (int c = 0; c < 3; ++c) ASSERT_EQ(a.Get({x, y}, c), b.Get({x, y}, c));
}

}  // namespace
}  // namespace pbrt::test
