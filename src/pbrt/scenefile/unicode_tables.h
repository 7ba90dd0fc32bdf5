#pragma once
#include <cstdint>
#include <span>

namespace pbrt::unicode {

/// `composed` decomposes canonically into `first second`; the reverse is done only if `composes`.
struct CanonicalPair {
    char32_t composed, first, second;
    bool composes;
};
/// `composed` decomposes into one other character and is never made again.
struct CanonicalSingle {
    char32_t composed, plain;
};
/// Characters with the same non-zero canonical combining class.
struct CombiningRange {
    char32_t first, last;
    uint8_t combiningClass;
};

/// All three are sorted by their first member.
std::span<const CanonicalPair> Pairs();
std::span<const CanonicalSingle> Singles();
std::span<const CombiningRange> CombiningClasses();

}  // namespace pbrt::unicode
