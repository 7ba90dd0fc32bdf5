// The sums of films: saved, loaded, merged, and splatted to from many threads.
#include <gtest/gtest.h>

#include "film_fixtures.h"
#include "pbrt/core/parallel.h"
#include "pbrt/films/fixed_sum.h"
#include "pbrt/films/render_file.h"
#include "pbrt/math/rng.h"

namespace pbrt::test {
namespace {

/// A pseudo-random number in [0, 1) that depends on `key`.
Float HashedUniform(uint64_t key) { return Float(MixBits(key) >> 40) / Float(1 << 24); }

/// Adds the samples [first, last) of every pixel.
void AddSamples(Film &film, uint64_t first, uint64_t last) {
    for (uint64_t i = first; i < last; ++i)
        for (int y = 0; y < 3; ++y)
            for (int x = 0; x < 5; ++x) {
                const Float u = HashedUniform(100 * i + uint64_t(10 * y + x));
                FilmSample sample;
                sample.pixel = {x, y};
                sample.L = SampledSpectrum(u);
                sample.lambda = film.SampleWavelengths(HashedUniform(7 + i));
                sample.weight = u - Float(0.1);
                if (film.NeedsVisibleSurface() && u < Float(0.8)) {
                    VisibleSurface &visible = sample.visible.emplace();
                    visible.p = {u, 1 - u, 3 * u};
                    visible.n = visible.ns = Normalize(Normal3(u, 1, 1));
                    visible.uv = {u, u * u};
                    visible.dpdx = visible.dpdy = {0, 0, u};
                    visible.albedo = SampledSpectrum(u);
                    visible.lambda = sample.lambda;
                }
                film.AddSample(sample);
            }
}

/// Adds the splats [first, last) from `threads` threads, each to a pseudo-random pixel.
void AddSplats(Film &film, int64_t first, int64_t last, int threads) {
    const ThreadLimit limit(threads);
    ParallelFor(last - first, 16, [&](int64_t begin, int64_t end) {
        for (int64_t i = first + begin; i < first + end; ++i) {
            const auto key = uint64_t(i);
            const Point2i pixel(int(key % 6), int(key % 3));  // x = 5 is outside
            const Float u = HashedUniform(key);
            film.AddSplat(pixel, SampledSpectrum(std::exp(20 * u - 10)), film.SampleWavelengths(u), Float(0.3) - u);
        }
    });
}

std::string Saved(const Film &film) {
    StateWriter out;
    film.Save(out);
    return out.Joined();
}

void Load(Film &film, const std::string &state) {
    StateReader in(state, "film");
    film.Load(in);
}

void Merge(Film &film, const std::string &state) {
    StateReader in(state, "film");
    film.Merge(in);
}

std::string Bits(const Image &image) { return {static_cast<const char *>(image.Data()), image.Bytes()}; }

class EveryFilm : public ::testing::TestWithParam<std::string> {
  protected:
    static std::unique_ptr<Film> Make(const ParamSet &params = FilmSize(5, 3)) {
        return MakeFullFloat(GetParam(), params);
    }
};
INSTANTIATE_TEST_SUITE_P(Films, EveryFilm, ::testing::ValuesIn(Films().Names()), [](const auto &i) { return i.param; });

TEST_P(EveryFilm, SavedSumsContinueBitByBit) {
    auto whole = Make(), first = Make(), second = Make();
    AddSamples(*whole, 0, 20);
    AddSamples(*first, 0, 7);
    FilmSample bad;
    bad.L = SampledSpectrum(Infinity);
    bad.lambda = first->SampleWavelengths(0.5f);
    first->AddSample(bad);
    AddSamples(*second, 50, 60);  // loading discards these samples
    Load(*second, Saved(*first));
    EXPECT_EQ(second->RejectedSamples(), 1u);
    EXPECT_EQ(Saved(*second), Saved(*first));
    AddSamples(*second, 7, 20);
    EXPECT_EQ(Bits(whole->ToImage()), Bits(second->ToImage()));
    EXPECT_NE(Bits(whole->ToImage()), Bits(first->ToImage()));
}

TEST_P(EveryFilm, PartsMergedInAnyOrderHaveTheBitsOfOneFilm) {
    auto whole = Make();
    AddSamples(*whole, 0, 300);
    const std::vector<uint64_t> ends = {0, 1, 17, 130, 131, 300};
    std::vector<std::string> parts;
    for (size_t i = 0; i + 1 < ends.size(); ++i) {
        auto part = Make();
        AddSamples(*part, ends[i], ends[i + 1]);
        parts.push_back(Saved(*part));
    }
    std::sort(parts.begin(), parts.end());
    for (int order = 0; order < 20; ++order) {
        auto merged = Make();
        for (const std::string &part : parts) Merge(*merged, part);
        ASSERT_EQ(Saved(*merged), Saved(*whole)) << order;
        EXPECT_EQ(Bits(merged->ToImage()), Bits(whole->ToImage()));
        std::next_permutation(parts.begin(), parts.end());
    }
    auto lacking = Make();
    for (size_t i = 1; i < parts.size(); ++i) Merge(*lacking, parts[i]);
    EXPECT_NE(Bits(lacking->ToImage()), Bits(whole->ToImage()));
    const std::string before = Saved(*whole);
    Merge(*whole, Saved(*Make()));
    EXPECT_EQ(Saved(*whole), before) << "an empty film was added";
}

TEST_P(EveryFilm, SumsThatAreMovedAreThereOnce) {
    auto whole = Make(), first = Make(), second = Make();
    AddSamples(*whole, 0, 40);
    const auto move = [](Film &from, Film &to) {
        StateWriter writer;
        from.TakeSums(writer);
        const std::string bytes = writer.Joined();
        StateReader reader(bytes, "sums");
        to.AddSums(reader);
        EXPECT_EQ(reader.BytesLeft(), 0u);
        return bytes;
    };
    AddSamples(*first, 0, 7);
    AddSamples(*second, 7, 20);
    move(*second, *first);
    EXPECT_EQ(Saved(*second), Saved(*Make()));
    AddSamples(*second, 20, 40);
    const std::string bytes = move(*second, *first);
    EXPECT_EQ(Saved(*first), Saved(*whole));
    // Empty sums take no room; splats that only one film expects are no obstacle.
    EXPECT_LT(move(*second, *first).size(), 200u);
    second->ExpectSplats();
    AddSplats(*second, 0, 100, 1);
    const std::string splats = Saved(*second);
    auto third = Make();
    move(*second, *third);
    EXPECT_EQ(Saved(*third), splats);
    move(*first, *third);
    EXPECT_EQ(Saved(*first), Saved(*Make()));
    EXPECT_NE(Saved(*third), splats);

    for (size_t size = 0; size < bytes.size(); size += 5) {
        StateReader cut(std::string_view(bytes).substr(0, size), "sums");
        EXPECT_THROW(first->AddSums(cut), UserError) << size;
    }
    StateReader reader(bytes, "sums");
    EXPECT_THROW(Make(FilmSize(7, 3))->AddSums(reader), UserError);
}

TEST_P(EveryFilm, AFilmMadeFromItsRecipeMakesTheSamePicture) {
    FilmRecipe recipe;
    recipe.type = GetParam();
    recipe.params = FilmSize(5, 3).String("sensor", "canon_eos_5d");
    recipe.colorSpace = "rec2020";
    recipe.exposureTime = Float(0.1);
    recipe.overrides.pixelBounds = Bounds2i{{0, 0}, {5, 3}};
    auto film = recipe.Make();
    AddSamples(*film, 0, 10);
    StateWriter out;
    out(recipe);
    const std::string bytes = out.Joined();
    FilmRecipe read;
    StateReader(bytes, "recipe")(read);
    auto again = read.Make();
    Load(*again, Saved(*film));
    EXPECT_EQ(again->Metadata().colorSpace, film->Metadata().colorSpace);
    EXPECT_EQ(Bits(film->ToImage()), Bits(again->ToImage()));
    recipe.colorSpace = "srgb";
    auto other = recipe.Make();
    Load(*other, Saved(*film));
    EXPECT_NE(Bits(film->ToImage()), Bits(other->ToImage()));
}

TEST_P(EveryFilm, StateOfAnotherFilmThrowsAndChangesNothing) {
    auto film = Make();
    AddSamples(*film, 0, 3);
    const std::string state = Saved(*film);
    auto expectThrow = [&](const std::string &bad) {
        EXPECT_THROW(Load(*film, bad), UserError);
        EXPECT_THROW(Merge(*film, bad), UserError);
        EXPECT_EQ(Saved(*film), state);
    };
    expectThrow("");
    expectThrow("rgbfilm1");
    std::string older = state;
    older[7] = '2';
    expectThrow(older);
    expectThrow(state.substr(0, state.size() - 1));
    expectThrow(state.substr(0, state.size() / 2));
    expectThrow(Saved(*Make(FilmSize(3, 5))));
    for (const std::string &other : Films().Names())
        if (other != GetParam()) expectThrow(Saved(*MakeFullFloat(other, FilmSize(5, 3))));
    EXPECT_NO_THROW(Load(*film, state));
}

TEST_P(EveryFilm, SplatsAreTheSameForAnyNumberOfThreads) {
    std::string expected;
    for (int threads : {1, 2, 7}) {
        auto film = Make();
        film->ExpectSplats();
        AddSplats(*film, 0, 6000, threads);
        film->AddSplatPaths(16);
        if (expected.empty()) expected = Saved(*film);
        EXPECT_EQ(Saved(*film), expected) << threads;
    }
    // The splats are rendered in parts, which are saved and merged in any order, together with samples.
    auto whole = Make(), first = Make(), second = Make(), onlySamples = Make();
    AddSamples(*whole, 0, 4);
    AddSamples(*onlySamples, 0, 4);
    Load(*whole, expected);
    EXPECT_EQ(Saved(*whole), expected);
    for (Film *film : {first.get(), second.get()}) film->ExpectSplats();
    AddSplats(*first, 0, 2500, 2);
    first->AddSplatPaths(6);
    AddSplats(*second, 2500, 6000, 3);
    second->AddSplatPaths(10);
    Merge(*first, Saved(*second));
    EXPECT_EQ(Saved(*first), expected);
    Merge(*onlySamples, expected);
    Merge(*second, Saved(*onlySamples));
    EXPECT_GT(Saved(*onlySamples).size(), Saved(*Make()).size());
}

/// The channels of light of a film.
std::vector<int> LightChannels(const Image &image) {
    std::vector<int> channels;
    for (int c = 0; c < image.ChannelCount(); ++c)
        if (const std::string &name = image.Channels()[c];
            name == "R" || name == "G" || name == "B" || name.starts_with("S0"))
            channels.push_back(c);
    return channels;
}

TEST_P(EveryFilm, ThePictureHasTheMeanOfSplatsBesideThatOfSamples) {
    auto film = Make(), twice = Make();
    film->ExpectSplats();
    twice->ExpectSplats();
    constexpr int kSamples = 400, kPixels = 15;
    for (int i = 0; i < kSamples; ++i) {
        FilmSample sample;
        sample.pixel = {1, 1};
        sample.lambda = film->SampleWavelengths((Float(i) + Float(0.5)) / kSamples);
        sample.L = ColorSpace::SRGB().Illuminant().Sample(sample.lambda) / CieYIntegral;
        film->AddSample(sample);
        twice->AddSample(sample);
        // Two splats per sample, each of twice the radiance and weight 1/2: together they add twice what the samples
        // give.
        for (int k = 0; k < 2; ++k) twice->AddSplat({1, 1}, sample.L * 2.0f, sample.lambda, Float(0.5));
        film->AddSplat({2, 1}, sample.L, sample.lambda, 1);
    }
    twice->AddSplatPaths(kPixels * kSamples);
    film->AddSplatPaths(kPixels * kSamples);
    const Image one = film->ToImage(), three = twice->ToImage();
    for (const int c : LightChannels(one)) {
        const std::string &name = one.Channels()[c];
        EXPECT_GT(one.Get({1, 1}, c), 0.01f) << name;
        EXPECT_NEAR(three.Get({1, 1}, c) / one.Get({1, 1}, c), 3, 1e-2f) << name;
        EXPECT_NEAR(one.Get({2, 1}, c) / one.Get({1, 1}, c), 1, 1e-2f) << name;
        EXPECT_EQ(one.Get({3, 1}, c), 0) << name;
    }
}

/// A sample and a splat of radiance L in neighbouring pixels, as a picture of these pixels only.
Image SampleBesideSplat(const std::string &type, const ParamSet &params, Float L) {
    FilmContext context{.outputSpace = ColorSpace::SRGB()};
    context.overrides.pixelBounds = Bounds2i{{1, 1}, {3, 2}};
    auto film = MakeFullFloat(type, params, context);
    film->ExpectSplats();
    const SampledWavelengths lambda = film->SampleWavelengths(Float(0.4));
    FilmSample sample;
    sample.pixel = {1, 1};
    sample.L = lambda.Pdf() * L;
    sample.lambda = lambda;
    film->AddSample(sample);
    for (int i = 0; i < 2; ++i) film->AddSplat({2, 1}, sample.L, lambda, 1);
    film->AddSplatPaths(2 * 15);
    EXPECT_EQ(film->RejectedSamples(), 0u);
    return film->ToImage();
}

TEST_P(EveryFilm, SplatsAreCutAsSamplesAre) {
    const Image whole = SampleBesideSplat(GetParam(), FilmSize(5, 3), 100),
                cut = SampleBesideSplat(GetParam(), FilmSize(5, 3).Number("maxcomponentvalue", 2), 100),
                below = SampleBesideSplat(GetParam(), FilmSize(5, 3).Number("maxcomponentvalue", 1e4f), 100);
    for (const int c : LightChannels(whole)) {
        EXPECT_EQ(below.Get({1, 0}, c), whole.Get({1, 0}, c)) << c;
        EXPECT_LE(std::abs(cut.Get({1, 0}, c)), std::abs(whole.Get({1, 0}, c))) << c;
        if (whole.Channels()[c].starts_with("S0")) continue;  // samples and splats divide otherwise
        EXPECT_FLOAT_EQ(cut.Get({1, 0}, c), cut.Get({0, 0}, c)) << c;
        EXPECT_FLOAT_EQ(whole.Get({1, 0}, c), whole.Get({0, 0}, c)) << c;
        EXPECT_LT(std::abs(cut.Get({1, 0}, c)), Float(0.5) * std::abs(whole.Get({1, 0}, c))) << c;
    }
}

TEST_P(EveryFilm, SplatsKeepTheRangeOfSamples) {
    const Image unit = SampleBesideSplat(GetParam(), FilmSize(5, 3), 1);
    for (const int exponent : {-110, -100, 100, 110}) {
        const Image scaled = SampleBesideSplat(GetParam(), FilmSize(5, 3), std::ldexp(Float(1), exponent));
        for (const int c : LightChannels(unit)) {
            const double back = std::ldexp(double(scaled.Get({1, 0}, c)), -exponent);
            EXPECT_NEAR(back, double(unit.Get({1, 0}, c)), 1e-6 * std::abs(double(unit.Get({1, 0}, c))))
                << exponent << ", channel " << c;
        }
    }
}

TEST_P(EveryFilm, SplatsThatCannotBeAddedAreDroppedAndCounted) {
    auto film = Make();
    film->ExpectSplats();
    const std::string before = Saved(*film);
    const SampledWavelengths lambda = film->SampleWavelengths(0.4f);
    film->AddSplat({-1, 0}, SampledSpectrum(1), lambda, 1);  // a splat outside of the film is not counted
    EXPECT_EQ(Saved(*film), before);
    film->AddSplat({0, 0}, SampledSpectrum(Infinity), lambda, 1);
    film->AddSplat({0, 0}, SampledSpectrum(1e38f), lambda, 1);  // not finite after division by the density
    film->AddSplat({0, 0}, SampledSpectrum(1), lambda, std::numeric_limits<Float>::quiet_NaN());
    EXPECT_EQ(film->RejectedSamples(), 3u);
    film->AddSplatPaths(1);
    EXPECT_EQ(film->ToImage().Get({0, 0}, 0), 0);
}

TEST(FixedSum, HoldsItsRangeToItsPrecision) {
    const double most = FixedSum::kMaxAddend, step = 0x1p-144;
    for (double x : {0.0, 1.0, -1.0, 1e-30, -1e-30, 3.7e-38, 0.1, -12345.678, 1e30, -1e30, 3.4e38, 0.4 * step,
                     -0.6 * step, 1.5 * step, 1e-60, 1e-310, most, -most}) {
        ASSERT_TRUE(FixedSum::Holds(x));
        FixedSum sum;
        sum.Add(x);
        EXPECT_NEAR(sum.Value(), x, 0.5 * step + 1e-15 * std::abs(x));
        sum.Add(-x);
        EXPECT_EQ(sum, FixedSum()) << x;
    }
    EXPECT_FALSE(FixedSum::Holds(2 * most));
    EXPECT_FALSE(FixedSum::Holds(double{Infinity}));
    EXPECT_FALSE(FixedSum::Holds(std::numeric_limits<double>::quiet_NaN()));
    // Carries go from word to word in both directions; sums of doubles would lose the small number.
    FixedSum sum, other;
    for (int i = 0; i < 1000; ++i) sum.Add(most);
    sum.Add(-3e-36);
    for (int i = 0; i < 999; ++i) sum.Add(-most);
    other.Add(-most);
    sum += other;
    EXPECT_NEAR(sum.Value(), -3e-36, step);
    for (int i = 0; i < (1 << 20); ++i) sum.Add(most);
    EXPECT_DOUBLE_EQ(sum.Value(), most * (1 << 20));
}

/// Numbers of all sizes and both signs, added from threads, in another order, and as sums of parts.
TEST(FixedSum, HasTheSameBitsInAnyOrder) {
    constexpr int64_t kCount = 20000;
    const auto number = [](int64_t i) {
        const auto key = uint64_t(i);
        return std::ldexp(double(HashedUniform(3 * key) - Float(0.5)), int(280 * HashedUniform(3 * key + 1)) - 140);
    };
    FixedSum forward, backward, threads, parts;
    for (int64_t i = 0; i < kCount; ++i) forward.Add(number(i));
    for (int64_t i = kCount; i-- > 0;) backward.Add(number(i));
    {
        const ThreadLimit limit(4);
        ParallelFor(kCount, 16, [&](int64_t begin, int64_t end) {
            for (int64_t i = begin; i < end; ++i) threads.Add(number(i));
        });
    }
    for (int64_t i = 0; i < kCount;) {
        FixedSum part;
        for (const int64_t end = std::min(kCount, i + 1 + i % 700); i < end; ++i) part.Add(number(i));
        parts += part;
    }
    EXPECT_EQ(forward, backward);
    EXPECT_EQ(forward, threads);
    EXPECT_EQ(forward, parts);
    for (int64_t i = 0; i < kCount; ++i) backward.Add(-number(i));
    EXPECT_EQ(backward, FixedSum());
    EXPECT_NE(forward, FixedSum());
}

}  // namespace
}  // namespace pbrt::test
