#pragma once
#include <cstddef>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "pbrt/core/state_io.h"
#include "pbrt/math/bounds.h"

namespace pbrt {

/// Sums of one type as plain memory, with functions to add and clear them.
struct StateBlock {
    std::string name;
    const std::byte *data = nullptr;
    size_t bytes = 0;
    size_t sumBytes = 1;      ///< of one sum
    bool isOfSplats = false;  ///< has no bytes in a film without splats
    void (*add)(std::byte *to, const std::byte *from, size_t bytes) = nullptr;
    void (*clear)(std::byte *data, size_t bytes) = nullptr;

    std::byte *Memory() const { return const_cast<std::byte *>(data); }
};

/// T is plain memory, T() an empty sum, and T += T adds. An empty sum plus another is bit-identical to the other.
template <class T>
StateBlock MakeStateBlock(const char *name, std::span<const T> sums) {
    static_assert(std::is_trivially_copyable_v<T>);
    StateBlock block;
    block.name = name;
    block.data = reinterpret_cast<const std::byte *>(sums.data());
    block.bytes = sums.size_bytes();
    block.sumBytes = sizeof(T);
    block.add = [](std::byte *to, const std::byte *from, size_t bytes) {
        for (size_t at = 0; at < bytes; at += sizeof(T)) {
            T sum, other;
            std::memcpy(&sum, to + at, sizeof(T));
            std::memcpy(&other, from + at, sizeof(T));
            sum += other;
            std::memcpy(to + at, &sum, sizeof(T));
        }
    };
    block.clear = [](std::byte *data, size_t bytes) {
        const T empty{};
        for (size_t at = 0; at < bytes; at += sizeof(T)) std::memcpy(data + at, &empty, sizeof(T));
    };
    return block;
}

/// A loaded state: kind and pixels of the film, and its sums by name.
struct SavedState {
    std::string kind;
    Bounds2i pixelBounds{};
    std::map<std::string, std::string_view> sums;  ///< the reader's bytes
};

[[noreturn]] void ThrowOtherFilm();
/// Writes the blocks bitwise, in native byte order. The writer refers to them.
void WriteState(StateWriter &out, const std::string &kind, const Bounds2i &pixelBounds,
                const std::vector<StateBlock> &blocks);
/// Writes copies of the non-empty sums and clears all.
void TakeSums(StateWriter &out, const std::vector<StateBlock> &blocks);
/// Adds the output of TakeSums for blocks of the same sizes. Throws UserError for others.
void AddSums(StateReader &in, const std::vector<StateBlock> &blocks);
/// Throws UserError for truncated or other data.
SavedState ReadState(StateReader &in);

}  // namespace pbrt
