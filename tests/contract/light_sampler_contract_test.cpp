// The contract of light samplers, over every registered sampler and every fixture.
#include <gtest/gtest.h>

#include <map>

#include "fixtures.h"
#include "support/sampler_laws.h"
#ifdef PBRT_CONTRACT_PLUGINS
#include "plugins.h"
#endif
#ifdef PBRT_CONTRACT_HEADER  // the header of one sampler that is tested alone
#include PBRT_CONTRACT_HEADER
#endif

namespace pbrt::test {
namespace {

const PluginRegistry &Registry() {
    static const PluginRegistry registry = [] {
        PluginRegistry r;
#if defined PBRT_CONTRACT_HEADER
        PBRT_CONTRACT_REGISTER(r);
#elif defined PBRT_CONTRACT_PLUGINS
        RegisterPlugins(r);
#else
        RegisterStockLightSamplers(r);
#endif
        return r;
    }();
    return registry;
}

/// Light that would arrive if nothing were in the way, times the receiver's cosine, for one fixed point of the light,
/// as next-event estimation finds it: without light on the far side of an opaque surface, and without skies that are
/// left to BSDF sampling.
double Unoccluded(const LightComponent &light, const LightQuery &q, const Point2 &u) {
    LightSampleContext from;
    from.p = q.p;
    from.n = q.n;
    from.ns = q.ns;
    auto s = light.SampleLi(from, u, SampledWavelengths::WholeRange(), true);
    if (!s) return 0;
    if (q.ns != Normal3(0) && !q.transmits && Dot(q.ns, s->wi) * Dot(q.ns, q.wo) <= 0) return 0;
    Float cosine = q.ns == Normal3(0) ? Float(1) : AbsDot(q.ns, s->wi);
    return cosine < Float(1e-5) ? 0 : RootMeanSquare(s->L) * double(cosine) / double(s->pdf);
}

const ContractFixture &FixtureOf(const std::string &name) {
    static std::map<std::string, std::unique_ptr<ContractFixture>> fixtures;
    std::unique_ptr<ContractFixture> &f = fixtures[name];
    for (const FixtureEntry &entry : ContractFixtures())
        if (!f && entry.name == name) f = entry.make();
    return *f;
}

/// One sampler on one fixture, and what its lights contribute: the mean over four points of each light.
struct Contest {
    SamplerSubject subject;
    Contributions contributions;
};

/// Made once per process.
const Contest &ContestOf(const std::string &samplerName, const std::string &fixtureName) {
    static std::map<std::pair<std::string, std::string>, Contest> contests;
    Contest &c = contests[{samplerName, fixtureName}];
    if (c.subject.sampler) return c;
    const ContractFixture &fixture = FixtureOf(fixtureName);
    std::unique_ptr<LightSampler> sampler =
        Registry().samplers.Find(samplerName).make(ParamSet(), fixture.lights->ByComponent());
    if (fixture.prepare) fixture.prepare(*sampler);
    c.subject = SamplerSubject(std::move(sampler), fixture.queries, *fixture.lights);
    c.contributions = ContributionsOf(c.subject, [&](size_t q, LightId id) {
        double sum = 0;
        for (Point2 u : {Point2(0.5f, 0.5f), Point2(0.1f, 0.2f), Point2(0.9f, 0.3f), Point2(0.2f, 0.9f)})
            sum += Unoccluded((*fixture.lights)[id], fixture.queries[q], u) / 4;
        return sum;
    });
    return c;
}

using Names = std::tuple<std::string, std::string>;

class LightSamplerContract : public testing::TestWithParam<Names> {
  protected:
    const SamplerSubject &S() const { return ContestOf(std::get<0>(GetParam()), std::get<1>(GetParam())).subject; }
    const Contributions &Contributed() const {
        return ContestOf(std::get<0>(GetParam()), std::get<1>(GetParam())).contributions;
    }
};

TEST_P(LightSamplerContract, PmfOfASampleIsThePmfToTheLastBit) { CheckPmfOfSamples(S()); }
TEST_P(LightSamplerContract, PmfSumsToOneUnlessNothingIsReturned) { CheckPmfSums(S()); }
TEST_P(LightSamplerContract, FrequenciesMatchThePmf) { CheckFrequencies(S()); }
TEST_P(LightSamplerContract, EveryLightThatContributesCanBeChosen) {
    size_t contributing = CheckContributingCanBeChosen(S(), Contributed());
    // A sky of one colour is left to BSDF sampling, so it contributes nothing here.
    const std::string &fixture = std::get<1>(GetParam());
    bool dark = S().ids.empty() || fixture == "AllZeroPower" || fixture == "OneSky";
    EXPECT_EQ(contributing == 0, dark) << "The fixture tests nothing.";
}
TEST_P(LightSamplerContract, RegionsAndDirectionsBelongTogether) { CheckRegions(S()); }
TEST_P(LightSamplerContract, SameAnswerFromAnyThread) { CheckSameFromAnyThread(S()); }
TEST_P(LightSamplerContract, DistributionsOfTwoVerticesKeepApart) { CheckDistributionsKeepApart(S()); }
TEST_P(LightSamplerContract, OneLightEstimatorHasTheSumOverAllLightsAsItsMean) {
    CheckOneLightEstimator(S(), Contributed());
}
TEST_P(LightSamplerContract, OneNumberReachesEveryLight) { CheckOneNumberReachesEveryLight(S()); }

class LightSamplerScales : public testing::TestWithParam<std::string> {};

TEST_P(LightSamplerScales, ProbabilitiesDoNotDependOnTheUnitOfRadiance) {
    const SamplerSubject &plain = ContestOf(GetParam(), "NarrowBands").subject;
    for (const char *fixture : {"NarrowBandsBright", "NarrowBandsDim"}) {
        const SamplerSubject &scaled = ContestOf(GetParam(), fixture).subject;
        ASSERT_EQ(scaled.pmf.size(), plain.pmf.size());
        for (size_t q = 0; q < plain.pmf.size(); ++q)
            for (size_t i = 0; i < plain.pmf[q].size(); ++i)
                EXPECT_NEAR(scaled.pmf[q][i], plain.pmf[q][i], 1e-5f + 1e-3f * plain.pmf[q][i])
                    << fixture << " place " << q << " light " << i;
    }
}

TEST_P(LightSamplerScales, ASunOfRealSizeLeavesOthersTheirShare) {
    if (GetParam() == "power" || GetParam() == "seen") GTEST_SKIP() << "chooses by power, of which the sun has all";
    if (GetParam() == "nearest") GTEST_SKIP() << "chooses by distance, which leaves the sun nearly nothing";
    const SamplerSubject &s = ContestOf(GetParam(), "SunSphere").subject;
    for (size_t q = 0; q < s.queries.size(); ++q) {
        const LightQuery &query = s.queries[q];
        // Only far from both, and where they are well above the horizon.
        if (!(LengthSquared(query.p) < 2 && query.p.y < 1)) continue;
        if (query.ns != Normal3(0) && !(query.ns.y > 0.8f && query.wo.y * query.ns.y > 0)) continue;
        EXPECT_GT(s.pmf[q][0], 0.02f) << q;
        EXPECT_GT(s.pmf[q][1], 0.02f) << q;
    }
}

INSTANTIATE_TEST_SUITE_P(All, LightSamplerScales, testing::ValuesIn(Registry().samplers.Names()),
                         [](const auto &c) { return c.param; });

std::vector<std::string> FixtureNames() {
    std::vector<std::string> names;
    for (const FixtureEntry &f : ContractFixtures()) names.push_back(f.name);
    return names;
}

#ifdef PBRT_CONTRACT_FIXTURES
/// The build runs this program once for each fixture of the list, which must name all of them.
TEST(LightSamplerContractProgram, RunsForEveryFixture) {
    std::string names;
    for (const std::string &name : FixtureNames()) names += (names.empty() ? "" : " ") + name;
    EXPECT_EQ(names, PBRT_CONTRACT_FIXTURES);
}
#endif

INSTANTIATE_TEST_SUITE_P(All, LightSamplerContract,
                         testing::Combine(testing::ValuesIn(Registry().samplers.Names()),
                                          testing::ValuesIn(FixtureNames())),
                         [](const auto &c) { return std::get<0>(c.param) + "_" + std::get<1>(c.param); });

}  // namespace
}  // namespace pbrt::test
