// The contract of house.md section 4, over every registered sampler and every fixture.
#include <gtest/gtest.h>

#include <map>

#include "fixtures.h"
#include "pbrt/core/parallel.h"
#include "pbrt/math/rng.h"
#include "support/statistics.h"
#ifdef PBRT_CONTRACT_PLUGINS
#include "plugins.h"
#endif

namespace pbrt::test {
namespace {

const LightSamplerRegistry &Registry() {
    static const LightSamplerRegistry registry = [] {
        LightSamplerRegistry r;
#ifdef PBRT_CONTRACT_PLUGINS
        RegisterPlugins(r);
#else
        RegisterStockLightSamplers(r);
#endif
        return r;
    }();
    return registry;
}

/// One sampler on one fixture, and its PMF from every query to every light. Made once per process.
struct Subject {
    const ContractFixture *fixture = nullptr;
    std::unique_ptr<LightSampler> sampler;
    std::vector<std::vector<Float>> pmf;  ///< by query, by light
    std::vector<double> sum;              ///< by query
};

const Subject &SubjectOf(const std::string &samplerName, const std::string &fixtureName) {
    static std::map<std::string, std::unique_ptr<ContractFixture>> fixtures;
    static std::map<std::pair<std::string, std::string>, Subject> subjects;
    Subject &s = subjects[{samplerName, fixtureName}];
    if (s.sampler) return s;
    std::unique_ptr<ContractFixture> &fixture = fixtures[fixtureName];
    if (!fixture)
        for (const FixtureEntry &entry : ContractFixtures())
            if (entry.name == fixtureName) fixture = entry.make();
    s.fixture = fixture.get();
    s.sampler = Registry().Find(samplerName).make(*fixture->lights, ParamSet());
    if (fixture->prepare) fixture->prepare(*s.sampler);
    for (const LightQuery &q : fixture->queries) {
        std::vector<Float> &row = s.pmf.emplace_back();
        double &sum = s.sum.emplace_back(0);
        for (uint32_t i = 0; i < fixture->lights->Size(); ++i) {
            row.push_back(s.sampler->PMF(q, LightId(i)));
            sum += static_cast<double>(row.back());
        }
    }
    return s;
}

using Names = std::tuple<std::string, std::string>;

class LightSamplerContract : public testing::TestWithParam<Names> {
  protected:
    const Subject &S() const { return SubjectOf(std::get<0>(GetParam()), std::get<1>(GetParam())); }
    size_t LightCount() const { return S().fixture->lights->Size(); }
    size_t QueryCount() const { return S().fixture->queries.size(); }
    const LightQuery &Query(size_t i) const { return S().fixture->queries[i]; }
    std::optional<SampledLight> Sample(size_t query, Float u) const { return S().sampler->Sample(Query(query), u); }
    /// As many per query as the slowest sampler, which looks at every light, can take on this fixture.
    int Samples(int most) const {
        size_t work = std::max<size_t>(LightCount() * QueryCount(), 1);
        return std::clamp(static_cast<int>(40000000 / work), 200, most);
    }
};

TEST_P(LightSamplerContract, PmfOfASampleIsThePmfToTheLastBit) {
    Rng rng(1);
    int n = Samples(500);
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

TEST_P(LightSamplerContract, PmfSumsToOneUnlessNothingIsReturned) {
    int n = Samples(4096);
    for (size_t q = 0; q < QueryCount(); ++q) {
        for (Float p : S().pmf[q]) {
            ASSERT_GE(p, 0);
            ASSERT_LE(p, 1.00001f);
        }
        double sum = S().sum[q];
        ASSERT_LT(sum, 1 + 1e-4);
        int empty = 0;
        for (int i = 0; i < n; ++i) empty += !Sample(q, (static_cast<Float>(i) + Float(0.5)) / static_cast<Float>(n));
        // Evenly spread numbers measure the empty share to about one step per place where it begins or ends.
        double missing = std::max(0.0, 1 - sum);
        EXPECT_NEAR(static_cast<double>(empty) / n, missing, 1e-4 + 4 * std::sqrt(missing * (1 - missing) / n))
            << "query " << q;
    }
}

TEST_P(LightSamplerContract, FrequenciesMatchThePmf) {
    int n = Samples(20000);
    std::vector<double> pValues;
    for (size_t q = 0; q < QueryCount(); ++q) {
        Rng rng(17 + q);
        std::vector<double> observed(LightCount() + 1), expected(LightCount() + 1);
        for (int i = 0; i < n; ++i) {
            auto s = Sample(q, rng.Uniform());
            observed[s ? s->light.value : LightCount()] += 1;
        }
        for (size_t i = 0; i < LightCount(); ++i) expected[i] = static_cast<double>(S().pmf[q][i]) * n;
        double missing = 1 - S().sum[q];
        expected[LightCount()] = missing > 1e-5 ? missing * n : 0;
        pValues.push_back(ChiSquareTest(observed, expected));
    }
    for (size_t q = 0; q < pValues.size(); ++q)
        EXPECT_GT(pValues[q], SidakAlpha(1e-4, pValues.size())) << "query " << q;
}

/// Light that would arrive if nothing were in the way, times the receiver's cosine, for one fixed point of the light.
Float Unoccluded(const Light &light, const LightQuery &q, const Point2 &u) {
    LightSampleContext from;
    from.p = q.p;
    from.n = q.n;
    from.ns = q.ns;
    static const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    auto s = light.SampleLi(from, u, lambda, false);
    if (!s) return 0;
    Float cosine = q.ns == Normal3(0) ? Float(1) : AbsDot(q.ns, s->wi);
    return cosine < Float(1e-5) ? 0 : s->L.Average() * cosine / s->pdf;
}

TEST_P(LightSamplerContract, EveryLightThatContributesCanBeChosen) {
    int contributing = 0;
    for (size_t q = 0; q < QueryCount(); ++q)
        for (uint32_t i = 0; i < LightCount(); ++i) {
            bool contributes = false;
            for (Point2 u : {Point2(0.5f, 0.5f), Point2(0.1f, 0.2f), Point2(0.9f, 0.3f), Point2(0.2f, 0.9f)})
                contributes = contributes || Unoccluded((*S().fixture->lights)[LightId(i)], Query(q), u) > 0;
            contributing += contributes;
            if (contributes) {
                ASSERT_GT(S().pmf[q][i], 0) << "query " << q << " light " << i;
            }
        }
    bool dark = LightCount() == 0 || std::get<1>(GetParam()) == "AllZeroPower";
    EXPECT_EQ(contributing == 0, dark) << "a fixture that tests nothing";
}

TEST_P(LightSamplerContract, SameAnswerFromAnyThread) {
    auto n = static_cast<int64_t>(Samples(200));
    struct Answer {
        uint32_t light = 0;
        Float pmf = 0;
        bool operator==(const Answer &) const = default;
    };
    auto answer = [&](int64_t i) {
        auto q = static_cast<size_t>(i) % std::max<size_t>(QueryCount(), 1);
        auto s = Sample(q, HashFloat(static_cast<uint64_t>(i)));
        return s ? Answer{s->light.value, s->pmf} : Answer{};
    };
    std::vector<Answer> parallel(static_cast<size_t>(n)), serial;
    ParallelFor(n, 1, [&](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i) parallel[static_cast<size_t>(i)] = answer(i);
    });
    for (int64_t i = 0; i < n; ++i) serial.push_back(answer(i));
    EXPECT_EQ(parallel, serial);
}

TEST_P(LightSamplerContract, OneLightEstimatorHasTheSumOverAllLightsAsItsMean) {
    int n = Samples(20000);
    std::vector<double> z;
    for (size_t q = 0; q < QueryCount(); ++q) {
        // What each light contributes is fixed here; only the choice is random. So the variance is known from the PMF.
        std::vector<double> c(LightCount());
        double total = 0, second = 0;
        for (uint32_t i = 0; i < LightCount(); ++i) {
            c[i] = static_cast<double>(Unoccluded((*S().fixture->lights)[LightId(i)], Query(q), {0.5f, 0.5f}));
            total += c[i];
            if (c[i] > 0) second += c[i] * c[i] / static_cast<double>(S().pmf[q][i]);
        }
        if (!(total > 0)) continue;
        Rng rng(31 + q);
        double sum = 0;
        for (int i = 0; i < n; ++i)
            if (auto s = Sample(q, rng.Uniform())) sum += c[s->light.value] / static_cast<double>(s->pmf);
        double variance = std::max(0.0, second - total * total) / n;
        z.push_back((sum / n - total) / (std::sqrt(variance) + 1e-4 * total));
    }
    // Rare lights make the tails heavier than a normal variable's, hence not 4.
    for (double v : z) EXPECT_LT(std::abs(v), 6);
}

TEST_P(LightSamplerContract, OneNumberReachesEveryLight) {
    // Sample() is given one number and may use no other: walking through the unit interval must meet every likely
    // light.
    static_assert(std::is_same_v<decltype(&LightSampler::Sample),
                                 std::optional<SampledLight> (LightSampler::*)(const LightQuery &, Float) const>);
    int n = Samples(16384);
    for (size_t q = 0; q < QueryCount(); ++q) {
        std::vector<bool> met(LightCount());
        for (int i = 0; i < n; ++i)
            if (auto s = Sample(q, (static_cast<Float>(i) + Float(0.5)) / static_cast<Float>(n)))
                met[s->light.value] = true;
        for (size_t i = 0; i < LightCount(); ++i)
            if (static_cast<double>(S().pmf[q][i]) * n > 20) {
                EXPECT_TRUE(met[i]) << "query " << q << " light " << i;
            }
    }
}

std::vector<std::string> FixtureNames() {
    std::vector<std::string> names;
    for (const FixtureEntry &f : ContractFixtures()) names.push_back(f.name);
    return names;
}

INSTANTIATE_TEST_SUITE_P(All, LightSamplerContract,
                         testing::Combine(testing::ValuesIn(Registry().Names()), testing::ValuesIn(FixtureNames())),
                         [](const auto &c) { return std::get<0>(c.param) + "_" + std::get<1>(c.param); });

}  // namespace
}  // namespace pbrt::test
