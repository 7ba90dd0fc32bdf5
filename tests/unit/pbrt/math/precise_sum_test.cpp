#include "pbrt/math/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "pbrt/math/rng.h"

namespace pbrt {
namespace {

/// Products of two floats of either sign, over a range of 2^40.
std::vector<double> Products(size_t count) {
    Rng rng(5);
    std::vector<double> products;
    for (size_t i = 0; i < count; ++i) {
        const Float size = std::exp2(20 * rng.Uniform() - 10), weight = std::exp2(20 * rng.Uniform() - 10);
        products.push_back((rng.Uniform() < 0.4f ? -1 : 1) * double(size) * double(weight));
    }
    return products;
}

TEST(PreciseSum, IsTheSameInAnyOrderAndAnyPartsToTheBit) {
    std::vector<double> addends = Products(1000);
    PreciseSum whole;
    double plain = 0;
    for (double x : addends) {
        whole.Add(x);
        plain += x;
    }
    Rng rng(9);
    int plainDiffers = 0;
    for (int round = 0; round < 200; ++round) {
        for (size_t i = addends.size(); i-- > 1;)
            std::swap(addends[i], addends[rng.UniformInt(static_cast<uint32_t>(i + 1))]);
        // Three parts, each summed by itself and then added to the others in any order.
        const size_t a = rng.UniformInt(1000), b = a + rng.UniformInt(static_cast<uint32_t>(1000 - a));
        PreciseSum parts[3], sum;
        double plainParts[3] = {};
        for (size_t i = 0; i < addends.size(); ++i) {
            const size_t part = i < a ? 0 : i < b ? 1 : 2;
            parts[part].Add(addends[i]);
            plainParts[part] += addends[i];
        }
        for (size_t k : {2, 0, 1}) sum += parts[k];
        EXPECT_EQ(sum.Value(), whole.Value());
        EXPECT_EQ(sum.Rest(), whole.Rest());
        plainDiffers += plainParts[2] + plainParts[0] + plainParts[1] != plain;
    }
    EXPECT_GT(plainDiffers, 100) << "plain sums would have done";
}

TEST(PreciseSum, KeepsWhatADoubleLoses) {
    PreciseSum sum;
    sum.Add(1e16);
    for (int i = 0; i < 1000; ++i) sum.Add(1);
    sum.Add(-1e16);
    EXPECT_EQ(sum.Value(), 1000);
    EXPECT_EQ(sum.Rest(), 0);
    PreciseSum infinite;
    infinite.Add(1);
    infinite.Add(HUGE_VAL);
    infinite.Add(1);
    EXPECT_EQ(infinite.Value(), HUGE_VAL);
}

TEST(PreciseSum, TheVarianceOfEqualNumbersIsZero) {
    for (double x : {0.1f, 123.456f, 3e-5f}) {
        PreciseSum sum, squares;
        for (int n = 1; n <= 5000; ++n) {
            sum.Add(x);
            squares.Add(x * x);
            ASSERT_EQ(VarianceOf(sum, squares, n), 0) << x << " " << n;
        }
    }
    PreciseSum sum, squares;
    for (double x : {1.0, 2.0, 4.0}) {
        sum.Add(x);
        squares.Add(x * x);
    }
    EXPECT_NEAR(VarianceOf(sum, squares, 3), 7.0 / 3, 1e-15);
    EXPECT_EQ(VarianceOf(sum, squares, 1), 0);
}

}  // namespace
}  // namespace pbrt
