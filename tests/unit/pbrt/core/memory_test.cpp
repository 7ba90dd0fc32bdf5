#include "pbrt/core/memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>

#include "support/errors.h"

namespace pbrt {
namespace {

TEST(BytesText, HasTwoOrThreeDigits) {
    EXPECT_EQ(BytesText(240e9), "240 GB");
    EXPECT_EQ(BytesText(1.26e6), "1.3 MB");
    EXPECT_EQ(BytesText(999.6e6), "1.0 GB");
    EXPECT_EQ(BytesText(23.4e12), "23 TB");
    EXPECT_EQ(BytesText(4e18), "4000 PB");
    EXPECT_EQ(BytesText(0), "0.0 MB");
}

TEST(RequireMemory, ComparesWithWhatThisProcessCanUse) {
    const double usable = UsableMemory();
    EXPECT_GT(usable, 1e8);
    EXPECT_NO_THROW(RequireMemory(usable, "a film", {}));
    test::ExpectError([&] { RequireMemory(usable * 1.01, "a film", {}); },
                      {"a film", BytesText(usable * 1.01), BytesText(usable)});
}

TEST(AvailableMemory, IsLessByWhatThisProcessHas) {
    EXPECT_GT(AvailableMemory(), 1e7);
    EXPECT_LT(AvailableMemory(), UsableMemory());
}

/// The address space of this process; what is mapped already stays.
void LimitAddresses(rlim_t bytes) {
    const rlimit limit{bytes, RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &limit);
}

TEST(MemoryDeathTest, ObeysTheLimitOfTheProcess) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            LimitAddresses(1'000'000);  // more is mapped already
            const bool none = AvailableMemory() == 0 && UsableMemory() == 1e6;
            LimitAddresses(20'000'000'000);
            std::_Exit(none && AvailableMemory() > 0 && AvailableMemory() < 20e9 ? 7 : 8);
        },
        testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace pbrt
