#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>

#include "pbrt/math/vec.h"

namespace pbrt {

// SIMD integers and floats by the vector extensions of GCC and Clang.

// 32 bytes, as AVX2 has: g++ shuffles vectors that are longer than the machine's lane by lane, in memory.
using Lanes64 = uint64_t __attribute__((vector_size(32)));    ///< 4 lanes
using Lanes32 = uint32_t __attribute__((vector_size(32)));    ///< 8 lanes
using FloatLanes = float __attribute__((vector_size(32)));    ///< 8 lanes
using DoubleLanes = double __attribute__((vector_size(32)));  ///< 4 lanes
inline constexpr int Lanes64Count = 4, Lanes32Count = 8;

namespace detail {
template <class T, int N>
struct LanesOf {
    typedef T Type __attribute__((vector_size(N * sizeof(T))));  // `using` ignores the attribute
};
}  // namespace detail
/// N lanes, a power of two.
template <class T, int N>
using LanesOf = typename detail::LanesOf<T, N>::Type;

template <class Lanes, class T>
inline Lanes LoadLanes(const T *from) {
    Lanes v;
    std::memcpy(&v, from, sizeof(v));
    return v;
}
inline void StoreLanes(const auto &v, auto *to) { std::memcpy(to, &v, sizeof(v)); }

/// Arithmetic of N floats: F has operators and conversion from Float; comparisons return Mask. Always inlined, as a
/// call would spill all registers.
template <int N>
struct SimdOps {
    using Mask = LanesOf<int32_t, N>;  ///< all bits of a lane, or none
    class F {
      public:
        F() = default;
        [[gnu::always_inline]] F(Float v) : v_(v - Lanes{}) {}
        [[gnu::always_inline]] F &operator+=(const F &o) { return v_ += o.v_, *this; }
        [[gnu::always_inline]] friend F operator-(const F &a) { return -a.v_; }
        [[gnu::always_inline]] friend F operator+(const F &a, const F &b) { return a.v_ + b.v_; }
        [[gnu::always_inline]] friend F operator-(const F &a, const F &b) { return a.v_ - b.v_; }
        [[gnu::always_inline]] friend F operator*(const F &a, const F &b) { return a.v_ * b.v_; }
        [[gnu::always_inline]] friend F operator/(const F &a, const F &b) { return a.v_ / b.v_; }
        [[gnu::always_inline]] friend Mask operator<(const F &a, const F &b) { return a.v_ < b.v_; }
        [[gnu::always_inline]] friend Mask operator>(const F &a, const F &b) { return a.v_ > b.v_; }
        [[gnu::always_inline]] friend Mask operator<=(const F &a, const F &b) { return a.v_ <= b.v_; }
        [[gnu::always_inline]] friend Mask operator>=(const F &a, const F &b) { return a.v_ >= b.v_; }
        [[gnu::always_inline]] friend Mask operator==(const F &a, const F &b) { return a.v_ == b.v_; }
        [[gnu::always_inline]] friend Mask operator!=(const F &a, const F &b) { return a.v_ != b.v_; }

      private:
        friend SimdOps;
        using Lanes = LanesOf<Float, N>;
        [[gnu::always_inline]] F(Lanes v) : v_(v) {}
        Lanes v_;
    };
    [[gnu::always_inline]] static F Load(const Float *v) { return LoadLanes<LanesOf<Float, N>>(v); }
    [[gnu::always_inline]] static void Store(const F &v, Float *to) { StoreLanes(v.v_, to); }
    [[gnu::always_inline]] static F Min(const F &a, const F &b) { return Select(a < b, a, b); }
    [[gnu::always_inline]] static F Max(const F &a, const F &b) { return Select(a > b, a, b); }
    [[gnu::always_inline]] static F Select(const Mask &c, const F &ifTrue, const F &ifFalse) {
        return c ? ifTrue.v_ : ifFalse.v_;
    }
    [[gnu::always_inline]] static F Sqrt(const F &a) {
        F r;
        for (int i = 0; i < N; ++i) r.v_[i] = std::sqrt(a.v_[i]);
        return r;
    }
    [[gnu::always_inline]] static F Abs(const F &a) {
        F r;
        for (int i = 0; i < N; ++i) r.v_[i] = std::abs(a.v_[i]);
        return r;
    }
    [[gnu::always_inline]] static bool Any(const Mask &c) {
        int32_t any = 0;
        for (int i = 0; i < N; ++i) any |= c[i];
        return any != 0;
    }
    [[gnu::always_inline]] static Float Sum(const F &a) {
        static_assert(N == 8);
        const auto half = [&](int i) { return a.v_[i] + a.v_[i + 4]; };
        return (half(0) + half(3)) + (half(1) + half(2));
    }
};

inline Lanes64 CountingLanes(uint64_t first) { return Lanes64{0, 1, 2, 3} + first; }

constexpr bool HasAnyBit(uint64_t v) { return v != 0; }
inline bool HasAnyBit(const Lanes64 &v) {
    uint64_t any = 0;
    for (int lane = 0; lane < Lanes64Count; ++lane) any |= v[lane];
    return any != 0;
}

/// T: uint32_t or lanes of it.
template <class T>
constexpr T ReverseBits(T v) {
    v = ((v & 0x55555555u) << 1) | ((v >> 1) & 0x55555555u);
    v = ((v & 0x33333333u) << 2) | ((v >> 2) & 0x33333333u);
    v = ((v & 0x0f0f0f0fu) << 4) | ((v >> 4) & 0x0f0f0f0fu);
    v = ((v & 0x00ff00ffu) << 8) | ((v >> 8) & 0x00ff00ffu);
    return (v << 16) | (v >> 16);
}

/// v * 2^-32, below 1; same as SobolToFloat.
inline FloatLanes FractionsToFloat(Lanes32 v) {
    const FloatLanes f = __builtin_convertvector(v, FloatLanes) * 0x1p-32f;
    return f < OneMinusEpsilon ? f : FloatLanes{} + OneMinusEpsilon;
}

/// Transposes eight rows of eight.
[[gnu::always_inline]] inline void Transpose(FloatLanes rows[8]) {
    FloatLanes a[8], b[8];
    for (int i = 0; i < 8; i += 2) {
        a[i] = __builtin_shufflevector(rows[i], rows[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        a[i + 1] = __builtin_shufflevector(rows[i], rows[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    for (int i = 0; i < 8; i += 4)
        for (int k = 0; k < 2; ++k) {
            b[i + 2 * k] = __builtin_shufflevector(a[i + k], a[i + k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            b[i + 2 * k + 1] = __builtin_shufflevector(a[i + k], a[i + k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    for (int i = 0; i < 4; ++i) {
        rows[i] = __builtin_shufflevector(b[i], b[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        rows[i + 4] = __builtin_shufflevector(b[i], b[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

inline Lanes32 LowHalves(const Lanes64 &a, const Lanes64 &b) {
    return __builtin_shufflevector(reinterpret_cast<Lanes32>(a), reinterpret_cast<Lanes32>(b), 0, 2, 4, 6, 8, 10, 12,
                                   14);
}

}  // namespace pbrt
