#include "light_test_support.h"
#include "support/given_lights.h"

namespace pbrt::test {
namespace {

TEST(LightTable, KeepsOrderAndListsInfiniteLights) {
    LightTable table;
    LightId point = table.Add(Make("point", Params()));
    LightId sky = table.Add(Make("infinite", Params()));
    LightId sun = table.Add(Make("distant", Params()));
    LightId mesh = table.Add(std::make_unique<GivenLight>(std::vector<LightCandidate>(3)));
    LightId last = table.Add(Make("infinite", Params().Number("scale", 2)));
    table.Finish({0, 0, 0}, 5);
    ASSERT_EQ(table.Size(), 7u);
    ASSERT_EQ(table.LightCount(), 5u);
    EXPECT_EQ(mesh.value, 3u);
    EXPECT_EQ(last.value, 6u) << "each of the three parts must have an id";
    EXPECT_EQ(table.LightOf(LightId(5u)), 3u);
    EXPECT_EQ(table.LightOf(point), 0u);
    EXPECT_EQ(&table[LightId(5u)].Parent(), &table[mesh].Parent());
    // Only skies emit along rays that leave the scene; light selection treats the sun as infinite, too.
    std::vector<LightId> met;
    table.ForEachInfiniteEmission(Point3(0), Vector3(0, 0, 1), SampledWavelengths::SampleVisible(0.5f),
                                  [&](const SampledSpectrum &Le, LightId id) {
                                      EXPECT_GT(Le.Average(), 0);
                                      met.push_back(id);
                                  });
    EXPECT_EQ(met, (std::vector<LightId>{sky, last}));
    EXPECT_TRUE(std::ranges::equal(table.Environments(), met));
    EXPECT_TRUE(table.Candidate(sky).infinite);
    EXPECT_TRUE(table.Candidate(sun).infinite);
    EXPECT_FALSE(table.Candidate(point).infinite);
    EXPECT_FALSE(table.Candidate(sky).bounds);
    EXPECT_TRUE(table.Candidate(point).bounds);
}

/// Power in watts.
double PowerOf(const LightTable &table, uint32_t light) {
    return double(table.Candidate(LightId(light)).power) * table.Unit();
}

TEST(LightTable, PowerIsTheRootMeanSquareOfPhiOverTheVisibleRange) {
    LightTable table;
    table.Add(Make("point", Params().Rgb("I", 1, 0.2f, 0.1f)));
    table.Add(Make("point", Params().Rgb("I", 2, 0.4f, 0.2f)));
    table.Add(Make("point", Params().Number("scale", 0)));
    table.Finish({0, 0, 0}, 1);
    double square = 0;
    constexpr int kSets = 1000;
    for (int i = 0; i < kSets; ++i) {
        const auto lambda = SampledWavelengths::SampleVisible((Float(i) + 0.5f) / kSets);
        const LightPower phi = table[LightId(0u)].Phi(lambda);
        square += Sqr(phi.factor * RootMeanSquare(phi.spectrum)) / kSets;
    }
    EXPECT_NEAR(PowerOf(table, 0) / std::sqrt(square), 1, 1e-3);
    EXPECT_NEAR(PowerOf(table, 1) / PowerOf(table, 0), 2, 1e-3);
    EXPECT_EQ(table.Candidate(LightId(2u)).power, 0);
    EXPECT_FALSE(table.Candidate(LightId(2u)).bounds) << "no power, no bounds";
}

TEST(LightTable, PowerTowardsReceiversIsThatOfNearLightsAndOfWhatMeetsThem) {
    const Bounds3 receivers({-1, -1, -1}, {1, 1, 1});
    const Float near = 2 * std::sqrt(Float(3));
    LightTable table;
    auto add = [&](const char *type, Float x, Float scale) {
        return table.Add(Make(type, Params().Floats(ParamType::Point3, "from", {x, 0, 0}).Number("scale", scale)));
    };
    const LightId lamp = add("point", 1, 1), border = add("point", 0.999f * near, 1),
                  beyond = add("point", 1.001f * near, 1), far = add("point", 10 * near, 1),
                  spot = add("spot", 3 * near, 1), sun = add("point", 1e11f, 1e22f);
    table.Finish({0, 0, 0}, 2, receivers);
    auto share = [&](LightId id) {
        const LightCandidate c = table.Candidate(id);
        return double(table.PowerTowardsReceivers(c)) / double(c.power);
    };
    EXPECT_EQ(share(lamp), 1);
    EXPECT_EQ(share(border), 1);
    EXPECT_LT(share(beyond), 1);
    EXPECT_NEAR(share(beyond), 1, 0.01);
    EXPECT_NEAR(share(far), 0.009336, 1e-5);
    EXPECT_GT(share(spot), 0.6) << "its cone is narrow";
    // The sun and a lamp of the same irradiance have similar weights.
    const double ratio = double(table.PowerTowardsReceivers(table.Candidate(sun))) /
                         double(table.PowerTowardsReceivers(table.Candidate(lamp)));
    EXPECT_GT(ratio, 1);
    EXPECT_LT(ratio, 100);
    EXPECT_EQ(table.FirstTooFarForLightPaths(), sun);
    LightTable unknown;
    unknown.Add(Make("point", Params().Floats(ParamType::Point3, "from", {1e6f, 0, 0})));
    unknown.Finish({0, 0, 0}, 2);
    const LightCandidate c = unknown.Candidate(LightId(0u));
    EXPECT_EQ(unknown.PowerTowardsReceivers(c), c.power);
    EXPECT_EQ(unknown.FirstTooFarForLightPaths(), std::nullopt);
}

/// A line of 2 nm.
ParamSet Line(Float nm, Float scale) {
    return Params().Floats(ParamType::Spectrum, "I", {nm - 1, 0, nm, 1, nm + 1, 0}).Number("scale", scale);
}

TEST(LightTable, EveryLineOfTheVisibleRangeHasPower) {
    LightTable table;
    table.Add(Make("point", Params()));
    for (int nm = 380; nm <= 780; ++nm) table.Add(Make("point", Line(Float(nm), 1)));
    table.Finish({0, 0, 0}, 1);
    // Photometric scaling makes dim wavelengths strong; none may be a thousand times weaker than white light.
    for (uint32_t i = 1; i < table.Size(); ++i)
        EXPECT_GT(PowerOf(table, i), 1e-3 * PowerOf(table, 0)) << 379 + i << " nm";
}

TEST(LightTable, AnyLineThatAFilmOfAnyRangeMeetsHasPower) {
    LightTable table;
    for (int nm = 360; nm <= 830; ++nm) table.Add(Make("point", Line(Float(nm), 1)));
    table.Finish({0, 0, 0}, 1);
    // "film" "spectral" accepts ranges within that of the spectra only, and samples them uniformly.
    constexpr std::array<Float, 2> kRanges[] = {{LambdaMin, 361}, {360, 400},           {600, 600.5f},
                                                {780, LambdaMax}, {829.75f, LambdaMax}, {LambdaMin, LambdaMax}};
    for (const auto &[low, high] : kRanges)
        for (int i = 0; i < 1000; ++i) {
            const auto lambda = SampledWavelengths::SampleUniform((Float(i) + 0.5f) / 1000, low, high);
            for (uint32_t light = 0; light < table.Size(); ++light) {
                const bool emits(table[LightId(light)].Phi(lambda).spectrum);
                ASSERT_TRUE(!emits || table.Candidate(LightId(light)).power > 0) << 360 + light << " nm";
            }
        }
}

TEST(LightTable, SharesOfPowerDoNotDependOnTheUnitOfRadiance) {
    const auto shares = [](Float scale, Float radius) {
        LightTable table;
        table.Add(Make("point", Line(589, scale)));
        table.Add(Make("point", Params().Number("scale", scale / 3)));
        table.Add(Make("distant", Params().Number("scale", scale)));
        table.Add(Make("infinite", Params().Number("scale", scale)));
        table.Finish({0, 0, 0}, radius);
        std::vector<double> result;
        for (uint32_t i = 0; i < table.Size(); ++i) {
            const LightCandidate c = table.Candidate(LightId(i));
            EXPECT_TRUE(std::isfinite(c.power)) << scale << " " << radius;
            result.push_back(double(c.power) / double(table.Candidate(LightId(0u)).power));
            if (c.bounds) {
                EXPECT_GT(c.bounds->Sphere().phi, 1e-30f) << scale << " " << radius;
            }
        }
        return result;
    };
    for (Float radius : {1e-8f, 1.f, 1e8f}) {
        const std::vector<double> expected = shares(1, radius);
        for (Float scale : {1e-30f, 1e-22f, 1e22f, 1e30f}) {
            const std::vector<double> here = shares(scale, radius);
            for (size_t i = 0; i < here.size(); ++i)
                EXPECT_NEAR(here[i] / expected[i], 1, 1e-4) << scale << " " << radius << " " << i;
        }
    }
}

}  // namespace
}  // namespace pbrt::test
