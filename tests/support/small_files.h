#pragma once
#include <gtest/gtest.h>
#include <sys/resource.h>

namespace pbrt::test {

/// While it lives, this process and those it starts cannot write beyond so many bytes of a file: to them that is what a
/// full disk is, an error in the middle of a write.
class SmallFilesOnly {
  public:
    explicit SmallFilesOnly(rlim_t bytes) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
    }
    ~SmallFilesOnly() { setrlimit(RLIMIT_FSIZE, &before_); }
    SmallFilesOnly(const SmallFilesOnly &) = delete;
    SmallFilesOnly &operator=(const SmallFilesOnly &) = delete;

  private:
    rlimit before_{};
};

}  // namespace pbrt::test
