#pragma once
#include <cstddef>
#include <memory>
#include <type_traits>
#include <vector>

namespace pbrt {

/// Scratch memory for a light sampler's weights at one vertex, owned by the caller, e.g. on the stack. 4096 bytes are
/// inline; only the excess is allocated on the heap.
class LightMemory {
  public:
    LightMemory() = default;
    LightMemory(const LightMemory &) = delete;
    LightMemory &operator=(const LightMemory &) = delete;

    /// Invalidates all allocations.
    void Clear() {
        used_ = 0;
        if (!larger_.empty()) larger_.clear();
    }
    /// Allocates a T or `count` of them, cache-line aligned and uninitialized.
    template <class T>
    T *Make(size_t count = 1) {
        static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= kAlignment);
        const size_t bytes = (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
        if (bytes > sizeof(inside_) - used_) return new (Larger(bytes)) T[count];
        std::byte *place = inside_ + used_;
        used_ += bytes;
        return new (place) T[count];
    }

  private:
    static constexpr size_t kAlignment = 64;
    struct alignas(kAlignment) Line {
        std::byte bytes[kAlignment];
    };
    [[gnu::cold]] void *Larger(size_t bytes) {
        larger_.push_back(std::make_unique_for_overwrite<Line[]>(bytes / kAlignment));
        return larger_.back().get();
    }

    size_t used_ = 0;
    std::vector<std::unique_ptr<Line[]>> larger_;
    alignas(kAlignment) std::byte inside_[4096];
};

}  // namespace pbrt
