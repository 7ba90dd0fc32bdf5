#include <set>

#include "sampler_cases.h"
#include "support/errors.h"

namespace pbrt::test {
namespace {

std::unique_ptr<Sampler> Make(const std::string &type, const ParamSet &params = Params(), int sppOverride = 0,
                              DiagnosticSink *sink = nullptr, int seed = 0) {
    DiagnosticSink local;
    return Samplers().Make(type, params, SamplerContext{{16, 16}, sppOverride, seed, sink ? *sink : local});
}

std::string ErrorOfMaking(const std::string &type, const ParamSet &params = Params()) {
    return MessageOf([&] { Make(type, params); });
}

Point2 FirstPoint(const std::string &type, const ParamSet &params = Params(), int seed = 0) {
    std::unique_ptr<Sampler> s = Make(type, params, 0, nullptr, seed);
    s->StartPixelSample({3, 4}, 5, 6);
    return s->Get2D();
}

Params Randomized(const std::string &randomization) { return Params().String("randomization", randomization); }
Params Seed(int seed) { return Params().Integer("seed", seed); }
Params Count(int samples) { return Params().Integer("pixelsamples", samples); }

TEST(MakeSampler, EverySupportedNameWorksAndNoOther) {
    for (const std::string &name : Samplers().Names()) EXPECT_TRUE(Make(name)) << name;
    ExpectWords(ErrorOfMaking("zsobl"), Samplers().Names());
}

TEST(MakeSampler, DefaultsAreThoseOfTheFormat) {
    for (const char *type : {"zsobol", "paddedsobol", "sobol", "halton", "stratified", "pmj02bn"})
        EXPECT_EQ(Make(type)->SamplesPerPixel(), 16) << type;
    EXPECT_EQ(Make("independent")->SamplesPerPixel(), 4);
    for (const char *type : {"zsobol", "paddedsobol", "sobol"}) {
        EXPECT_EQ(FirstPoint(type), FirstPoint(type, Randomized("fastowen")));
        EXPECT_NE(FirstPoint(type), FirstPoint(type, Randomized("owen")));
    }
    EXPECT_EQ(FirstPoint("halton"), FirstPoint("halton", Randomized("permutedigits")));
    EXPECT_EQ(FirstPoint("stratified"), FirstPoint("stratified", Params().Bool("jitter", true)));
    for (const std::string &type : Samplers().Names()) {
        EXPECT_EQ(FirstPoint(type), FirstPoint(type, Seed(0))) << type;
        EXPECT_NE(FirstPoint(type), FirstPoint(type, Seed(1))) << type;
    }
}

TEST(MakeSampler, SeedOfTheSceneBeatsTheGlobalOne) {
    for (const std::string &type : Samplers().Names()) {
        EXPECT_EQ(FirstPoint(type, Seed(7), 3), FirstPoint(type, Params(), 7)) << type;
        EXPECT_NE(FirstPoint(type, Params(), 3), FirstPoint(type, Params(), 7)) << type;
    }
}

TEST(MakeSampler, SobolTakesLargeImagesAndNamesItsLimit) {
    DiagnosticSink sink;
    const auto make = [&](int samples) {
        return Samplers().Make("sobol", Count(samples), SamplerContext{{1 << 20, 5}, 0, 0, sink});
    };
    std::unique_ptr<Sampler> s = make(4096);
    s->StartPixelSample({(1 << 20) - 1, 4}, 4095);
    for (const Point2 &p : {s->GetPixel2D(), s->Get2D()}) EXPECT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
    ExpectWords(MessageOf([&] { make(8192); }), {"8192", "1048576 x 5", "2^52"});
}

TEST(MakeSampler, SampleCountsAndOverride) {
    for (const char *type : {"zsobol", "paddedsobol", "sobol", "halton", "independent", "pmj02bn"}) {
        EXPECT_EQ(Make(type, Count(32))->SamplesPerPixel(), 32) << type;
        EXPECT_EQ(Make(type, Count(12))->SamplesPerPixel(), 12) << type;
        EXPECT_EQ(Make(type, Count(12), 64)->SamplesPerPixel(), 64) << type;
        EXPECT_NE(ErrorOfMaking(type, Count(0)), "") << type;
    }
    EXPECT_EQ(Make("stratified", Params().Integer("xsamples", 3).Integer("ysamples", 5))->SamplesPerPixel(), 15);
    EXPECT_NE(ErrorOfMaking("stratified", Params().Integer("xsamples", 0)), "");
    for (int n : {1, 7, 12, 16, 18, 97, 100}) EXPECT_EQ(Make("stratified", Params(), n)->SamplesPerPixel(), n);
}

TEST(MakeSampler, OverriddenStratifiedIsAsSquareAsItCanBe) {
    // 18 samples are 6 x 3 strata; without jitter, the numbers of distinct coordinates are the numbers of columns and
    // rows.
    std::unique_ptr<Sampler> s = Make("stratified", Params().Bool("jitter", false), 18);
    std::set<Float> columns, rows;
    for (int i = 0; i < 18; ++i) {
        s->StartPixelSample({0, 0}, i);
        const Point2 p = s->Get2D();
        columns.insert(p.x);
        rows.insert(p.y);
    }
    EXPECT_EQ(columns.size(), 6u);
    EXPECT_EQ(rows.size(), 3u);
}

TEST(MakeSampler, WarnsAboutCountsThatAreNoPowersOfTwoOrFour) {
    const auto warnings = [](const char *type, int samples, int sppOverride = 0) {
        DiagnosticSink sink;
        Make(type, Count(samples), sppOverride, &sink);
        EXPECT_FALSE(sink.HasErrors());
        return sink.All().size();
    };
    for (const char *type : {"zsobol", "paddedsobol", "sobol"}) {
        EXPECT_EQ(warnings(type, 8), 0u);
        EXPECT_EQ(warnings(type, 9), 1u);
        EXPECT_EQ(warnings(type, 9, 4), 0u);
    }
    for (int n : {1, 4, 16, 64}) EXPECT_EQ(warnings("pmj02bn", n), 0u) << n;
    for (int n : {2, 8, 12, 100}) EXPECT_EQ(warnings("pmj02bn", n), 1u) << n;
}

TEST(MakeSampler, RandomizationsAreChecked) {
    for (const char *type : {"zsobol", "paddedsobol", "sobol"}) {
        for (const char *r : kRandomizations) EXPECT_EQ(ErrorOfMaking(type, Randomized(r)), "") << type << r;
        ExpectWords(ErrorOfMaking(type, Randomized("xor")), {"permutedigits"});
    }
    for (const char *r : {"none", "permutedigits", "owen"}) EXPECT_EQ(ErrorOfMaking("halton", Randomized(r)), "");
    ExpectWords(ErrorOfMaking("halton", Randomized("fastowen")), {"permutedigits"});
}

TEST(MakeSampler, UnusedParametersAreErrors) {
    for (auto [type, foreign] : {std::pair("independent", "xsamples"),
                                 {"stratified", "pixelsamples"},
                                 {"halton", "jitter"},
                                 {"pmj02bn", "xsamples"},
                                 {"zsobol", "samples"}}) {
        DiagnosticSink sink;
        Make(type, Params().Integer(foreign, 4), 0, &sink);
        EXPECT_EQ(sink.ErrorCount(), 1u) << type;
    }
    // Sample counts that are overridden are still read, so they are not reported as unused.
    DiagnosticSink sink;
    Make("zsobol", Count(4), 16, &sink);
    Make("stratified", Params().Integer("xsamples", 4), 16, &sink);
    EXPECT_FALSE(sink.HasErrors());
}

}  // namespace
}  // namespace pbrt::test
