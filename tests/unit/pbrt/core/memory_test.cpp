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

TEST(AvailableMemoryDeathTest, ObeysTheLimitOfTheProcess) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            // The process has mapped more memory than this limit already, so none is left; under the larger limit below
            // some is left.
            rlimit limit{};
            limit.rlim_cur = 1'000'000;
            limit.rlim_max = RLIM_INFINITY;
            setrlimit(RLIMIT_AS, &limit);
            const bool none = AvailableMemory() == 0;
            limit.rlim_cur = 20'000'000'000;
            setrlimit(RLIMIT_AS, &limit);
            std::_Exit(none && AvailableMemory() > 0 && AvailableMemory() < 20e9 ? 7 : 8);
        },
        testing::ExitedWithCode(7), "");
}

TEST(UsableMemoryDeathTest, ObeysTheLimitOfTheProcess) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            rlimit limit{};  // memory that is mapped already stays
            limit.rlim_cur = 50'000'000;
            limit.rlim_max = RLIM_INFINITY;
            setrlimit(RLIMIT_AS, &limit);
            std::_Exit(UsableMemory() == 50e6 ? 7 : 8);
        },
        testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace pbrt
