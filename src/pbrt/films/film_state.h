#pragma once
#include <cstddef>
#include <cstring>
#include <iosfwd>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "pbrt/core/state_io.h"
#include "pbrt/math/bounds.h"

namespace pbrt {

/// Sums of one type in a film as plain memory, and the functions that add other sums to them and clear them.
struct StateBlock {
    std::string name;
    const std::byte *data = nullptr;
    size_t bytes = 0;
    size_t sumBytes = 1;      ///< of one sum
    bool isOfSplats = false;  ///< has no bytes in a film that expects no splats
    void (*add)(std::byte *to, const std::byte *from, size_t bytes) = nullptr;
    void (*clear)(std::byte *data, size_t bytes) = nullptr;

    /// For changing the sums of a film that is not const.
    std::byte *Memory() const { return const_cast<std::byte *>(data); }
};

/// T is plain memory, T() is an empty sum and T += T adds two sums. An empty sum plus another equals the other to the
/// bit.
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

/// A state that was read: the kind and the pixels of the film, and its sums by name.
struct SavedState {
    std::string kind;
    Bounds2i pixelBounds{};
    struct Block {
        std::string name;
        std::vector<std::byte> data;
    };
    std::vector<Block> blocks;

    const Block *Find(const std::string &name) const;
};

/// Writes the blocks bit by bit, in this machine's byte order. The writer refers to them.
void WriteState(StateWriter &out, const std::string &kind, const Bounds2i &pixelBounds,
                const std::vector<StateBlock> &blocks);
/// Writes the sums that are not empty, as copies, and makes all of them empty.
void TakeSums(StateWriter &out, const std::vector<StateBlock> &blocks);
/// Adds what TakeSums wrote of blocks of the same sizes. Throws UserError if it was written of others.
void AddSums(StateReader &in, const std::vector<StateBlock> &blocks);
/// Throws UserError if the stream ends too early or holds something else.
SavedState ReadState(std::istream &in);

}  // namespace pbrt
