#include "ext/lab/conclusion.h"

#include <gtest/gtest.h>

#include "bias_simulation.h"
#include "ext/lab/reference.h"
#include "support/errors.h"
#include "support/temporary_image.h"

namespace ext::lab {

namespace {

Contender Clean(std::string label, std::vector<double> errors) {
    Contender c;
    c.label = std::move(label);
    c.trimmedErrors = errors;
    c.errors = std::move(errors);
    c.bias = BiasVerdict::Clean;
    return c;
}

/// Three samplers, of which octree leads by far.
std::vector<Contender> ClearCase() {
    return {Clean("bvh", {3, 3.1, 2.9}), Clean("octree", {1, 1.02, 0.98}), Clean("uniform", {9, 9.4, 8.8})};
}

std::string All(const Conclusion &c) {
    std::string text;
    for (const std::string &s : c.Sentences()) text += s + "\n";
    return text;
}

using Words = std::vector<std::string>;
using pbrt::test::ExpectWords;

/// Expects no winner, a single reason with these words, and no sentence about a winner.
void ExpectUndecided(const Conclusion &c, const Words &reason) {
    EXPECT_FALSE(c.winner);
    EXPECT_TRUE(c.headline.starts_with("Undecided")) << c.headline;
    ASSERT_EQ(c.reasons.size(), 1u) << All(c);
    ExpectWords(c.reasons[0], reason);
    for (const char *word : {"lowest", "needs"}) EXPECT_EQ(All(c).find(word), std::string::npos) << All(c);
}

/// Expects a single remark, with these words.
void ExpectRemark(const Conclusion &c, const Words &words) {
    ASSERT_EQ(c.remarks.size(), 1u) << All(c);
    ExpectWords(c.remarks[0], words);
    ExpectWords(All(c), {"Note: " + c.remarks[0]});
}

}  // namespace

TEST(Conclusion, ASignificantLeadWins) {
    std::vector<Contender> all = ClearCase();
    all[1].speedUp = 3;
    all[1].speedUpAgainst = "bvh";
    const Conclusion c = Conclude(all, {}, {}, true);
    EXPECT_EQ(c.winner, 1u);
    EXPECT_EQ(c.lowest, 1u);
    EXPECT_TRUE(c.reasons.empty());
    EXPECT_TRUE(c.headline.starts_with("octree ")) << c.headline;
    ExpectWords(c.headline, {"equal time", "1 +- 0.012", "bvh with 3 +- 0.058", "3 times"});
    EXPECT_EQ(ToJson(c, all).at("winner"), "octree");
    EXPECT_EQ(ToJson(c, all).at("sentences").at(0), c.headline);
}

TEST(Conclusion, LeadWithinNoiseDecidesNothing) {
    std::vector<Contender> all = {Clean("bvh", {7.9, 3.5, 12}), Clean("octree", {8.3, 8.2, 8.4}),
                                  Clean("uniform", {90, 91, 89})};
    const Conclusion c = Conclude(all, {}, {}, false);
    EXPECT_EQ(c.lowest, 0u);
    ExpectUndecided(c, {"bvh over octree", "noise", "level 5 %"});
    ExpectWords(c.headline, {"bvh 7.8 +- 2.5, octree 8.3 +- 0.058, uniform 90 +- 0.58"});
    EXPECT_TRUE(ToJson(c, all).at("winner").is_null());
    EXPECT_EQ(ToJson(c, all).at("lowestError"), "bvh");
}

TEST(Conclusion, TooLittleDecidesNothing) {
    std::vector<Contender> beatsAnOracle = ClearCase();
    beatsAnOracle.resize(2);
    beatsAnOracle[0].isOracle = true;
    struct Case {
        std::vector<Contender> contenders;
        Words reason;
        bool isMeasured = true;
    };
    const Words noise = {"bvh over octree", "noise"}, oneSeed = {"One seed", "--seeds 3"}, noOther = {"no other"},
                nothing = {"Nothing"};
    const Case cases[] = {{{Clean("bvh", {2, 2.1, 2.2}), Clean("octree", {2, 2.1, 2.2})}, noise},
                          {{Clean("bvh", {2, 2, 2}), Clean("octree", {2, 2, 2})}, noise},
                          {{Clean("bvh", {9}), Clean("octree", {1})}, oneSeed},
                          // Many runs of one sampler do not help if the other has only one.
                          {{Clean("bvh", {9}), Clean("octree", {1, 1.1, 0.9})}, oneSeed},
                          {{Clean("bvh", {3, 3.1, 2.9})}, noOther},
                          {beatsAnOracle, noOther},
                          {{}, nothing, false},
                          {{Clean("bvh", {})}, nothing, false},
                          {{Clean("bvh", {std::numeric_limits<double>::quiet_NaN(), 1})}, nothing, false}};
    for (const Case &one : cases) {
        const Conclusion c = Conclude(one.contenders, {}, {}, true);
        ExpectUndecided(c, one.reason);
        EXPECT_EQ(c.lowest.has_value(), one.isMeasured) << one.reason[0];
    }
}

TEST(Conclusion, BiasedSamplerNeitherWinsNorHinders) {
    std::vector<Contender> all = ClearCase();
    all.push_back(Clean("blind", {0.1, 0.11, 0.12}));
    all.back().bias = BiasVerdict::Biased;
    const Conclusion c = Conclude(all, {}, {}, true);
    EXPECT_EQ(c.winner, 1u);
    ExpectRemark(c, {"Biased", ": blind."});
    EXPECT_EQ(c.headline.find("blind"), std::string::npos) << c.headline;
    for (Contender &s : all) s.bias = BiasVerdict::Biased;
    ExpectUndecided(Conclude(all, {}, {}, true), {"Nothing"});
}

TEST(Conclusion, UnknownBiasOfTheLeaderForbidsAWinner) {
    std::vector<Contender> all = ClearCase();
    all[1].bias = BiasVerdict::Unknown;
    ExpectUndecided(Conclude(all, {}, {}, true), {"bias", "octree"});
    // The unknown bias of a sampler that does not lead gives only a note.
    all = ClearCase();
    all[2].bias = BiasVerdict::Unknown;
    const Conclusion c = Conclude(all, {}, {}, true);
    EXPECT_EQ(c.winner, 1u);
    ExpectRemark(c, {"Bias", ": uniform."});
}

TEST(Conclusion, DoubtAboutAllOrTheLeaderForbidsAWinnerAndIsListedOnce) {
    const std::string doubt = "Text of a doubt.";
    ExpectUndecided(Conclude(ClearCase(), {{doubt, "octree"}}, {}, true), {doubt});
    const Conclusion other = Conclude(ClearCase(), {{doubt, "bvh"}}, {}, true);
    EXPECT_EQ(other.winner, 1u);
    ExpectWords(All(other), {"Doubt: " + doubt});
    const Conclusion all = Conclude(ClearCase(), {{doubt, ""}}, {}, true);
    ExpectUndecided(all, {doubt});
    EXPECT_EQ(all.doubts.size(), 1u);
    EXPECT_EQ(All(all).find(doubt), All(all).rfind(doubt));
}

TEST(Conclusion, FirefliesOfTheLeaderMustNotMakeTheLead) {
    std::vector<Contender> all = ClearCase();
    all[1].firefliesDecide = true;
    Conclusion c = Conclude(all, {}, {}, true);
    EXPECT_EQ(c.winner, 1u);
    ExpectRemark(c, {"fireflies", "octree", "trimmed"});
    all[1].trimmedErrors = {0.4, 0.41, 0.42};
    all[0].trimmedErrors = {0.3, 0.31, 0.29};
    ExpectUndecided(Conclude(all, {}, {}, true), {"fireflies", "octree", "trimmed relL2", "over bvh"});
    // Fireflies of the other samplers make these worse, not better.
    all[1].firefliesDecide = false;
    all[0].firefliesDecide = true;
    EXPECT_EQ(Conclude(all, {}, {}, true).winner, 1u);
}

TEST(Conclusion, CurvesThatContradictTheErrorsForbidAWinner) {
    std::vector<Contender> all = ClearCase();
    all[1].speedUp = 0.424;
    all[1].speedUpAgainst = "bvh";
    ExpectUndecided(Conclude(all, {}, {}, true), {"bvh", "0.424 times"});
    // In an experiment of equal samples this is no contradiction, and it is not in the headline.
    const Conclusion c = Conclude(all, {}, {}, false);
    EXPECT_EQ(c.winner, 1u);
    EXPECT_EQ(c.headline.find("0.424"), std::string::npos);
    ExpectRemark(c, {"equal time", "bvh", "octree", "0.424 times"});
}

// If all samplers are equally good, a winner is named in a share of at most kWinnerLevel of the experiments; a lead by
// a factor of 2.5 is mostly found.
TEST(Conclusion, KeepsItsLevel) {
    Rng rng(11, 8);
    const test::Noise noise = test::Lognormal(0.2);
    const int trials = 3000;
    auto draw = [&](double scale, int seeds) {
        std::vector<double> errors;
        for (int k = 0; k < seeds; ++k) errors.push_back(scale * noise(rng));
        return errors;
    };
    for (int seeds : {3, 6})
        for (int samplers : {2, 4}) {
            int alarms = 0, found = 0;
            for (int i = 0; i < trials; ++i) {
                std::vector<Contender> equal;
                for (int s = 0; s < samplers; ++s) equal.push_back(Clean(std::to_string(s), draw(1, seeds)));
                alarms += Conclude(equal, {}, {}, true).winner.has_value();
                equal[0].errors = draw(0.4, seeds);
                found += Conclude(equal, {}, {}, true).winner == std::optional<size_t>(0);
            }
            EXPECT_LE(alarms, 1.2 * kWinnerLevel * trials) << seeds << " " << samplers;
            EXPECT_GE(found, 0.7 * trials) << seeds << " " << samplers;
        }
}

namespace {

/// A reference of one colour `value`, which states the relL2 `noise`.
Reference Flat(const std::string &sampler, Float value, double noise) {
    Reference r;
    r.sampler = sampler;
    r.image = pbrt::test::RgbImage({64, 64}, [value](int, int) { return Rgb(value); });
    r.parts = {r.image, r.image};
    r.noise = noise;
    return r;
}

}  // namespace

TEST(References, DifferIfTheirNoiseDoesNotExplainIt) {
    bool proveNoBias = true;
    EXPECT_FALSE(Disagreement(Flat("a", 1, 0.01), Flat("b", 1.1f, 0.01), false, &proveNoBias));
    EXPECT_FALSE(proveNoBias);
    const std::optional<Doubt> doubt = Disagreement(Flat("a", 1, 0.01), Flat("b", 1.5f, 0.01), false, &proveNoBias);
    ASSERT_TRUE(doubt);
    EXPECT_EQ(doubt->sampler, "");
    ExpectWords(doubt->text, {"not judged alike"});
    EXPECT_FALSE(proveNoBias);
    EXPECT_TRUE(Disagreement(Flat("a", 1, 0.01), Flat("b", 1.5f, 0.01), true, &proveNoBias));
    EXPECT_TRUE(proveNoBias);
    // References whose noise is unknown agree only if they are equal.
    Reference unknown = Flat("b", 1.1f, 0);
    unknown.noise.reset();
    EXPECT_TRUE(Disagreement(Flat("a", 1, 0), unknown, false, &proveNoBias));
}

}  // namespace ext::lab
