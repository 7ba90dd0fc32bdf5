#include "pbrt/cmd/pbrt/live_board.h"

#include <gtest/gtest.h>

#include <random>

#include "support/errors.h"

namespace pbrt {
namespace {

/// A picture whose samples are independent; the mean of value i is 1 + i % 3.
class GrowingPicture {
  public:
    static constexpr int kSide = 60;
    explicit GrowingPicture(unsigned seed) : random_(seed), sums_(kSide * kSide * 3) {}

    std::shared_ptr<const LiveImage> After(int samples) {
        std::exponential_distribution<double> one(1);
        for (; taken_ < samples; ++taken_)
            for (size_t i = 0; i < sums_.size(); ++i) sums_[i] += Mean(i) * one(random_);
        LiveImage picture{Image(PixelFormat::Float, {kSide, kSide}, {"R", "G", "B"}), LiveImage::State::Growing,
                          samples, ++version_};
        auto *values = static_cast<float *>(picture.colors.Data());
        for (size_t i = 0; i < sums_.size(); ++i) values[i] = float(sums_[i] / taken_);
        return std::make_shared<const LiveImage>(std::move(picture));
    }
    /// relL2 of the picture as it is, to the true means.
    double Error() const {
        constexpr double kEpsilon = 0.01 * 2 * 2;  // 2 is the mean of the means
        double sum = 0;
        for (size_t i = 0; i < sums_.size(); ++i) {
            const double d = sums_[i] / taken_ - Mean(i);
            sum += d * d / (Mean(i) * Mean(i) + kEpsilon);
        }
        return sum / double(sums_.size());
    }

  private:
    static double Mean(size_t i) { return 1 + double(i % 3); }
    std::mt19937 random_;
    std::vector<double> sums_;
    int taken_ = 0, version_ = 0;
};

TEST(ErrorEstimate, IsTheErrorOfIndependentSamples) {
    for (const std::vector<int> &pictures :
         {std::vector<int>{16, 32}, {16, 64}, {8, 16, 32, 64, 128}, {100, 110, 120, 130, 140, 150, 160}, {64, 65}}) {
        GrowingPicture picture(5);
        ErrorEstimate estimate;
        for (const int samples : pictures) estimate.Add(picture.After(samples));
        ASSERT_TRUE(estimate.RelL2());
        EXPECT_NEAR(*estimate.RelL2() / picture.Error(), 1, 0.08) << pictures.size() << " " << pictures.back();
    }
}

TEST(ErrorEstimate, NeedsTwoPicturesAndFollowsTheirOrder) {
    GrowingPicture picture(6);
    ErrorEstimate estimate;
    estimate.Add(nullptr);
    EXPECT_FALSE(estimate.RelL2());
    const auto first = picture.After(8);
    estimate.Add(first);
    estimate.Add(first);
    EXPECT_FALSE(estimate.RelL2());
    estimate.Add(picture.After(16));
    const double at16 = *estimate.RelL2();
    estimate.Add(first);  // older than the last
    EXPECT_EQ(*estimate.RelL2(), at16);
    estimate.Add(picture.After(64));
    EXPECT_LT(*estimate.RelL2(), at16 / 2);
}

TEST(ErrorEstimates, HaveAReasonWhereThereIsNone) {
    GrowingPicture picture(3);
    ErrorEstimate estimate;
    EXPECT_EQ(estimate.WhyNone(false), "no samples yet");
    estimate.Add(picture.After(1));
    test::ExpectWords(estimate.WhyNone(false), {"first"});
    test::ExpectWords(estimate.WhyNone(true), {"only one"});
    estimate.Add(picture.After(2));
    EXPECT_EQ(estimate.WhyNone(false), "");
}

}  // namespace
}  // namespace pbrt
