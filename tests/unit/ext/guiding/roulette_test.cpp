// Russian roulette with a minimum continuation probability, and learned from given contributions.
#include <gtest/gtest.h>

#include "ext/guiding/path_roulette.h"
#include "pbrt/math/rng.h"
#include "support/light_views.h"
#include "support/render_waves.h"
#include "support/structure.h"

namespace pbrt::test {
using namespace ext;
namespace {

constexpr int kSide = 64, kVertices = 4;
constexpr size_t kPaths = size_t{2} * kSide * kSide;
Point2i PixelOf(size_t path) {
    const auto pixel = int(path / 2);
    return {pixel % kSide, pixel / kSide};
}
const uint32_t kUp = PathRoulette::KindOf({0, 0, 1}, false), kDown = PathRoulette::KindOf({0, 0, -1}, false);

/// `found(p, u)`: contribution of a path from p on, which is in [-1, 1]^2 on the plane z = 0, for a cost of 2; without
/// light sampling there half of that, for a cost of 1. The two paths of a pixel have radiance 0 and 2
/// `radiance(pixel)`.
template <class Found, class Radiance>
PathRoulette LearnedRoulette(Found &&found, Radiance &&radiance) {
    PathRoulette roulette;
    roulette.BeginRecords(kPaths, kVertices);
    Rng rng(5);
    for (size_t path = 0; path < kPaths; ++path) {
        for (size_t k = 0; k < kVertices; ++k) {
            const Point3 p(2 * rng.Uniform() - 1, 2 * rng.Uniform() - 1, 0);
            const Float all = found(p, rng.Uniform());
            roulette.Record(path, k, {p, kUp, {all, 2}, {all / 2, 1}});
        }
        roulette.RecordPath(path, {path % 2 == 0 ? 0 : 2 * radiance(PixelOf(path)), 5});
    }
    roulette.Learn({kSide, kSide}, PixelOf);
    return roulette;
}
Float EvenImage(Point2i) { return 1; }

/// The continuation probability at a place, before light is sampled there.
Float ProbabilityAt(const PathRoulette &roulette, const Point3 &p, uint32_t kind, Float importance) {
    return PathRoulette::ContinuationProbability(roulette.At(p, kind).here, importance);
}

TEST(PathRoulette, FollowsTheFormula) {
    const PathRoulette roulette = LearnedRoulette([](const Point3 &, Float) { return 0.75f; }, EvenImage);
    ASSERT_TRUE(roulette.HasEstimates());
    const Point3 p(0.1f, 0.2f, 0);
    const Float importance = roulette.PixelImportance({5, 5});
    // I^2 = 1 + 0.2^2, V0 = 2 / I^2, C0 = 5, M = 0.75^2, C = 2, V = 0.
    const Float expected = PathRoulette::kVarianceCorrection * std::sqrt(0.75f * 0.75f / 2) * std::sqrt(5.f / 2);
    for (Float factor : {0.8f, 0.9f})
        EXPECT_NEAR(ProbabilityAt(roulette, p, kUp, factor * importance), factor * expected, 1e-3f);
    EXPECT_EQ(ProbabilityAt(roulette, p, kUp, 0.01f * importance), PathRoulette::kMinContinuation);
    EXPECT_EQ(ProbabilityAt(roulette, p, kUp, 100 * importance), 1);
    const Float onwards = PathRoulette::kVarianceCorrection * (0.75f / 2) * std::sqrt(5.f / 2);
    EXPECT_NEAR(roulette.At(p, kUp).onwards * importance, onwards, 1e-3f);
    // The other side has no records.
    EXPECT_EQ(ProbabilityAt(roulette, p, kDown, importance), 0);
}

TEST(PathRoulette, PathsContinueWhereContributionsAreRare) {
    const PathRoulette roulette =
        LearnedRoulette([](const Point3 &p, Float u) { return p.x > 0 ? (u < 0.1f ? 10.f : 0) : 0.1f; }, EvenImage);
    // The means are 1 and 0.1, the roots of the second moments 3.2 and 0.1.
    const Float importance = roulette.PixelImportance({5, 5});
    EXPECT_GT(ProbabilityAt(roulette, {0.5f, 0, 0}, kUp, 0.25f * importance), 0.7f);
    EXPECT_EQ(ProbabilityAt(roulette, {0.5f, 0, 0}, kUp, importance), 1);
    EXPECT_EQ(ProbabilityAt(roulette, {-0.5f, 0, 0}, kUp, importance), PathRoulette::kMinContinuation);
}

TEST(PathRoulette, PathsOfDarkPixelsContinueLonger) {
    const PathRoulette roulette = LearnedRoulette([](const Point3 &, Float) { return 0.75f; },
                                                  [](Point2i pixel) { return pixel.x < kSide / 2 ? 0.5f : 1.5f; });
    EXPECT_GT(ProbabilityAt(roulette, {0, 0, 0}, kUp, 0.7f * roulette.PixelImportance({2, 30})),
              1.3f * ProbabilityAt(roulette, {0, 0, 0}, kUp, 0.7f * roulette.PixelImportance({60, 30})));
}

TEST(PathRoulette, PathsThatWereEndedThereDoNotCountOnwards) {
    PathRoulette roulette;
    roulette.BeginRecords(kPaths, 1);
    for (size_t path = 0; path < kPaths; ++path) {
        const RouletteRecord::Segment onwards =
            path / 2 % 3 == 0 ? RouletteRecord::Segment{0.5f, 4} : RouletteRecord::Segment{};
        roulette.Record(path, 0, {{0, 0, 0}, kUp, {1, 1}, onwards});
        roulette.RecordPath(path, {path % 2 == 0 ? 0.f : 2.f, 5});
    }
    roulette.Learn({kSide, kSide}, PixelOf);
    EXPECT_NEAR(roulette.At({0, 0, 0}, kUp).onwards, PathRoulette::kVarianceCorrection * 0.25f, 1e-3f);
}

/// The importance of pixels whose 24 samples are those of `sample(k)`, the samples of a pixel being neighbours.
template <class Sample>
Float ImportanceOf(Sample &&sample) {
    PathRoulette roulette;
    constexpr size_t kSamples = 24;
    roulette.BeginRecords(kSamples * 64, 1);
    Rng rng(7);
    for (size_t path = 0; path < kSamples * 64; ++path)
        roulette.RecordPath(path, {sample(path % kSamples, rng.Uniform()), 5});
    roulette.Learn({8, 8}, [](size_t path) { return Point2i(int(path / kSamples % 8), int(path / kSamples / 8)); });
    return roulette.PixelImportance({3, 3});
}

TEST(PathRoulette, NoiseThatAPixelSamplerEvensOutMakesNoPathEnd) {
    // Dark and bright samples take turns, so that all blocks of eight are much alike; or they come by chance.
    const auto even = [](size_t k, Float u) { return (k % 2 == 0 ? 0 : 2) + 0.2f * u; };
    const auto uneven = [](size_t, Float u) { return u < 0.5f ? 0.1f : 2.1f; };
    EXPECT_GT(ImportanceOf(even), 4 * ImportanceOf(uneven));
}

TEST(PathRoulette, HasNoEstimatesWithoutContributions) {
    EXPECT_FALSE(
        LearnedRoulette([](const Point3 &, Float) { return 0.f; }, [](Point2i) { return 0.f; }).HasEstimates());
}

TEST(PathRoulette, AnUpdateWithoutContributionsDiscardsEarlierEstimates) {
    PathRoulette roulette = LearnedRoulette([](const Point3 &, Float) { return 1.f; }, EvenImage);
    roulette.BeginRecords(kPaths, kVertices);
    roulette.Learn({kSide, kSide}, PixelOf);
    EXPECT_FALSE(roulette.HasEstimates());
    EXPECT_EQ(roulette.Validate(), std::nullopt) << "a checkpoint could not be resumed";
}

TEST(PathRoulette, SidesAndGlossyPlacesAreApart) {
    std::vector<uint32_t> kinds{PathRoulette::kInMedium};
    for (const Vector3 &n : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)})
        for (const Float sign : {1.f, -1.f})
            for (const bool isGlossy : {false, true}) kinds.push_back(PathRoulette::KindOf(n * sign, isGlossy));
    std::sort(kinds.begin(), kinds.end());
    ASSERT_EQ(kinds.size(), PathRoulette::kKinds);
    for (uint32_t k = 0; k < PathRoulette::kKinds; ++k) EXPECT_EQ(kinds[k], k);
}

TEST(PathRoulette, ASavedStateIsLoadedBitByBitAndADamagedOneThrows) {
    const PathRoulette roulette =
        LearnedRoulette([](const Point3 &p, Float u) { return p.x > 0 ? u : 0.1f; }, EvenImage);
    const auto load = [](const std::string &bytes) {
        PathRoulette loaded;
        StateReader reader(bytes, "state");
        reader(loaded);
        return loaded;
    };
    const std::string state = BytesOf(roulette);
    EXPECT_EQ(BytesOf(load(state)), state);
    for (const std::string &damaged : Damaged(state)) EXPECT_THROW(load(damaged), UserError);
}

TEST(PathRoulette, IsOfUseToOtherPictures) {
    const auto left = [](Point2i pixel) { return pixel.x < kSide / 2 ? 0.5f : 1.5f; };
    const PathRoulette learned = LearnedRoulette([](const Point3 &, Float) { return 0.75f; }, left);
    for (const int side : {kSide / 4, kSide, 3 * kSide}) {
        PathRoulette other = learned;
        other.UseFor({side, side}, true);
        for (const int x : {1, kSide - 2})
            EXPECT_EQ(other.PixelImportance({x * side / kSide, side / 2}), learned.PixelImportance({x, kSide / 2}))
                << side << " " << x;
        EXPECT_EQ(ProbabilityAt(other, {0, 0, 0}, kUp, 0.1f), ProbabilityAt(learned, {0, 0, 0}, kUp, 0.1f));
    }
    PathRoulette elsewhere = learned;
    elsewhere.UseFor({30, 20}, false);
    EXPECT_EQ(elsewhere.PixelImportance({0, 0}), elsewhere.PixelImportance({29, 19}));
    // In the mean the radiance is 1; half of the tiles are darker, half brighter.
    EXPECT_GT(elsewhere.PixelImportance({0, 0}), learned.PixelImportance({60, 30}));
    EXPECT_LT(elsewhere.PixelImportance({0, 0}), learned.PixelImportance({2, 30}));
}

/// Dark walls, so that stock's roulette ends most paths; "volpath" stands for path, with the parameter.
TEST(MinContinuation, ChangesTheNoiseAndNotTheMean) {
    View view = AllViews()[0];
    view.samples = view.referenceSamples = 20;
    view.depth = 7;
    view.objects += "Material 'diffuse' 'rgb reflectance' [ .3 .2 .1 ]\n" + AllViews()[0].objects;
    for (const char *least : {"0.7", "1"}) {
        view.parameters = fmt::format("'float minsurvival' {}", least);
        CheckMean(view, "volpath", 0.11);
        EXPECT_FALSE(SameBits(RenderView(view, "volpath", 1, 16), RenderView(view, "path", 1, 16)));
    }
    view.parameters = "'float minsurvival' 0";
    EXPECT_TRUE(SameBits(RenderView(view, "volpath", 1, 16), RenderView(view, "path", 1, 16)));
}

TEST(MinContinuation, InMediaAsWell) {
    View view = ViewsNamed({"DenseAndColored"})[0];
    view.reference = "bdpt";
    view.samples = view.referenceSamples = 20;
    view.depth = 6;
    view.parameters = "'float minsurvival' 0.7";
    CheckMean(view, "volpath", 0.28);
}

}  // namespace
}  // namespace pbrt::test
