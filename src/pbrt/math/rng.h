#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "pbrt/math/vec.h"

namespace pbrt {

/// Finaliser with full avalanche (Stafford's mix 1).
constexpr uint64_t MixBits(uint64_t v) {
    v ^= v >> 31;
    v *= 0x7fb5d329728ea185ull;
    v ^= v >> 27;
    v *= 0x81dadef4bc2dd44dull;
    v ^= v >> 33;
    return v;
}

/// Hash of plain values (floats by their bits). Equal inputs give equal hashes on every machine with the same
/// endianness.
template <class... Args>
uint64_t Hash(const Args &...args) {
    static_assert(sizeof...(Args) > 0);
    uint64_t h = 0x9e3779b97f4a7c15ull + (uint64_t(0) + ... + sizeof(Args));
    auto absorb = [&h](const auto &value) {
        using T = std::decay_t<decltype(value)>;
        static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T> ||
                      std::is_same_v<T, glm::vec3> || std::is_same_v<T, glm::vec2> || std::is_same_v<T, glm::ivec2>);
        const char *bytes = reinterpret_cast<const char *>(&value);
        for (size_t i = 0; i < sizeof(T); i += 8) {
            uint64_t word = 0;
            std::memcpy(&word, bytes + i, std::min<size_t>(8, sizeof(T) - i));
            h = MixBits(h ^ (word + 0x9e3779b97f4a7c15ull + (h << 6) + (h >> 2)));
        }
    };
    (absorb(args), ...);
    return h;
}

/// Uniform in [0, 1) from the top bits of a hash.
inline Float HashToFloat(uint64_t h) { return std::min(OneMinusEpsilon, static_cast<Float>(h >> 32) * 0x1p-32f); }
template <class... Args>
Float HashFloat(const Args &...args) {
    return HashToFloat(Hash(args...));
}

/// PCG32 (O'Neill): 2^63 streams, cheap to seed, can jump ahead.
class Rng {
  public:
    explicit Rng(uint64_t sequence = 0) { SetSequence(sequence, MixBits(sequence)); }
    Rng(uint64_t sequence, uint64_t offset) { SetSequence(sequence, offset); }

    void SetSequence(uint64_t sequence, uint64_t offset) {
        state_ = 0;
        increment_ = (sequence << 1) | 1;
        Next();
        state_ += offset;
        Next();
    }
    uint32_t Next() {
        uint64_t old = state_;
        state_ = old * kMultiplier + increment_;
        auto xorshifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
        return std::rotr(xorshifted, static_cast<int>(old >> 59));
    }
    Float Uniform() { return std::min(OneMinusEpsilon, static_cast<Float>(Next()) * 0x1p-32f); }
    Point2 Uniform2() {
        Float x = Uniform();
        return {x, Uniform()};
    }
    /// Uniform integer in [0, n).
    uint32_t UniformInt(uint32_t n) { return static_cast<uint32_t>((uint64_t(Next()) * n) >> 32); }
    /// Skips `count` numbers.
    void Advance(uint64_t count) {
        uint64_t m = kMultiplier, c = increment_, accM = 1, accC = 0;
        for (; count > 0; count >>= 1) {
            if (count & 1) {
                accM *= m;
                accC = accC * m + c;
            }
            c *= m + 1;
            m *= m;
        }
        state_ = accM * state_ + accC;
    }

  private:
    static constexpr uint64_t kMultiplier = 0x5851f42d4c957f2dull;
    uint64_t state_ = 0, increment_ = 1;
};

}  // namespace pbrt
