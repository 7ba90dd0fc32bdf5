// The contract of light samplers on scenes with Prepare called, over every registered sampler, and over the stock
// samplers on mesh groups too.
#include <gtest/gtest.h>

#include <map>

#include "scene_fixtures.h"
#include "support/sampler_laws.h"
#include "support/test_name.h"
#include "support/threads.h"
#ifdef PBRT_CONTRACT_HEADER  // the header of one sampler that is tested alone
#include PBRT_CONTRACT_HEADER
#endif

namespace pbrt::test {
namespace {

const PluginRegistry &Registry() {
#ifdef PBRT_CONTRACT_HEADER
    static const PluginRegistry registry = [] {
        PluginRegistry r;
        PBRT_CONTRACT_REGISTER(r);
        return r;
    }();
    return registry;
#else
    return AllSamplers();
#endif
}

/// Every registered sampler; "name+meshlights" as well if the sampler can work on mesh groups; also with other
/// parameters where these change how the sampler works.
std::vector<std::string> SamplerLabels() {
    std::vector<std::string> labels;
    for (const std::string &name : Registry().samplers.Names()) {
        const LightSamplerRegistry::Entry &entry = Registry().samplers.Find(name);
        labels.push_back(name);
        if (entry.traits.takesGroups) labels.push_back(name + "+meshlights");
        if (name == "octree")
            labels.insert(labels.end(), {"octree:leaves=64", "octree:meshlights=false", "octree:portals=always"});
        if (name == "oracle")
            labels.insert(labels.end(), {"oracle:samples=2,floor=0.3,mis=false", "oracle:samples=4,meshlights=false"});
        if (name == "spatial") labels.push_back("spatial:voxels=4,samples=8,floor=0.1,meshlights=false");
        if (name == "neepp") labels.push_back("neepp:voxels=4,samples=3,floor=0.001,meshlights=false");
    }
    return labels;
}

/// One sampler on one fixture, and what its lights contribute.
struct Contest {
    SamplerSubject subject;
    Contributions contributions;
};

/// Made once per process.
const Contest &ContestOf(const std::string &fixtureName, const std::string &label) {
    static std::map<std::pair<std::string, std::string>, Contest> contests;
    Contest &c = contests[{fixtureName, label}];
    if (c.subject.sampler) return c;
    const SceneFixture &fixture = SceneFixtureOf(fixtureName);
    c.subject = SamplerSubject(MakePreparedSampler(label, fixture, Registry()), fixture.queries, fixture.Lights());
    c.contributions = ContributionsOf(c.subject, [&](size_t q, LightId id) { return fixture.ContributionOf(q, id); });
    return c;
}

using Names = std::tuple<std::string, std::string>;  // fixture, sampler

class SceneContract : public testing::TestWithParam<Names> {
  protected:
    const SamplerSubject &S() const { return ContestOf(std::get<0>(GetParam()), std::get<1>(GetParam())).subject; }
    const Contributions &Contributed() const {
        return ContestOf(std::get<0>(GetParam()), std::get<1>(GetParam())).contributions;
    }
    const SceneFixture &Fixture() const { return SceneFixtureOf(std::get<0>(GetParam())); }
};

TEST_P(SceneContract, PmfOfASampleIsThePmfToTheLastBit) { CheckPmfOfSamples(S()); }
TEST_P(SceneContract, PmfSumsToOneUnlessNothingIsReturned) { CheckPmfSums(S()); }
TEST_P(SceneContract, FrequenciesMatchThePmf) { CheckFrequencies(S()); }
TEST_P(SceneContract, PositiveWhereverALightContributes) {
    size_t contributing = CheckContributingCanBeChosen(S(), Contributed());
    if (!Fixture().dark) {
        EXPECT_GT(contributing, S().queries.size() / 8) << "The fixture tests nothing.";
    }
}
TEST_P(SceneContract, OneLightEstimatorHasTheSumOverAllLightsAsItsMean) { CheckOneLightEstimator(S(), Contributed()); }
TEST_P(SceneContract, RegionsAndDirectionsBelongTogether) { CheckRegions(S()); }
TEST_P(SceneContract, AnyThreadHasTheSameProbabilities) { CheckSameFromAnyThread(S()); }
TEST_P(SceneContract, DistributionsOfTwoVerticesKeepApart) { CheckDistributionsKeepApart(S()); }
TEST_P(SceneContract, OneNumberReachesEveryLight) { CheckOneNumberReachesEveryLight(S()); }
TEST_P(SceneContract, PreparedTheSameByOneThreadAndByThree) {
    const auto make = [&] { return MakePreparedSampler(std::get<1>(GetParam()), Fixture(), Registry()); };
    CheckSame(*OnThreads(1, make), *OnThreads(3, make), Fixture().queries, Fixture().Lights());
}

TEST(SceneContractProgram, EnvironmentLightsBehindPortalsAreChosenByRegions) {
    if (!Registry().samplers.Has("octree")) GTEST_SKIP() << "Only the octree finds portals.";
    for (const char *fixture : {"MirroredSkyWindow", "TwoSkies"})
        EXPECT_GT(CheckRegions(ContestOf(fixture, "octree:portals=always").subject), 100u) << fixture;
}

#ifdef PBRT_CONTRACT_SCENES
/// The build runs this program once for each scene of the list, which must name all fixtures.
TEST(SceneContractProgram, RunsForEveryFixture) {
    EXPECT_EQ(fmt::format("{}", fmt::join(SceneFixtureNames(), " ")), PBRT_CONTRACT_SCENES);
}
#endif

std::vector<Names> Subjects() {
    std::vector<Names> all;
    for (const std::string &fixture : SceneFixtureNames())
        for (const std::string &label : SamplerLabels()) {
            // One distribution over 10,000 lights per leaf takes hundreds of MB: mesh groups exist to avoid that. For
            // the oracle it takes 40,000 shadow rays per query.
            if (fixture == "MeshOf10000" &&
                (label == "octree:meshlights=false" || label == "oracle:samples=4,meshlights=false"))
                continue;
            all.emplace_back(fixture, label);
        }
    return all;
}

INSTANTIATE_TEST_SUITE_P(Scenes, SceneContract, testing::ValuesIn(Subjects()),
                         [](const auto &c) { return std::get<0>(c.param) + "_" + TestName(std::get<1>(c.param)); });

}  // namespace
}  // namespace pbrt::test
