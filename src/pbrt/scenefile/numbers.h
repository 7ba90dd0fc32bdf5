#pragma once
#include "pbrt/core/float.h"

namespace pbrt {

/// True for the characters that end a bare word: white space, quotes and brackets.
constexpr bool EndsWord(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '"' || c == '[' || c == ']';
}

/// Reads the number at the start of [begin, end): decimal or hexadecimal, optional sign, no inf or nan. Returns the
/// place behind it, or `begin` if there is none. Values too small become 0; too large ones set *overflow and leave
/// *value as it is, so that no infinity gets into the scene.
const char *ScanFloat(const char *begin, const char *end, Float *value, bool *overflow);

/// The same for integers: optional sign and decimal digits. A value beyond 32 bits sets *overflow.
const char *ScanInt(const char *begin, const char *end, int *value, bool *overflow);

}  // namespace pbrt
