#include "support/sampler_laws.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pbrt/core/parallel.h"
#include "pbrt/math/rng.h"
#include "support/statistics.h"

namespace pbrt::test {

namespace {

struct Choice {
    uint32_t light = 0, region = 0;
    Float pmf = 0;
    bool operator==(const Choice &) const = default;
    friend std::ostream &operator<<(std::ostream &out, const Choice &a) {
        return out << a.light << " (" << a.region << "): " << a.pmf;
    }
};

Choice Choose(const LightDistribution &lights, Float u) {
    std::optional<SampledLight> sample = lights.Sample(u);
    return sample ? Choice{sample->light.value, sample->region.index, sample->pmf} : Choice{};
}

/// Bernstein's inequality: an upper bound of the probability that the mean of n values, each at most `greatest` from
/// its expectation, is `off` or more from it. It holds for any distribution.
double BernsteinTail(double off, double variance, double greatest, int n) {
    return 2 * std::exp(-0.5 * n * off * off / (variance + greatest * std::abs(off) / 3 + 1e-300));
}

Float Even(int i, int n) { return (Float(i) + Float(0.5)) / Float(n); }

}  // namespace

SamplerSubject::SamplerSubject(std::unique_ptr<LightSampler> made, std::span<const LightQuery> places,
                               const LightTable &lights)
    : sampler(std::move(made)), queries(places), table(&lights) {
    for (size_t i = 0; i < lights.Size(); ++i) ids.emplace_back(i);
    strata = Calls(20000);
    for (const LightQuery &q : queries) {
        std::vector<Float> &row = pmf.emplace_back();
        double &total = sum.emplace_back(0);
        std::vector<int> &count = chosen.emplace_back(ids.size());
        LightMemory memory;
        const LightDistribution at = sampler->At(q, memory);
        for (LightId id : ids) {
            row.push_back(at.PMF(id));
            total += double(row.back());
        }
        Rng rng(31 + sum.size());
        for (int i = 0; i < strata; ++i) {
            const Float u = std::min((Float(i) + rng.Uniform()) / Float(strata), OneMinusEpsilon);
            if (std::optional<SampledLight> sample = at.Sample(u)) ++count.at(IndexOf(sample->light));
        }
    }
}

Contributions ContributionsOf(const SamplerSubject &s,
                              const std::function<double(size_t query, LightId)> &contribution) {
    Contributions rows;
    for (size_t q = 0; q < s.queries.size(); ++q) {
        std::vector<double> &row = rows.emplace_back();
        for (LightId id : s.ids) row.push_back(contribution(q, id));
    }
    return rows;
}

int SamplerSubject::Calls(int most) const {
    size_t work = std::max<size_t>(ids.size() * queries.size(), 1);
    return std::clamp(int(30000000 / work), 200, most);
}

void CheckPmfOfSamples(const SamplerSubject &s) {
    Rng rng(1);
    int n = s.Calls(500);
    LightMemory memory, other;
    for (size_t q = 0; q < s.queries.size(); ++q) {
        const LightDistribution at = s.sampler->At(s.queries[q], memory);
        for (int i = 0; i < n; ++i) {
            Float u = i == 0 ? 0 : i == 1 ? OneMinusEpsilon : rng.Uniform();
            std::optional<SampledLight> sample = at.Sample(u);
            if (!sample) continue;
            ASSERT_TRUE(std::find(s.ids.begin(), s.ids.end(), sample->light) != s.ids.end());
            ASSERT_GT(sample->pmf, 0);
            if (sample->region.portals) {
                ASSERT_LE(sample->pmf, at.PMF(sample->light)) << "query " << q << " u " << u;
                continue;
            }
            ASSERT_EQ(sample->pmf, at.PMF(sample->light))
                << "query " << q << " u " << u << " light " << sample->light.value;
            // A second weighing gives the same.
            if (i < 20) {
                ASSERT_EQ(sample->pmf, s.sampler->At(s.queries[q], other).PMF(sample->light))
                    << "query " << q << " u " << u;
            }
        }
    }
}

void CheckPmfSums(const SamplerSubject &s) {
    // A sum this near to 1 may be 1 but for rounding.
    constexpr double kRounding = 2e-6;
    int n = s.Calls(4096);
    LightMemory memory;
    double alpha = SidakAlpha(1e-5, std::max<size_t>(s.queries.size(), 1));
    for (size_t q = 0; q < s.queries.size(); ++q) {
        for (Float p : s.pmf[q]) {
            ASSERT_GE(p, 0) << "query " << q;
            ASSERT_LE(p, 1.00001f) << "query " << q;
        }
        ASSERT_LT(s.sum[q], 1 + 1e-4) << "query " << q;
        const LightDistribution at = s.sampler->At(s.queries[q], memory);
        int empty = 0;
        for (int i = 0; i < n; ++i) empty += !at.Sample(Even(i, n));
        const double missing = std::max(0.0, 1 - s.sum[q]);
        if (missing < kRounding) {
            EXPECT_EQ(empty, 0) << "query " << q;
        } else {
            EXPECT_GT(BernsteinTail(double(empty) / n - missing, missing * (1 - missing), 1, n), alpha)
                << "query " << q << ": " << empty << " of " << n << " for " << missing;
        }
    }
}

void CheckFrequencies(const SamplerSubject &s) {
    constexpr size_t kSide = 8;
    int n = s.Calls(20000);
    // If each light of a big mesh were a cell, the expected count of every cell would be near 0.
    size_t cell = std::max<size_t>((s.ids.size() + 127) / 128, 1), cells = (s.ids.size() + cell - 1) / cell;
    double alpha = SidakAlpha(1e-5, std::max<size_t>(s.queries.size(), 1));
    for (size_t q = 0; q < s.queries.size(); ++q) {
        Rng rng(17 + q);
        LightMemory memory;
        const LightDistribution at = s.sampler->At(s.queries[q], memory);
        std::vector<double> observed(cells + 1), expected(cells + 1), points(kSide * kSide);
        for (int i = 0; i < n; ++i) {
            Point2 uPoint = rng.Uniform2();
            std::optional<SampledLight> sample = at.Sample(rng.Uniform(), &uPoint);
            observed[sample ? s.IndexOf(sample->light) / cell : cells] += 1;
            ASSERT_TRUE(uPoint.x >= 0 && uPoint.x < 1 && uPoint.y >= 0 && uPoint.y < 1) << uPoint.x << " " << uPoint.y;
            points[size_t(uPoint.x * kSide) + kSide * size_t(uPoint.y * kSide)] += 1;
        }
        const std::vector<double> even(points.size(), double(n) / double(points.size()));
        EXPECT_GT(ChiSquareTest(points, even), alpha) << "points, query " << q;
        for (size_t i = 0; i < s.ids.size(); ++i) expected[i / cell] += double(s.pmf[q][i]) * n;
        // The sum of the PMF is rounded: so small a share of empty answers cannot be distinguished from none.
        double missing = 1 - s.sum[q];
        if (missing > 1e-5 || observed[cells] > 2) expected[cells] = std::max(missing, 0.0) * n;
        else observed[cells] = 0;
        EXPECT_GT(ChiSquareTest(observed, expected), alpha) << "query " << q;
    }
}

size_t CheckContributingCanBeChosen(const SamplerSubject &s, const Contributions &contributions) {
    size_t contributing = 0;
    for (size_t q = 0; q < s.queries.size(); ++q)
        for (size_t i = 0; i < s.ids.size(); ++i) {
            if (!(contributions[q][i] > 0)) continue;
            ++contributing;
            EXPECT_GT(s.pmf[q][i], 0) << "query " << q << " light " << s.ids[i].value << " contributes "
                                      << contributions[q][i];
        }
    return contributing;
}

void CheckOneLightEstimator(const SamplerSubject &s, const Contributions &contributions) {
    // What each light contributes is fixed; only the choice is random. So the estimator's variance and greatest value
    // are known.
    const int n = s.strata;
    double alpha = SidakAlpha(1e-5, std::max<size_t>(s.queries.size(), 1));
    for (size_t q = 0; q < s.queries.size(); ++q) {
        const std::vector<double> &c = contributions[q];
        double total = 0, second = 0, greatest = 0;
        for (size_t i = 0; i < s.ids.size(); ++i) {
            total += c[i];
            if (!(c[i] > 0) || !(s.pmf[q][i] > 0)) continue;
            second += c[i] * c[i] / double(s.pmf[q][i]);
            greatest = std::max(greatest, c[i] / double(s.pmf[q][i]));
        }
        if (!(total > 0)) continue;
        double sum = 0;
        for (size_t i = 0; i < s.ids.size(); ++i)
            if (s.chosen[q][i] > 0) sum += s.chosen[q][i] * c[i] / double(s.pmf[q][i]);
        double off = std::max(0.0, std::abs(sum / n - total) - 1e-5 * total);  // float rounding of the PMF
        double variance = std::max(0.0, second - total * total);
        EXPECT_GT(BernsteinTail(off, variance, std::max(greatest, total), n), alpha)
            << "query " << q << ": " << sum / n << " for " << total;
    }
}

size_t CheckRegions(const SamplerSubject &s) {
    const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    size_t chosen = 0, elsewhere = 0;
    LightMemory memory;
    for (size_t q = 0; q < s.queries.size(); ++q) {
        Rng rng(71 + q);
        const LightQuery &query = s.queries[q];
        const LightSampleContext from{query.p, query.pError, query.n, query.ns, query.time};
        const LightDistribution at = s.sampler->At(query, memory);
        for (int i = 0; i < 200; ++i) {
            const std::optional<SampledLight> sample = at.Sample(rng.Uniform());
            const Point2 u = rng.Uniform2();
            if (!sample || !sample->region.portals) continue;
            const LightComponent region = s.table->Region(sample->light, sample->region);
            const std::optional<LightLiSample> point = region.SampleLi(from, u, lambda, true);
            if (!point) continue;
            ++chosen;
            // Rounding may move a point at a border to the region next to it.
            const SampledLight back = at.Towards(sample->light, query.p, point->wi);
            if (!(back.region == sample->region)) {
                ++elsewhere;
                continue;
            }
            EXPECT_EQ(back.pmf, sample->pmf) << "query " << q;
            EXPECT_NEAR(region.PdfLi(from, point->wi, {}, {}, true) / point->pdf, 1, 0.02) << "query " << q;
        }
    }
    EXPECT_LE(elsewhere, chosen / 200 + 3);
    return chosen;
}

void CheckSameFromAnyThread(const SamplerSubject &s) {
    if (s.queries.empty()) return;
    // Several tasks for every query, so that threads meet at one place as well as work at different ones.
    constexpr size_t kTasksPerQuery = 3;
    const size_t tasks = kTasksPerQuery * s.queries.size();
    const int n = std::max(5, s.Calls(200) * 5 / int(tasks));
    auto answers = [&](size_t task) {
        std::vector<Choice> out;
        LightMemory memory;
        const LightDistribution at = s.sampler->At(s.queries[task / kTasksPerQuery], memory);
        for (int i = 0; i < n; ++i) {
            out.push_back(Choose(at, HashFloat(uint64_t(task), i)));
            if (!s.ids.empty()) out.push_back({0, 0, at.PMF(s.ids[size_t(i) % s.ids.size()])});
        }
        return out;
    };
    std::vector<std::vector<Choice>> parallel(tasks), serial;
    ThreadLimit limit(4);
    ParallelForEach(int64_t(tasks), [&](int64_t t) { parallel[size_t(t)] = answers(size_t(t)); });
    for (size_t t = 0; t < tasks; ++t) serial.push_back(answers(t));
    EXPECT_EQ(parallel, serial);
    for (size_t q = 0; q < s.queries.size(); ++q)
        for (size_t i = 0; i < s.ids.size(); i += s.ids.size() / 50 + 1)
            ASSERT_EQ(s.sampler->PMF(s.queries[q], s.ids[i]), s.pmf[q][i]) << "query " << q << " light " << i;
}

void CheckDistributionsKeepApart(const SamplerSubject &s) {
    // A path queries the distribution of its last vertex after that of the next one was made.
    const int n = std::min(s.Calls(64), 64);
    auto query = [&](const LightDistribution &lights, size_t q) {
        std::vector<Choice> out;
        for (int i = 0; i < n; ++i) {
            out.push_back(Choose(lights, HashFloat(uint64_t(q), i)));
            if (!s.ids.empty()) out.push_back({0, 0, lights.PMF(s.ids[(q + size_t(i)) % s.ids.size()])});
        }
        return out;
    };
    LightMemory memory[2], alone;
    LightDistribution at[2];
    std::vector<Choice> expected[2];
    for (size_t q = 0; q < s.queries.size(); ++q) {
        const size_t now = q & 1, before = now ^ 1;
        at[now] = s.sampler->At(s.queries[q], memory[now]);
        expected[now] = query(s.sampler->At(s.queries[q], alone), q);
        if (q > 0) {
            ASSERT_EQ(query(at[before], q - 1), expected[before]) << "query " << q - 1;
        }
        ASSERT_EQ(query(at[now], q), expected[now]) << "query " << q;
    }
}

void CheckOneNumberReachesEveryLight(const SamplerSubject &s) {
    static_assert(requires(const LightDistribution &d, Float u) {
        { d.Sample(u) } -> std::same_as<std::optional<SampledLight>>;
    });
    for (size_t q = 0; q < s.queries.size(); ++q)
        for (size_t i = 0; i < s.ids.size(); ++i)
            if (double(s.pmf[q][i]) * s.strata > 20) {
                EXPECT_GT(s.chosen[q][i], 0) << "query " << q << " light " << i;
            }
}

void CheckSame(const LightSampler &a, const LightSampler &b, std::span<const LightQuery> queries,
               const LightTable &table) {
    const size_t lights = table.Size(), step = lights / 200 + 1;
    for (size_t q = 0; q < queries.size(); ++q) {
        auto answers = [&](const LightSampler &sampler) {
            std::vector<Choice> out;
            LightMemory memory;
            const LightDistribution at = sampler.At(queries[q], memory);
            for (size_t i = q % step; i < lights; i += step) out.push_back({uint32_t(i), 0, at.PMF(LightId(i))});
            for (uint64_t i = 0; i < 20; ++i) out.push_back(Choose(at, HashFloat(i)));
            return out;
        };
        ASSERT_EQ(answers(a), answers(b)) << "query " << q;
    }
}

}  // namespace pbrt::test
