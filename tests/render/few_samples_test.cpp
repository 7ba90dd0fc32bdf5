// The error (relL2, trimmed) of a picture of 16 samples per pixel, ours against stock pbrt-v4's, for each of its pixel
// samplers: the scenes samplers/low_spp_* of the conformance suite, which stock rendered twice.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pbrt/images/metrics.h"
#include "support/render_scene.h"

namespace pbrt::test {
namespace {

const std::string kSuite = std::string(PBRT_SOURCE_DIR) + "/tests/conformance/suite/";
constexpr int kSeeds = 12, kReferenceSamples = 512;

Image RenderFile(const std::string &sampler, int samples, int seed) {
    RenderRequest request;
    request.file = kSuite + "scenes/samplers/low_spp_" + sampler + ".pbrt";
    request.build.samplesPerPixel = samples;
    request.build.seed = seed;
    return RenderScene(request).image;
}

/// All six scenes are one; only the sampler differs.
const Image &Reference() {
    static const Image image = RenderFile("zsobol", kReferenceSamples, 1000);
    return image;
}

struct Case {
    const char *sampler;
    /// Of stock's error. All pixels of a picture share the permutations of `halton` and the scrambling of `sobol`, so
    /// that single seeds differ by 12 and 16 % in stock's construction; stock has two pictures.
    double limit;
};

class FewSamples : public testing::TestWithParam<Case> {};

TEST_P(FewSamples, HaveAtMostTheErrorOfStock) {
    const Case test = GetParam();
    double stock = 0, ours = 0;
    for (const char *end : {".exr", ".b.exr"})
        stock +=
            TrimmedRelL2(ReadImage(kSuite + "reference/samplers/low_spp_" + test.sampler + end).image, Reference()) / 2;
    for (int seed = 0; seed < kSeeds; ++seed)
        ours += TrimmedRelL2(RenderFile(test.sampler, 16, seed), Reference()) / kSeeds;
    fmt::print("{:<12} stock {:.5f}, ours {:.5f}: {:.3f} of it, at most {:.2f}\n", test.sampler, stock, ours,
               ours / stock, test.limit);
    EXPECT_LT(ours, test.limit * stock);
}

// With random digit permutations, as until 2026-11-22, halton has 1.00 +- 0.03.
INSTANTIATE_TEST_SUITE_P(Samplers, FewSamples,
                         testing::Values(Case{"halton", 0.9}, Case{"sobol", 1.3}, Case{"paddedsobol", 1.07},
                                         Case{"zsobol", 1.07}, Case{"stratified", 1.07}, Case{"independent", 1.07}),
                         [](const auto &p) { return std::string(p.param.sampler); });

}  // namespace
}  // namespace pbrt::test
