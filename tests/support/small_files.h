#pragma once
#include <gtest/gtest.h>
#include <sys/resource.h>

namespace pbrt::test {

/// While an object lives, this process and those it starts cannot make a file longer than the given number of bytes. To
/// them this looks like a full disk: a write fails in the middle of a file.
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
