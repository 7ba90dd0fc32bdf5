#pragma once
#include "pbrt/core/float.h"

namespace pbrt {

constexpr bool EndsWord(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '"' || c == '[' || c == ']';
}

/// Parses a number at `begin`: decimal or hexadecimal, optional sign, no inf or nan. Returns the position after it, or
/// `begin` if there is none. Underflow gives 0; overflow sets *overflow and leaves
/// *value unchanged, so that no infinity enters the scene.
const char *ScanFloat(const char *begin, const char *end, Float *value, bool *overflow);

/// The same for integers: optional sign and decimal digits. Sets *overflow beyond 32 bits.
const char *ScanInt(const char *begin, const char *end, int *value, bool *overflow);

}  // namespace pbrt
