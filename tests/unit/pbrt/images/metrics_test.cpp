#include "pbrt/images/metrics.h"

#include <cmath>

#include "image_fixtures.h"
#include "pbrt/core/error.h"

namespace pbrt {

namespace {
Image Values(std::initializer_list<Float> values) {
    Image image(PixelFormat::Float, {static_cast<int>(values.size()), 1}, {"Y"});
    std::copy(values.begin(), values.end(), static_cast<float *>(image.Data()));
    return image;
}
}  // namespace

TEST(ImageError, MatchesHandComputedValues) {
    const Image image = Values({1, 0, 3}), reference = Values({2, 0, 1});
    EXPECT_NEAR(ImageError(image, reference, Metric::MAE), (1 + 0 + 2) / 3.0, 1e-12);
    EXPECT_NEAR(ImageError(image, reference, Metric::MSE), (1 + 0 + 4) / 3.0, 1e-12);
    EXPECT_NEAR(ImageError(image, reference, Metric::MRSE), (1 / (2.01 * 2.01) + 4 / (1.01 * 1.01)) / 3, 1e-12);
    EXPECT_NEAR(ImageError(image, reference, Metric::RelL2), (1 / 4.01 + 4 / 1.01) / 3, 1e-12);
}

TEST(ImageError, IsZeroOnlyForEqualImages) {
    const Image image = test::NoiseImage(PixelFormat::Float, {9, 7}, {"R", "G", "B"});
    Image other = image;
    for (Metric metric : {Metric::MAE, Metric::MSE, Metric::MRSE, Metric::RelL2})
        EXPECT_EQ(ImageError(image, other, metric), 0);
    other.Set({8, 6}, 2, other.Get({8, 6}, 2) + 0.25f);
    for (Metric metric : {Metric::MAE, Metric::MSE, Metric::MRSE, Metric::RelL2})
        EXPECT_GT(ImageError(image, other, metric), 0);
}

TEST(ImageError, LeavesOutWhatIsNotFiniteAndCountsIt) {
    size_t skipped = 0;
    Image terms;
    EXPECT_NEAR(ImageError(Values({1, NAN, INFINITY, 2}), Values({0, 0, 0, 0}), Metric::MSE, &terms, &skipped), 2.5,
                1e-12);
    EXPECT_EQ(skipped, 2u);
    EXPECT_EQ(terms.Get({0, 0}, 0), 1);
    EXPECT_EQ(terms.Get({3, 0}, 0), 4);
    EXPECT_FALSE(std::isfinite(terms.Get({1, 0}, 0)));
}

TEST(ImageError, RefusesImagesThatDoNotMatch) {
    EXPECT_THROW(ImageError(Values({1, 2}), Values({1}), Metric::MSE), UserError);
    EXPECT_THROW(ImageError(Values({1}), Image(PixelFormat::Float, {1, 1}, {"R"}), Metric::MSE), UserError);
}

TEST(ImageError, KnowsTheNamesOfTheFormat) {
    EXPECT_EQ(ParseMetric("MAE"), Metric::MAE);
    EXPECT_EQ(ParseMetric("MSE"), Metric::MSE);
    EXPECT_EQ(ParseMetric("MRSE"), Metric::MRSE);
    EXPECT_EQ(ParseMetric("relL2"), Metric::RelL2);
    EXPECT_FALSE(ParseMetric("FLIP"));
    EXPECT_FALSE(ParseMetric("mse"));
}

}  // namespace pbrt
