#include "pbrt/images/metrics.h"

#include <cmath>

#include "image_fixtures.h"

namespace pbrt::test {

namespace {
constexpr Metric kMetrics[] = {Metric::MAE,      Metric::MSE,   Metric::MRSE, Metric::RelL2,
                               Metric::RelL2Abs, Metric::SMAPE, Metric::FLIP, Metric::HdrFLIP};
}  // namespace

TEST(ImageError, MatchesHandComputedValues) {
    const Image image = Row({1, 0, 3}), reference = Row({2, 0, 1});
    EXPECT_NEAR(ImageError(image, reference, Metric::MAE), (1 + 0 + 2) / 3.0, 1e-12);
    EXPECT_NEAR(ImageError(image, reference, Metric::MSE), (1 + 0 + 4) / 3.0, 1e-12);
    EXPECT_NEAR(ImageError(image, reference, Metric::MRSE), (1 / (2.01 * 2.01) + 4 / (1.01 * 1.01)) / 3, 1e-12);
    EXPECT_NEAR(ImageError(image, reference, Metric::RelL2), (1 / 4.01 + 4 / 1.01) / 3, 1e-12);
    EXPECT_NEAR(ImageError(image, reference, Metric::SMAPE), (1 / 1.51 + 2 / 2.01) / 3, 1e-12);
}

TEST(ImageError, IsZeroOnlyForEqualImages) {
    const Image image = NoiseImage(PixelFormat::Float, {9, 7}, kRgb);
    Image other = image;
    for (Metric metric : kMetrics) EXPECT_EQ(ImageError(image, other, metric), 0);
    other.Set({8, 6}, 2, other.Get({8, 6}, 2) + 0.25f);
    for (Metric metric : kMetrics) EXPECT_GT(ImageError(image, other, metric), 0);
}

TEST(ImageError, LeavesOutWhatIsNotFiniteAndCountsIt) {
    size_t skipped = 0;
    Image terms;
    EXPECT_NEAR(ImageError(Row({1, NAN, INFINITY, 2}), Row({0, 0, 0, 0}), Metric::MSE, &terms, &skipped), 2.5, 1e-12);
    EXPECT_EQ(skipped, 2u);
    EXPECT_EQ(terms.Get({0, 0}, 0), 1);
    EXPECT_EQ(terms.Get({3, 0}, 0), 4);
    EXPECT_FALSE(std::isfinite(terms.Get({1, 0}, 0)));
}

TEST(ImageError, ThrowsIfImagesDoNotMatch) {
    EXPECT_THROW(ImageError(Row({1, 2}), Row({1}), Metric::MSE), UserError);
    EXPECT_THROW(ImageError(Row({1}), Image(PixelFormat::Float, {1, 1}, {"R"}), Metric::MSE), UserError);
}

TEST(ImageError, SmapeIsSymmetricAndAtMostTwo) {
    const Image a = Row({1, 5, -2, 0}), b = Row({3, 0, 2, 1e6f});
    EXPECT_DOUBLE_EQ(ImageError(a, b, Metric::SMAPE), ImageError(b, a, Metric::SMAPE));
    EXPECT_LT(ImageError(Row({1e6f}), Row({0}), Metric::SMAPE), 2);
    EXPECT_GT(ImageError(Row({1e6f}), Row({0}), Metric::SMAPE), 1.99);
}

TEST(ImageError, RelL2DoesNotDependOnTheExposure) {
    const Image image = NoiseImage(PixelFormat::Float, {40, 30}, kRgba);
    Image reference = image;
    ForEachPixel(image, [&](Point2i p) { reference.Set(p, p.x % 3, 0.7f * image.Get({p.y, p.x % 30}, p.y % 3)); });
    const double error = ImageError(image, reference, Metric::RelL2), trimmed = TrimmedRelL2(image, reference);
    EXPECT_GT(trimmed, 0.01);
    for (const Float exposure : {1e-12f, 0.01f, 100.f, 1e12f}) {
        auto exposed = [&](Image i) {
            ForEachPixel(i, [&](Point2i p) {
                for (int c = 0; c < 3; ++c) i.Set(p, c, i.Get(p, c) * exposure);
            });
            return i;
        };
        EXPECT_NEAR(ImageError(exposed(image), exposed(reference), Metric::RelL2) / error, 1, 1e-5) << exposure;
        EXPECT_NEAR(TrimmedRelL2(exposed(image), exposed(reference)) / trimmed, 1, 1e-5) << exposure;
    }
}

TEST(ImageError, EpsilonOfRelL2IsRelativeToTheMeanOfTheReference) {
    const Image image = Row({11, 20}), reference = Row({10, -30});  // mean magnitude 20: epsilon 4
    EXPECT_NEAR(ImageError(image, reference, Metric::RelL2), (1 / 104. + 2500 / 904.) / 2, 1e-12);
    EXPECT_NEAR(ImageError(image, reference, Metric::RelL2Abs), (1 / 100.01 + 2500 / 900.01) / 2, 1e-12);
    EXPECT_NEAR(TrimmedRelL2(image, reference, 0.1, Metric::RelL2Abs), 1 / 100.01, 1e-12);
    // A black reference has no scale.
    EXPECT_NEAR(ImageError(Row({0.5f, 0}), Row({0, 0}), Metric::RelL2), 0.25 / 0.01 / 2, 1e-12);
    EXPECT_EQ(ImageError(Row({0, 0}), Row({0, 0}), Metric::RelL2), 0);
    EXPECT_NEAR(ImageError(Row({3, 1}), Row({2, NAN}), Metric::RelL2), 1 / 4.04, 1e-12);
}

TEST(TrimmedRelL2, LeavesOutTheWorstPixelsAsAWhole) {
    Image reference(PixelFormat::Float, {50, 50}, kRgb), image = reference;
    Fill(image, 1, 0.1f);
    const double everywhere = ImageError(image, reference, Metric::RelL2);
    EXPECT_NEAR(TrimmedRelL2(image, reference), everywhere, 1e-12);
    // 0.1 % of 2500 pixels is 3 pixels, rounded up.
    for (int i = 0; i < 3; ++i) image.Set({10 * i, 7 * i}, i, 1000);
    EXPECT_GT(ImageError(image, reference, Metric::RelL2), 1000 * everywhere);
    EXPECT_NEAR(TrimmedRelL2(image, reference), everywhere, 1e-9);
    image.Set({49, 49}, 0, 1000);
    EXPECT_GT(TrimmedRelL2(image, reference), 1000 * everywhere);
    EXPECT_NEAR(TrimmedRelL2(image, reference, 0), ImageError(image, reference, Metric::RelL2), 1e-3);
}

TEST(TrimmedRelL2, SkipsWhatIsNotFinite) {
    EXPECT_NEAR(TrimmedRelL2(Row({NAN, 1, 2, 9}), Row({0, 0, 0, 0}), 0.1), (100 + 400) / 2.0, 1e-9);
    EXPECT_EQ(TrimmedRelL2(Row({1}), Row({0})), 0);
}

TEST(ImageError, TakesTheNamesOfTheFormat) {
    const char *const names[] = {"MAE", "MSE", "MRSE", "relL2", "relL2Abs", "SMAPE", "FLIP", "HDR-FLIP"};
    for (size_t i = 0; i < std::size(names); ++i) EXPECT_EQ(ParseMetric(names[i]), kMetrics[i]) << names[i];
    EXPECT_FALSE(ParseMetric("mse"));
    EXPECT_EQ(MetricNames().size(), std::size(kMetrics));
    for (Metric metric : kMetrics) EXPECT_EQ(ParseMetric(MetricNames()[size_t(metric)]), metric);
}

}  // namespace pbrt::test
