#include "ext/emission/image_contribution_light_sampler.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "support/build_text.h"
#include "support/light_views.h"
#include "support/threads.h"

namespace {

using namespace ext;
using pbrt::test::BuildText, pbrt::test::Objects, pbrt::test::SceneText;

/// Two rooms with a wall between them that lets no light through. The camera is in the first, which has a weak lamp, a
/// weaker one behind a screen that the camera sees by indirect light only, and a mirror. The second room has a strong
/// lamp.
std::string Rooms(const std::string &lamps) {
    return SceneText()
        .LookAt("0 -2.8 0  0 0 0  0 0 1")
        .Camera(60)
        .Film(32, 32)
        .Samples(64)
        .Integrator("path", 4)
        .World(Objects()
                   .Diffuse(".6 .6 .6")
                   .Triangles("-3 -3 -1  3 -3 -1  3 3 -1  -3 3 -1  -3 -3 1  3 -3 1  3 3 1  -3 3 1",
                              "0 1 2  0 2 3  4 5 6  4 6 7  0 1 5  0 5 4  2 3 7  2 7 6  1 2 6  1 6 5  3 0 4  3 4 7")
                   .Quad("-3 1 -1  3 1 -1  -3 1 1  3 1 1")
                   .Quad("1.2 -3 -1  1.2 .2 -1  1.2 -3 1  1.2 .2 1")
                   .Attribute("Material 'conductor' 'float roughness' 0",
                              Objects().Quad("-1.5 .9 -.5  -.5 .9 -.5  -1.5 .9 .5  -.5 .9 .5"))
                   .Add(lamps));
}
/// In the order of their ids.
const std::string kLamps[] = {
    Objects().Attribute("Translate -2 0 .9 Rotate 180 1 0 0", Objects().AreaLight("4 4 4").Disk(.3)),
    Objects().PointLight("-1 -1 .5", "1 1 1"), Objects().PointLight("2.2 -1 0", "1.2 1.2 1.2"),
    Objects().PointLight("0 2 0", "900 900 900")};
constexpr size_t kCount = std::size(kLamps);

std::string AllLamps() { return Rooms(std::accumulate(std::begin(kLamps), std::end(kLamps), std::string())); }

struct Prepared {
    BuiltScene built;
    std::unique_ptr<ImageContributionLightSampler> sampler;
};
Prepared Prepare(const std::string &text, const ImageContributionParams &params) {
    Prepared r{BuildText(text), nullptr};
    r.sampler = std::make_unique<ImageContributionLightSampler>(r.built.scene->Lights(), params);
    test::PrepareIn(r.built, *r.sampler);
    return r;
}

TEST(ImageContribution, EqualsTheLightInImagesOfSingleLamps) {
    const Prepared r = Prepare(AllLamps(), {.budget = 1});
    // Images of single lamps, by tiles of the prepass. The lamp itself, seen directly or in the mirror, is left out.
    std::vector<std::vector<double>> tiles;
    for (const std::string &lamp : kLamps) {
        BuildOptions options;
        options.sampledLightOnly = true;
        tiles.push_back(pbrt::test::TileMeans(pbrt::test::RenderText(Rooms(lamp), options).image, 16));
    }
    const size_t tileCount = tiles[0].size() / 3;
    std::vector<std::vector<double>> gray(kCount, std::vector<double>(tileCount));
    std::vector<double> brightness(tileCount);
    double all = 0;
    for (size_t t = 0; t < tileCount; ++t)
        for (size_t i = 0; i < kCount; ++i) {
            gray[i][t] = tiles[i][3 * t] + tiles[i][3 * t + 1] + tiles[i][3 * t + 2];
            brightness[t] += gray[i][t];
            all += gray[i][t] / double(tileCount);
        }
    ASSERT_GT(all, 0);
    std::vector<double> expected(kCount), measured;
    for (size_t i = 0; i < kCount; ++i) {
        for (size_t t = 0; t < tileCount; ++t) {
            const double relative = brightness[t] / all + 0.1;
            expected[i] += gray[i][t] / (relative * relative);
        }
        measured.push_back(r.sampler->Contributions()[i].sum);
    }
    const double s = std::accumulate(measured.begin(), measured.end(), 0.0),
                 e = std::accumulate(expected.begin(), expected.end(), 0.0);
    for (size_t i = 0; i < kCount; ++i) EXPECT_NEAR(measured[i] / s, expected[i] / e, 0.03) << kLamps[i];
    EXPECT_EQ(measured[3], 0) << "behind the wall";
    EXPECT_GT(measured[2], 0) << "by way of the walls";
}

TEST(ImageContributionLightSampler, ChoosesByTheRootOfContributionAndPower) {
    const Prepared r = Prepare(AllLamps(), {.floor = Float(0.2), .budget = Float(0.1)});
    const auto &groups = r.sampler->Groups();
    double power = 0, contribution = 0, samples = 0, once = 0;
    std::vector<double> roots;
    for (uint32_t g = 0; g < kCount; ++g) {
        power += double(groups.Candidate(g).power);
        contribution += r.sampler->Contributions()[g].sum;
        samples += r.sampler->Contributions()[g].count;
        once += r.sampler->Contributions()[g].count == 1;
    }
    const double missed = once / samples;
    for (uint32_t g = 0; g < kCount; ++g) {
        const double share = double(groups.Candidate(g).power) / power;
        roots.push_back(
            std::sqrt(share * ((1 - missed) * r.sampler->Contributions()[g].sum / contribution + missed * share)));
    }
    const double sum = std::accumulate(roots.begin(), roots.end(), 0.0);
    for (uint32_t g = 0; g < kCount; ++g) {
        const double share = double(groups.Candidate(g).power) / power;
        EXPECT_NEAR(double(r.sampler->PMF({}, LightId(g))), 0.8 * roots[g] / sum + 0.2 * share, 1e-5);
    }
    EXPECT_GT(r.sampler->PMF({}, LightId(1u)), 0.2f) << "a thousandth of the power of the lamp behind the wall";
    EXPECT_LT(r.sampler->PMF({}, LightId(3u)), 0.25f);
}

TEST(ImageContributionLightSampler, IsTheSameForAnyNumberOfThreads) {
    const auto prepare = [] {
        const Prepared r = Prepare(AllLamps(), {});
        std::vector<Float> pmf;
        for (uint32_t g = 0; g < kCount; ++g) pmf.push_back(r.sampler->PMF({}, LightId(g)));
        return pmf;
    };
    const std::vector<Float> expected = pbrt::test::OnThreads(1, prepare);
    for (int threads : {2, 5}) EXPECT_EQ(pbrt::test::OnThreads(threads, prepare), expected) << threads;
}

TEST(ImageContributionLightSampler, CanBePreparedTwice) {
    const Prepared r = Prepare(AllLamps(), {});
    const auto reported = [&] {
        nlohmann::ordered_json report;
        r.sampler->Report(report);
        report.erase("prepassSeconds");
        return report;
    };
    const nlohmann::ordered_json once = reported();
    EXPECT_GT(once.at("contributingGroups").get<int>(), 0);
    test::PrepareIn(r.built, *r.sampler);
    EXPECT_EQ(reported(), once);
}

TEST(ImageContributionLightSampler, ChoosesByPowerWithoutContributions) {
    const Prepared r = Prepare(Rooms(kLamps[3] + kLamps[3]), {});
    EXPECT_EQ(r.sampler->PMF({}, LightId(0u)), 0.5f);
    EXPECT_EQ(r.sampler->Contributions()[0].count + r.sampler->Contributions()[1].count, 0);
}

class Shooting : public testing::TestWithParam<const char *> {};

TEST_P(Shooting, DoesNotChangeTheMean) {
    using namespace pbrt::test;
    View view;
    view.objects = Objects()
                       .Sky(".1 .1 .2")
                       .PointLight("-.5 -.5 1.5", ".7 .6 .5")
                       .PointLight("0 9 1.5", "70 60 50")
                       .Attribute("Translate .6 -.4 1.7 Rotate 180 1 0 0", Objects().AreaLight("5 5 4").Disk(.25))
                       // lightpath does not see the sky behind the room, so that is covered here.
                       .Quad("-9 1.6 -9  9 1.6 -9  -9 1.6 9  9 1.6 9");
    view.samples = 40;
    view.parameters = "'string shootingsampler' 'seen'";
    const std::string integrator = GetParam();
    const bool isSppm = integrator == "sppm";
    if (isSppm) {
        view.samples = 32;
        view.parameters += " 'float radius' .106 'integer photonsperiteration' 3000";
    }
    if (integrator == "mlt") {
        view.samples = 256;
        view.renders = 9;
    }
    CheckMean(view, integrator, 0.28, isSppm ? 0.015 : 0);
    CheckThreads(view, integrator, 4);
}
INSTANTIATE_TEST_SUITE_P(All, Shooting, testing::Values("lightpath", "bdpt", "mlt", "sppm"));

}  // namespace
