// The strategies of bdpt, one by one: each finds all light of its number of scattering events, and their shares in the
// picture add up to it.
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "pbrt/core/parallel.h"
#include "support/render_scene.h"
#include "support/scene_text.h"

namespace pbrt::test {
namespace {

constexpr int kSize = 12, kSeeds = 24;
/// Standard errors that a mean may be away: with the degrees of freedom of so many seeds, chance explains more once in
/// 4,000 comparisons or less.
constexpr double kLimit = 4.3;

struct Place {
    std::string name;
    std::string world;
    std::string camera = "LookAt 0 -2.4 1.1  0 0 .8  0 0 1 Camera 'perspective' 'float fov' 50";
    bool isFurnace = false;
};

void PrintTo(const Place &place, std::ostream *out) { *out << place.name; }

std::string StrategyScene(const Place &place, const std::string &integrator, int depth, int samples, int seed,
                          const std::string &parameters = "") {
    return SceneText()
        .Head(place.camera)
        .Filter("gaussian")
        .Film(kSize, kSize)
        .Samples(samples, fmt::format("'integer seed' {}", seed))
        .Integrator(integrator, depth, parameters)
        .World(place.world);
}
std::string Bdpt(const Place &place, int depth, int samples, int seed = 1) {
    return StrategyScene(place, "bdpt", depth, samples, seed,
                         "'bool visualizestrategies' true 'bool visualizeweights' true");
}

/// A sphere that shines on its inside, all about the camera.
const Place kFurnace{.name = "Furnace",
                     .world = Objects().AreaLight("1 1 1").Diffuse(".5 .5 .5").Add("ReverseOrientation").Sphere(1),
                     .camera = "LookAt .2 .1 0  0 1 .2  0 0 1 Camera 'perspective' 'float fov' 60",
                     .isFurnace = true};
/// A lamp behind a door that stands ajar; nothing touches, so that connections have bounds.
const std::string kDoor =
    Objects()
        .Diffuse(".7 .6 .5")
        .Quad("-2 -2 0  2 -2 0  -2 2 0  2 2 0")
        .Quad("-2 2.5 .4  2 2.5 .4  -2 2.5 2.6  2 2.5 2.6")
        .Attribute("Translate -.2 .7 .4 Rotate 12 0 0 1", Objects().Quad("-1.2 0 0  1.2 0 0  -1.2 0 1.4  1.2 0 1.4"))
        .Attribute("Translate .2 1.6 1.7 Rotate 140 1 0 0", Objects().AreaLight("9 8 6").Disk(.5));
const Place kAjar{.name = "Ajar", .world = kDoor};
const std::string kGlow = "'rgb Le' [ .2 .1 .1 ]";
const Place kSmoke{.name = "Smoke",
                   .world =
                       "MakeNamedMedium 'm' 'string type' 'homogeneous' 'rgb sigma_s' [ 1 2 3 ] "
                       "'rgb sigma_a' [ .3 .2 .1 ] 'float g' .3 " +
                       kGlow + "\n" + kDoor +
                       "AttributeBegin MediumInterface 'm' '' Material 'interface' Translate 0 0 .8\n"
                       "Shape 'sphere' 'float radius' .6 AttributeEnd\n"};
const Place kParallel{
    .name = "Parallel",
    .world = kDoor,
    .camera = "LookAt 0 -2.4 1.1  0 0 .8  0 0 1 Camera 'orthographic' 'float screenwindow' [ -1 1 -1 1 ]"};

class Strategies : public testing::TestWithParam<Place> {};

TEST_P(Strategies, TheirSharesAddUpToThePicture) {
    const Rendered rendered = RenderText(Bdpt(GetParam(), 5, 8));
    std::vector<double> sum(kSize * kSize * 3);
    int pictures = 0, black = 0;
    for (const auto &[name, image] : rendered.sideImages) {
        if (name.starts_with("strategy")) continue;
        ++pictures;
        double all = 0;
        ForEachValue(image, [&](Point2i p, int c) {
            sum[(p.y * kSize + p.x) * 3 + c] += double(image.Get(p, c));
            all += double(image.Get(p, c));
        });
        black += !(all > 0);
    }
    EXPECT_EQ(pictures, 1 + 3 + 4 + 5 + 6 + 7);
    // Where the lamp is hidden, and hardly any path to it is short.
    EXPECT_LE(black, 3);
    double largest = 0, mean = 0;
    for (double v : sum) mean += v / double(sum.size());
    ForEachValue(rendered.image, [&](Point2i p, int c) {
        const double difference = sum[(p.y * kSize + p.x) * 3 + c] - double(rendered.image.Get(p, c));
        largest = std::max(largest, std::abs(difference));
    });
    EXPECT_LT(largest, 1e-5 * std::max(mean, 1.)) << "of " << mean;
}

/// The mean of every colour of pictures of several seeds.
using Colors = std::array<RunningStatistics, 3>;
void Add(Colors &colors, const Image &image, const Image *less = nullptr) {
    for (int c = 0; c < 3; ++c)
        colors[c].Add(ChannelStatistics(image, c).mean - (less ? ChannelStatistics(*less, c).mean : 0));
}

TEST_P(Strategies, EachAloneEstimatesAllLightOfItsDepth) {
    Place place = GetParam();
    const bool isSmoke = place.world.find("Medium") != std::string::npos;
    // What media emit is found by camera paths only.
    if (const size_t glow = place.world.find(kGlow); glow != std::string::npos) place.world.erase(glow, kGlow.size());
    constexpr int kDepth = 3, kSamples = 40;
    std::map<std::string, Colors> alone;
    std::array<Colors, kDepth + 1> expected;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        for (const auto &[name, image] : RenderText(Bdpt(place, kDepth, kSamples, seed)).sideImages)
            if (name.starts_with("strategy")) Add(alone[name], image);
        Image before;  // the same paths, one scattering event shorter
        for (int depth = 0; depth <= kDepth; ++depth) {
            const Image image =
                RenderText(StrategyScene(place, isSmoke ? "volpath" : "path", depth, 2 * kSamples, 100 + seed)).image;
            Add(expected[depth], image, depth > 0 ? &before : nullptr);
            before = image;
        }
    }
    EXPECT_EQ(alone.size(), 1 + 3 + 4 + 5);
    double brightest = 0;
    for (const Colors &e : expected) brightest = std::max(brightest, e[1].mean);
    for (const auto &[name, colors] : alone) {
        const int depth = name[name.find("depth") + 5] - '0';
        for (size_t c = 0; c < 3; ++c) {
            const RunningStatistics &e = expected[depth][c];
            const double error = std::hypot(e.StandardError(), colors[c].StandardError());
            EXPECT_LT(std::abs(colors[c].mean - e.mean), kLimit * error + 1e-5 * brightest)
                << name << ": " << colors[c].mean << " for " << e.mean;
            EXPECT_LT(kLimit * error, .55 * brightest) << name << ": the test would see nothing";
        }
        if (place.isFurnace) {
            EXPECT_LT(std::abs(colors[1].mean / expected[0][1].mean - std::pow(.5, depth)),
                      kLimit * colors[1].StandardError() / expected[0][1].mean + 1e-4)
                << name;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, Strategies, testing::Values(kFurnace, kAjar, kSmoke, kParallel),
                         testing::PrintToStringParamName());

TEST(StrategyImages, AreTheSameForAnyNumberOfThreads) {
    ThreadLimit one(1);
    const Rendered expected = RenderText(Bdpt(kSmoke, 4, 4));
    ThreadLimit limit(3);
    const Rendered other = RenderText(Bdpt(kSmoke, 4, 4));
    ASSERT_EQ(expected.sideImages.size(), other.sideImages.size());
    for (size_t i = 0; i < other.sideImages.size(); ++i)
        EXPECT_TRUE(SameBits(expected.sideImages[i].second, other.sideImages[i].second)) << other.sideImages[i].first;
    EXPECT_TRUE(SameBits(expected.image, other.image));
}

TEST(StrategyImages, DoNotChangeThePictureAndLimitTheDepth) {
    const Rendered shown = RenderText(Bdpt(kAjar, 9, 4));
    EXPECT_TRUE(SameBits(shown.image, RenderText(StrategyScene(kAjar, "bdpt", 5, 4, 1)).image));
    bool warned = false;
    for (const Diagnostic &d : shown.diagnostics) warned |= d.message.find("\"maxdepth\" 5") != std::string::npos;
    EXPECT_TRUE(warned);
    EXPECT_TRUE(RenderText(StrategyScene(kAjar, "bdpt", 5, 1, 1)).sideImages.empty());
}

}  // namespace
}  // namespace pbrt::test
