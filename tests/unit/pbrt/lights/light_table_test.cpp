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
