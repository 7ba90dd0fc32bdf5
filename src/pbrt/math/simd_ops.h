#pragma once
#include <experimental/simd>

#include "pbrt/math/vec.h"

namespace pbrt {

namespace stdx = std::experimental;

/// Arithmetic of N floats in SIMD registers: F has operators and conversion from Float; comparisons return Mask. Always
/// inlined, as a call would spill all registers. Apart from lanes.h, as its standard header is slow to compile.
template <int N>
struct SimdOps {
    using F = stdx::simd<Float, stdx::simd_abi::deduce_t<Float, N>>;
    using Mask = typename F::mask_type;
    /// Aligned: to sizeof(F).
    [[gnu::always_inline]] static F LoadAligned(const Float *v) { return F(v, stdx::vector_aligned); }
    [[gnu::always_inline]] static F Load(const Float *v) { return F(v, stdx::element_aligned); }
    [[gnu::always_inline]] static void StoreAligned(const F &v, Float *to) { v.copy_to(to, stdx::vector_aligned); }
    [[gnu::always_inline]] static void Store(const F &v, Float *to) { v.copy_to(to, stdx::element_aligned); }
    [[gnu::always_inline]] static F Min(const F &a, const F &b) { return stdx::min(a, b); }
    [[gnu::always_inline]] static F Max(const F &a, const F &b) { return stdx::max(a, b); }
    [[gnu::always_inline]] static F Select(const Mask &c, const F &ifTrue, const F &ifFalse) {
        F r = ifFalse;
        stdx::where(c, r) = ifTrue;
        return r;
    }
    [[gnu::always_inline]] static F Sqrt(const F &a) { return stdx::sqrt(a); }
    [[gnu::always_inline]] static F Abs(const F &a) { return stdx::abs(a); }
    [[gnu::always_inline]] static bool Any(const Mask &c) { return stdx::any_of(c); }
    [[gnu::always_inline]] static Float Sum(const F &v) { return stdx::reduce(v); }
};

}  // namespace pbrt
