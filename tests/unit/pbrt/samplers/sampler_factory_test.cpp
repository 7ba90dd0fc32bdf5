#include <gtest/gtest.h>

#include "sampler_cases.h"
#include "support/errors.h"

namespace pbrt {
namespace {

using test::BoolParam;
using test::IntParam;
using test::Params;
using test::StringParam;

std::unique_ptr<Sampler> Make(const std::string &type, const std::vector<Param> &params, int sppOverride = 0,
                              DiagnosticSink *sink = nullptr) {
    DiagnosticSink local;
    return Samplers().Make(type, Params(type, params), SamplerContext{{16, 16}, sppOverride, 0, sink ? *sink : local});
}

std::string ErrorOf(const std::string &type, const std::vector<Param> &params) {
    return test::MessageOf([&] { Make(type, params); });
}

TEST(MakeSampler, EverySupportedNameWorksAndNoOther) {
    for (const std::string &name : Samplers().Names()) EXPECT_TRUE(Make(name, {})) << name;
    std::string unknown = ErrorOf("zsobl", {});
    for (const std::string &name : Samplers().Names()) EXPECT_NE(unknown.find(name), std::string::npos) << name;
}

TEST(MakeSampler, DefaultsAreThoseOfTheFormat) {
    for (const char *type : {"zsobol", "paddedsobol", "sobol", "halton", "stratified", "pmj02bn"})
        EXPECT_EQ(Make(type, {})->SamplesPerPixel(), 16) << type;
    EXPECT_EQ(Make("independent", {})->SamplesPerPixel(), 4);
    auto first = [](const std::string &type, const std::vector<Param> &params) {
        std::unique_ptr<Sampler> s = Make(type, params);
        s->StartPixelSample({3, 4}, 5, 6);
        return s->Get2D();
    };
    for (const char *type : {"zsobol", "paddedsobol", "sobol"}) {
        EXPECT_EQ(first(type, {}), first(type, {StringParam("randomization", "fastowen")}));
        EXPECT_NE(first(type, {}), first(type, {StringParam("randomization", "owen")}));
    }
    EXPECT_EQ(first("halton", {}), first("halton", {StringParam("randomization", "permutedigits")}));
    EXPECT_EQ(first("stratified", {}), first("stratified", {BoolParam("jitter", true)}));
    for (const std::string &type : Samplers().Names()) {
        EXPECT_EQ(first(type, {}), first(type, {IntParam("seed", 0)})) << type;
        EXPECT_NE(first(type, {}), first(type, {IntParam("seed", 1)})) << type;
    }
}

TEST(MakeSampler, SeedOfTheSceneBeatsTheGlobalOne) {
    for (const std::string &type : Samplers().Names()) {
        DiagnosticSink sink;
        auto first = [&](const std::vector<Param> &params, int defaultSeed) {
            std::unique_ptr<Sampler> s =
                Samplers().Make(type, Params(type, params), SamplerContext{{16, 16}, 0, defaultSeed, sink});
            s->StartPixelSample({3, 4}, 5, 6);
            return s->Get1D();
        };
        EXPECT_EQ(first({IntParam("seed", 7)}, 3), first({}, 7)) << type;
        EXPECT_NE(first({}, 3), first({}, 7)) << type;
    }
}

TEST(MakeSampler, SampleCountsAndOverride) {
    for (const char *type : {"zsobol", "paddedsobol", "sobol", "halton", "independent", "pmj02bn"}) {
        EXPECT_EQ(Make(type, {IntParam("pixelsamples", 32)})->SamplesPerPixel(), 32) << type;
        EXPECT_EQ(Make(type, {IntParam("pixelsamples", 12)})->SamplesPerPixel(), 12) << type;
        EXPECT_EQ(Make(type, {IntParam("pixelsamples", 12)}, 64)->SamplesPerPixel(), 64) << type;
        EXPECT_NE(ErrorOf(type, {IntParam("pixelsamples", 0)}), "") << type;
    }
    EXPECT_EQ(Make("stratified", {IntParam("xsamples", 3), IntParam("ysamples", 5)})->SamplesPerPixel(), 15);
    EXPECT_NE(ErrorOf("stratified", {IntParam("xsamples", 0)}), "");
    for (int n : {1, 7, 12, 16, 18, 97, 100}) EXPECT_EQ(Make("stratified", {}, n)->SamplesPerPixel(), n);
}

TEST(MakeSampler, OverriddenStratifiedIsAsSquareAsItCanBe) {
    // 18 samples are 6 x 3 strata; without jitter, the numbers of distinct coordinates are the numbers of columns and
    // rows.
    std::unique_ptr<Sampler> s = Make("stratified", {BoolParam("jitter", false)}, 18);
    std::vector<Float> xs, ys;
    for (int i = 0; i < 18; ++i) {
        s->StartPixelSample({0, 0}, i);
        Point2 p = s->Get2D();
        xs.push_back(p.x);
        ys.push_back(p.y);
    }
    auto distinct = [](std::vector<Float> v) {
        std::sort(v.begin(), v.end());
        return std::unique(v.begin(), v.end()) - v.begin();
    };
    EXPECT_EQ(distinct(xs), 6);
    EXPECT_EQ(distinct(ys), 3);
}

TEST(MakeSampler, WarnsAboutCountsThatAreNoPowersOfTwo) {
    for (const char *type : {"zsobol", "paddedsobol", "sobol"}) {
        DiagnosticSink quiet, loud, overridden;
        Make(type, {IntParam("pixelsamples", 8)}, 0, &quiet);
        Make(type, {IntParam("pixelsamples", 9)}, 0, &loud);
        Make(type, {IntParam("pixelsamples", 9)}, 4, &overridden);
        EXPECT_EQ(quiet.All().size(), 0u);
        ASSERT_EQ(loud.All().size(), 1u);
        EXPECT_EQ(loud.All()[0].severity, Severity::Warning);
        EXPECT_EQ(overridden.All().size(), 0u);
    }
}

TEST(MakeSampler, Pmj02bnWarnsAboutCountsThatAreNoPowersOfFour) {
    for (int n : {1, 2, 4, 8, 12, 16, 64, 100}) {
        DiagnosticSink sink;
        Make("pmj02bn", {IntParam("pixelsamples", n)}, 0, &sink);
        const bool fine = n == 1 || n == 4 || n == 16 || n == 64;
        EXPECT_EQ(sink.All().size(), fine ? 0u : 1u) << n;
        EXPECT_FALSE(sink.HasErrors());
    }
}

TEST(MakeSampler, RandomizationsAreChecked) {
    for (const char *type : {"zsobol", "paddedsobol", "sobol"}) {
        for (const char *r : {"none", "permutedigits", "owen", "fastowen"})
            EXPECT_EQ(ErrorOf(type, {StringParam("randomization", r)}), "") << type << r;
        test::ExpectWords(ErrorOf(type, {StringParam("randomization", "xor")}), {"permutedigits"});
    }
    for (const char *r : {"none", "permutedigits", "owen"})
        EXPECT_EQ(ErrorOf("halton", {StringParam("randomization", r)}), "");
    std::string halton = ErrorOf("halton", {StringParam("randomization", "fastowen")});
    test::ExpectWords(halton, {"permutedigits"});
}

TEST(MakeSampler, UnusedParametersAreErrors) {
    struct Case {
        const char *type, *foreign;
    };
    for (Case c : {Case{"independent", "xsamples"},
                   {"stratified", "pixelsamples"},
                   {"halton", "jitter"},
                   {"pmj02bn", "xsamples"},
                   {"zsobol", "samples"}}) {
        DiagnosticSink sink;
        Make(c.type, {IntParam(c.foreign, 4)}, 0, &sink);
        EXPECT_EQ(sink.ErrorCount(), 1u) << c.type;
    }
    // Sample counts that are overridden are still read, so they are not reported as unused.
    DiagnosticSink sink;
    Make("zsobol", {IntParam("pixelsamples", 4)}, 16, &sink);
    Make("stratified", {IntParam("xsamples", 4)}, 16, &sink);
    EXPECT_FALSE(sink.HasErrors());
}

}  // namespace
}  // namespace pbrt
