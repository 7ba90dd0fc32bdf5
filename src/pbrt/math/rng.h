#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "pbrt/math/lanes.h"
#include "pbrt/math/vec.h"

namespace pbrt {

/// Finaliser with full avalanche (Stafford's mix 1), for scalars and lanes.
template <class T>
constexpr T MixBitsOf(T v) {
    v ^= v >> 31;
    v *= 0x7fb5d329728ea185ull;
    v ^= v >> 27;
    v *= 0x81dadef4bc2dd44dull;
    v ^= v >> 33;
    return v;
}
constexpr uint64_t MixBits(uint64_t v) { return MixBitsOf(v); }
inline Lanes64 MixBits(const Lanes64 &v) { return MixBitsOf(v); }

/// Hash of plain values (floats by their bits), the same on all machines of equal endianness.
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

/// Uniform in [0, 1).
inline Float HashToFloat(uint64_t h) { return std::min(OneMinusEpsilon, Float(h >> 32) * 0x1p-32f); }
template <class... Args>
Float HashFloat(const Args &...args) {
    return HashToFloat(Hash(args...));
}

/// PCG32 (O'Neill): 2^63 streams, cheap seeding and jump-ahead.
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
        auto xorshifted = uint32_t(((old >> 18) ^ old) >> 27);
        return std::rotr(xorshifted, int(old >> 59));
    }
    Float Uniform() { return std::min(OneMinusEpsilon, Float(Next()) * 0x1p-32f); }  ///< in [0, 1)
    Point2 Uniform2() {
        Float x = Uniform();
        return {x, Uniform()};
    }
    uint32_t UniformInt(uint32_t n) { return uint32_t((uint64_t(Next()) * n) >> 32); }  ///< below n
    void Advance(uint64_t count) {  ///< as `count` calls of Next, in logarithmic time
        for (; count > 0; count &= count - 1) {
            const Jump &jump = kJumps[std::countr_zero(count)];
            state_ = jump.multiplier * state_ + jump.steps * increment_;
        }
    }

    /// The next eight values of Uniform(), without advancing the state.
    FloatLanes NextUniforms() const {
        Lanes64 drawn[2];
        for (int half = 0; half < 2; ++half) {
            const auto multipliers = LoadLanes<Lanes64>(&kRuns.multipliers[half * Lanes64Count]);
            const auto steps = LoadLanes<Lanes64>(&kRuns.steps[half * Lanes64Count]);
            const Lanes64 old = multipliers * state_ + steps * increment_;
            const Lanes64 xorshifted = (((old >> 18) ^ old) >> 27) & 0xffffffffull, turn = old >> 59;
            drawn[half] = (xorshifted >> turn) | (xorshifted << (32 - turn));
        }
        return FractionsToFloat(LowHalves(drawn[0], drawn[1]));
    }

  private:
    static constexpr uint64_t kMultiplier = 0x5851f42d4c957f2dull;
    /// 2^k steps: state -> multiplier * state + steps * increment.
    struct Jump {
        uint64_t multiplier = kMultiplier, steps = 1;
    };
    static constexpr std::array<Jump, 64> Jumps() {
        std::array<Jump, 64> jumps{};
        for (size_t k = 1; k < jumps.size(); ++k) {
            const Jump &half = jumps[k - 1];
            jumps[k] = {half.multiplier * half.multiplier, half.multiplier * half.steps + half.steps};
        }
        return jumps;
    }
    /// Jumps of 0, 1, ... 7 steps.
    struct RunJumps {
        std::array<uint64_t, Lanes32Count> multipliers{1}, steps{0};
    };
    static constexpr RunJumps Runs() {
        RunJumps runs;
        for (size_t n = 1; n < Lanes32Count; ++n) {
            runs.multipliers[n] = runs.multipliers[n - 1] * kMultiplier;
            runs.steps[n] = runs.steps[n - 1] * kMultiplier + 1;
        }
        return runs;
    }
    static const std::array<Jump, 64> kJumps;
    static const RunJumps kRuns;
    uint64_t state_ = 0, increment_ = 1;
};
inline constexpr std::array<Rng::Jump, 64> Rng::kJumps = Rng::Jumps();
inline constexpr Rng::RunJumps Rng::kRuns = Rng::Runs();

/// Russian roulette. Returns true if the path ends, with probability 1 - `continuation`; else divides its throughput by
/// `continuation`. From 1 on, no path ends and no number is used.
bool EndsByRoulette(Float continuation, Rng &rng, auto &throughput) {
    if (!(continuation < 1)) return false;
    if (rng.Uniform() >= continuation) return true;
    throughput /= continuation;
    return false;
}

}  // namespace pbrt
