#include "pbrt/scenefile/tokenizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>

namespace pbrt {
namespace {

/// The value of `text` if all of it is a number.
std::optional<Float> WholeFloat(const std::string &text) {
    Float v = -77;
    bool overflow = false;
    const char *end = text.data() + text.size();
    if (text.empty() || ScanFloat(text.data(), end, &v, &overflow) != end || overflow) return {};
    return v;
}

std::optional<int> WholeInt(const std::string &text) {
    int v = -77;
    bool overflow = false;
    const char *end = text.data() + text.size();
    if (text.empty() || ScanInt(text.data(), end, &v, &overflow) != end || overflow) return {};
    return v;
}

TEST(ScanFloat, AcceptsEveryFormOfTheFormat) {
    EXPECT_EQ(WholeFloat("5"), 5.f);
    EXPECT_EQ(WholeFloat("5."), 5.f);
    EXPECT_EQ(WholeFloat(".5"), .5f);
    EXPECT_EQ(WholeFloat("+.8"), .8f);
    EXPECT_EQ(WholeFloat("-1e-3"), -1e-3f);
    EXPECT_EQ(WholeFloat("8.e-1"), .8f);
    EXPECT_EQ(WholeFloat("70.0E-1"), 7.f);
    EXPECT_EQ(WholeFloat("-7.0e+0"), -7.f);
    EXPECT_EQ(WholeFloat("0x10"), 16.f);
    EXPECT_EQ(WholeFloat("-0X1.8p1"), -3.f);
    EXPECT_EQ(WholeFloat("007"), 7.f);
    EXPECT_TRUE(std::signbit(*WholeFloat("-0")));
}

TEST(ScanFloat, RejectsWhatIsNoNumber) {
    for (const char *text : {"",         "+",    "-",   ".",   "-.", "e5", "1e",  "1e+", "1.2.3", "nan", "inf", "-inf",
                             "infinity", "+nan", "--1", "+-1", "1x", "0x", "0xg", "1f",  "1,5",   "5#",  "true"})
        EXPECT_FALSE(WholeFloat(text)) << text;
}

TEST(ScanFloat, OnlyOverflowIsReported) {
    Float v = 0;
    bool overflow = false;
    std::string large = "-1e60", small = "1e-60", denormal = "1e-40";
    EXPECT_EQ(ScanFloat(large.data(), large.data() + large.size(), &v, &overflow), large.data() + large.size());
    EXPECT_TRUE(overflow);
    EXPECT_EQ(v, 0) << "an overflow must not set the value to infinity";
    EXPECT_EQ(WholeFloat("3.4028235e38"), 3.4028235e38f);
    EXPECT_FALSE(WholeFloat("3.4028236e38"));
    EXPECT_EQ(WholeFloat(small), 0.f);
    EXPECT_EQ(WholeFloat(denormal), 1e-40f);
}

TEST(ScanFloat, AgreesWithStrtofOnRandomNumbers) {
    uint64_t state = 12345;
    for (int i = 0; i < 20000; ++i) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        uint32_t bits = static_cast<uint32_t>(state >> 32);
        float f;
        std::memcpy(&f, &bits, sizeof f);
        if (!std::isfinite(f)) continue;
        char text[64];
        std::snprintf(text, sizeof text, i % 3 == 0 ? "%.9g" : i % 3 == 1 ? "%.4e" : "%.17g", static_cast<double>(f));
        ASSERT_EQ(WholeFloat(text), std::strtof(text, nullptr)) << text;
    }
}

TEST(ScanInt, TakesSignAndDigitsOnly) {
    EXPECT_EQ(WholeInt("12"), 12);
    EXPECT_EQ(WholeInt("+64"), 64);
    EXPECT_EQ(WholeInt("-3"), -3);
    EXPECT_EQ(WholeInt("2147483647"), 2147483647);
    EXPECT_EQ(WholeInt("-2147483648"), -2147483647 - 1);
    for (const char *text : {"", "+", "-", "+-3", "-+3", "1.0", "1e3", "0x10", "12a", "2147483648", "-2147483649"})
        EXPECT_FALSE(WholeInt(text)) << text;
}

}  // namespace
}  // namespace pbrt
