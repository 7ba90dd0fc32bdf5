// The contract of house.md section 4 on real scenes with Prepare called, over every registered sampler, the stock ones
// on mesh groups too.
#include <gtest/gtest.h>

#include <map>

#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/core/parallel.h"
#include "pbrt/math/rng.h"
#include "plugins.h"
#include "scene_fixtures.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

const LightSamplerRegistry &Registry() {
    static const LightSamplerRegistry registry = [] {
        LightSamplerRegistry r;
        RegisterPlugins(r);
        return r;
    }();
    return registry;
}

/// Every registered sampler; "name+meshlights" where grouping can be put under it; other parameters where they make
/// another sampler of it.
std::vector<std::string> SamplerLabels() {
    std::vector<std::string> labels;
    for (const std::string &name : Registry().Names()) {
        const LightSamplerRegistry::Entry &entry = Registry().Find(name);
        labels.push_back(name);
        if (entry.makeOverCandidates && Registry().HasMeshGrouping()) labels.push_back(name + "+meshlights");
        if (name == "octree") labels.insert(labels.end(), {"octree:leaves=64", "octree:meshlights=false"});
    }
    return labels;
}

std::unique_ptr<LightSampler> MakePrepared(const std::string &label, const SceneFixture &fixture) {
    size_t plus = label.find('+');
    LightSamplerSpec spec =
        ReadLightSamplerSpec(ParamSet(), label.substr(0, plus), plus != std::string::npos, Registry());
    std::unique_ptr<LightSampler> sampler =
        Registry().Make(*spec.entry, fixture.Lights(), spec.params, spec.meshLights);
    fixture.Prepare(*sampler);
    return sampler;
}

/// One sampler on one fixture, and its PMF from every query to every light. Made once per process.
struct Subject {
    const SceneFixture *fixture = nullptr;
    std::unique_ptr<LightSampler> sampler;
    std::vector<std::vector<Float>> pmf;
    std::vector<double> sum;
};

const Subject &SubjectOf(const std::string &fixtureName, const std::string &label) {
    static std::map<std::pair<std::string, std::string>, Subject> subjects;
    Subject &s = subjects[{fixtureName, label}];
    if (s.sampler) return s;
    s.fixture = &SceneFixtureOf(fixtureName);
    s.sampler = MakePrepared(label, *s.fixture);
    for (const LightQuery &q : s.fixture->queries) {
        std::vector<Float> &row = s.pmf.emplace_back();
        double &sum = s.sum.emplace_back(0);
        for (uint32_t i = 0; i < s.fixture->Lights().Size(); ++i) {
            row.push_back(s.sampler->PMF(q, LightId(i)));
            sum += static_cast<double>(row.back());
        }
    }
    return s;
}

using Names = std::tuple<std::string, std::string>;  // fixture, sampler

class SceneContract : public testing::TestWithParam<Names> {
  protected:
    const Subject &S() const { return SubjectOf(std::get<0>(GetParam()), std::get<1>(GetParam())); }
    const SceneFixture &Fixture() const { return *S().fixture; }
    size_t LightCount() const { return Fixture().Lights().Size(); }
    size_t QueryCount() const { return Fixture().queries.size(); }
    const LightQuery &Query(size_t i) const { return Fixture().queries[i]; }
    std::optional<SampledLight> Sample(size_t query, Float u) const { return S().sampler->Sample(Query(query), u); }
    /// As many per query as the slowest sampler, which looks at every light, can take.
    int Samples(int most) const {
        size_t work = std::max<size_t>(LightCount() * QueryCount(), 1);
        return std::clamp(static_cast<int>(30000000 / work), 200, most);
    }
};

TEST_P(SceneContract, PmfOfASampleIsThePmfToTheLastBit) {
    Rng rng(1);
    int n = Samples(300);
    for (size_t q = 0; q < QueryCount(); ++q)
        for (int i = 0; i < n; ++i) {
            Float u = i == 0 ? 0 : i == 1 ? OneMinusEpsilon : rng.Uniform();
            auto s = Sample(q, u);
            if (!s) continue;
            ASSERT_LT(s->light.value, LightCount());
            ASSERT_GT(s->pmf, 0);
            ASSERT_EQ(s->pmf, S().sampler->PMF(Query(q), s->light)) << "u " << u << " light " << s->light.value;
        }
}

TEST_P(SceneContract, PmfSumsToOneUnlessNothingIsReturned) {
    int n = Samples(4096);
    for (size_t q = 0; q < QueryCount(); ++q) {
        for (Float p : S().pmf[q]) {
            ASSERT_GE(p, 0);
            ASSERT_LE(p, 1.00001f);
        }
        ASSERT_LT(S().sum[q], 1 + 1e-4) << "query " << q;
        int empty = 0;
        for (int i = 0; i < n; ++i) empty += !Sample(q, (static_cast<Float>(i) + Float(0.5)) / static_cast<Float>(n));
        double missing = std::max(0.0, 1 - S().sum[q]);
        EXPECT_NEAR(static_cast<double>(empty) / n, missing, 1e-4 + 4 * std::sqrt(missing * (1 - missing) / n))
            << "query " << q;
    }
}

TEST_P(SceneContract, FrequenciesMatchThePmf) {
    int n = Samples(10000);
    // Lights far apart in number share no cell; neighbours of a big mesh do, or every cell would be expected to be
    // empty.
    size_t cell = (LightCount() + 127) / 128;
    std::vector<double> pValues;
    for (size_t q = 0; q < QueryCount(); ++q) {
        Rng rng(17 + q);
        size_t cells = cell ? (LightCount() + cell - 1) / cell : 0;
        std::vector<double> observed(cells + 1), expected(cells + 1);
        for (int i = 0; i < n; ++i) {
            auto s = Sample(q, rng.Uniform());
            observed[s ? s->light.value / cell : cells] += 1;
        }
        for (size_t i = 0; i < LightCount(); ++i) expected[i / cell] += static_cast<double>(S().pmf[q][i]) * n;
        // The sum of the PMF is rounded: a share of empty answers this small cannot be told from none.
        double missing = 1 - S().sum[q];
        if (missing > 1e-5 || observed[cells] > 2)
            expected[cells] = std::max(missing, 0.0) * n;
        else
            observed[cells] = 0;
        pValues.push_back(ChiSquareTest(observed, expected));
    }
    for (size_t q = 0; q < pValues.size(); ++q)
        EXPECT_GT(pValues[q], SidakAlpha(1e-5, pValues.size())) << "query " << q;
}

TEST_P(SceneContract, PositiveWhereverALightContributes) {
    size_t contributing = 0;
    for (size_t q = 0; q < QueryCount(); ++q)
        for (size_t i = 0; i < LightCount(); ++i) {
            if (!(Fixture().contribution[q][i] > 0)) continue;
            ++contributing;
            EXPECT_GT(S().pmf[q][i], 0) << "query " << q << " light " << i << " contributes "
                                        << Fixture().contribution[q][i];
        }
    if (!Fixture().dark) {
        EXPECT_GT(contributing, QueryCount() / 8) << "a fixture that tests nothing";
    }
}

TEST_P(SceneContract, OneLightEstimatorHasTheSumOverAllLightsAsItsMean) {
    // What each light contributes is fixed; only the choice is random. So the estimator's variance and greatest value
    // are known, and Bernstein's inequality bounds the p-value whatever its tails.
    int n = Samples(10000);
    double alpha = SidakAlpha(1e-5, std::max<size_t>(QueryCount(), 1));
    for (size_t q = 0; q < QueryCount(); ++q) {
        const std::vector<double> &c = Fixture().contribution[q];
        double total = 0, second = 0, greatest = 0;
        for (size_t i = 0; i < LightCount(); ++i) {
            total += c[i];
            if (!(c[i] > 0) || !(S().pmf[q][i] > 0)) continue;
            second += c[i] * c[i] / static_cast<double>(S().pmf[q][i]);
            greatest = std::max(greatest, c[i] / static_cast<double>(S().pmf[q][i]));
        }
        if (!(total > 0)) continue;
        Rng rng(31 + q);
        double sum = 0;
        for (int i = 0; i < n; ++i)
            if (auto s = Sample(q, rng.Uniform())) sum += c[s->light.value] / static_cast<double>(s->pmf);
        double off = std::max(0.0, std::abs(sum / n - total) - 1e-5 * total);  // float rounding of the PMF
        double variance = std::max(0.0, second - total * total);
        double p = 2 * std::exp(-0.5 * n * off * off / (variance + std::max(greatest, total) * off / 3 + 1e-300));
        EXPECT_GT(p, alpha) << "query " << q << ": " << sum / n << " for " << total;
    }
}

TEST_P(SceneContract, SameAnswerFromAnyThread) {
    auto n = static_cast<int64_t>(Samples(200)) * 5;
    struct Answer {
        uint32_t light = 0;
        Float pmf = 0;
        bool operator==(const Answer &) const = default;
    };
    auto answer = [&](int64_t i) {
        auto s = Sample(static_cast<size_t>(i) % QueryCount(), HashFloat(static_cast<uint64_t>(i)));
        return s ? Answer{s->light.value, s->pmf} : Answer{};
    };
    std::vector<Answer> parallel(static_cast<size_t>(n)), serial;
    ThreadLimit limit(4);
    ParallelFor(n, 1, [&](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i) parallel[static_cast<size_t>(i)] = answer(i);
    });
    for (int64_t i = 0; i < n; ++i) serial.push_back(answer(i));
    EXPECT_EQ(parallel, serial);
}

TEST_P(SceneContract, PreparedTheSameByOneThreadAndByThree) {
    std::unique_ptr<LightSampler> one, three;
    {
        ThreadLimit limit(1);
        one = MakePrepared(std::get<1>(GetParam()), Fixture());
    }
    {
        ThreadLimit limit(3);
        three = MakePrepared(std::get<1>(GetParam()), Fixture());
    }
    size_t step = LightCount() / 200 + 1;
    for (size_t q = 0; q < QueryCount(); ++q) {
        for (size_t i = q % step; i < LightCount(); i += step)
            ASSERT_EQ(one->PMF(Query(q), LightId(i)), three->PMF(Query(q), LightId(i)))
                << "query " << q << " light " << i;
        for (uint64_t i = 0; i < 20; ++i) {
            auto a = one->Sample(Query(q), HashFloat(i)), b = three->Sample(Query(q), HashFloat(i));
            ASSERT_EQ(a.has_value(), b.has_value());
            if (a) {
                ASSERT_EQ(a->light, b->light);
            }
        }
    }
}

/// The build runs this program once per scene it knows.
TEST(SceneContractProgram, RunsForEveryFixture) {
    EXPECT_EQ(fmt::format("{}", fmt::join(SceneFixtureNames(), " ")), PBRT_CONTRACT_SCENES);
}

std::string Identifier(std::string s) {
    std::replace_if(
        s.begin(), s.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
    return s;
}

std::vector<Names> Subjects() {
    std::vector<Names> all;
    for (const std::string &fixture : SceneFixtureNames())
        for (const std::string &label : SamplerLabels()) {
            // One distribution over 10,000 lights per leaf takes hundreds of MB: that is what mesh groups are for.
            if (fixture == "MeshOf10000" && label == "octree:meshlights=false") continue;
            all.emplace_back(fixture, label);
        }
    return all;
}

INSTANTIATE_TEST_SUITE_P(Scenes, SceneContract, testing::ValuesIn(Subjects()),
                         [](const auto &c) { return std::get<0>(c.param) + "_" + Identifier(std::get<1>(c.param)); });

}  // namespace
}  // namespace pbrt::test
