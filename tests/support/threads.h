#pragma once
#include "pbrt/core/parallel.h"

namespace pbrt::test {

/// What `make` returns if it may use so many threads.
template <class Make>
auto OnThreads(int threads, Make &&make) {
    ThreadLimit limit(threads);
    return make();
}

}  // namespace pbrt::test
