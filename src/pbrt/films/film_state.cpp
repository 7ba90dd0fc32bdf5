#include "pbrt/films/film_state.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

constexpr std::array<char, 8> kMagic = {'p', 'b', 'r', 't', 'f', 'l', 'm', '3'};  // the last byte is the version
constexpr uint64_t kMaxNameLength = 64, kMaxBlocks = 64;

std::string_view Take(StateReader &in, uint64_t bytes) {
    if (bytes > in.BytesLeft()) throw UserError("the saved state of a film ends too early.");
    return in.Take(bytes);
}

template <class T>
T ReadValue(StateReader &in) {
    T value;
    std::memcpy(&value, Take(in, sizeof(value)).data(), sizeof(value));
    return value;
}

std::string ReadName(StateReader &in) {
    const auto length = ReadValue<uint64_t>(in);
    if (length > kMaxNameLength) ThrowOtherFilm();
    return std::string(Take(in, length));
}

}  // namespace

void ThrowOtherFilm() { throw UserError("the saved state of a film does not belong to this film."); }

void WriteState(StateWriter &out, const std::string &kind, const Bounds2i &pixelBounds,
                const std::vector<StateBlock> &blocks) {
    out.Value(kMagic);
    out.Text(kind);
    out.Value(pixelBounds);
    out.Value(uint64_t{blocks.size()});
    for (const StateBlock &block : blocks) {
        out.Text(block.name);
        out.Value(uint64_t{block.bytes});
        out.Refer(block.data, block.bytes);
    }
}

SavedState ReadState(StateReader &in) {
    SavedState state;
    const auto magic = ReadValue<std::array<char, 8>>(in);
    if (!std::equal(kMagic.begin(), kMagic.end() - 1, magic.begin())) ThrowOtherFilm();
    if (magic != kMagic) throw UserError("the saved state of a film is of another version of the program.");
    state.kind = ReadName(in);
    state.pixelBounds = ReadValue<Bounds2i>(in);
    const auto count = ReadValue<uint64_t>(in);
    if (count > kMaxBlocks) ThrowOtherFilm();
    for (uint64_t i = 0; i < count; ++i) {
        const std::string name = ReadName(in);
        state.sums[name] = Take(in, ReadValue<uint64_t>(in));
    }
    return state;
}

void TakeSums(StateWriter &out, const std::vector<StateBlock> &blocks) {
    for (const StateBlock &block : blocks) {
        // Compared in pieces of several sums; adjacent pieces form one run.
        const size_t piece = std::max<size_t>(1, 256 / block.sumBytes) * block.sumBytes;
        std::vector<std::byte> empty(std::min(piece, block.bytes));
        block.clear(empty.data(), empty.size());
        const auto isEmpty = [&](size_t at) {
            return std::memcmp(block.data + at, empty.data(), std::min(piece, block.bytes - at)) == 0;
        };
        out.Value(uint64_t{block.bytes});
        for (size_t at = 0; at < block.bytes;) {
            if (isEmpty(at)) {
                at += piece;
                continue;
            }
            const size_t begin = at;
            while (at < block.bytes && !isEmpty(at)) at += piece;
            const size_t bytes = std::min(at, block.bytes) - begin;
            out.Value(uint64_t{begin});
            out.Value(uint64_t{bytes});
            out.Copy(block.data + begin, bytes);
        }
        out.Value(uint64_t{block.bytes});
        block.clear(block.Memory(), block.bytes);
    }
}

void AddSums(StateReader &in, const std::vector<StateBlock> &blocks) {
    for (const StateBlock &block : blocks) {
        const auto all = in.Value<uint64_t>();
        in.Require(all == block.bytes || (block.isOfSplats && all == 0), "its sums are of another film");
        for (auto begin = in.Value<uint64_t>(); begin < all; begin = in.Value<uint64_t>()) {
            const auto bytes = in.Value<uint64_t>();
            in.Require(bytes <= all - begin && begin % block.sumBytes == 0 && bytes % block.sumBytes == 0,
                       "its sums are of another film");
            block.add(block.Memory() + begin, reinterpret_cast<const std::byte *>(in.Take(bytes).data()), bytes);
        }
    }
}

}  // namespace pbrt
