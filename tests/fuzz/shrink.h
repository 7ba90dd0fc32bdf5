#pragma once
#include <functional>

#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

/// Makes a failing case smaller as long as `stillFails` says that it fails for the same reason: leaves out arguments,
/// then lines, words and bytes of its files, many at once first. Calls `stillFails` at most `maxTries` times.
FuzzCase Shrink(FuzzCase failing, const std::function<bool(const FuzzCase &)> &stillFails, int maxTries);

}  // namespace pbrt::fuzz
