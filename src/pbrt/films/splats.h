#pragma once
#include <span>
#include <vector>

#include "pbrt/core/memory.h"
#include "pbrt/films/film_state.h"
#include "pbrt/films/fixed_sum.h"

namespace pbrt {

/// Splat sums per pixel; adding is thread-safe.
class Splats {
  public:
    /// Allocates `count` sums, once. Throws UserError if memory is insufficient.
    void Expect(size_t count) {
        if (!sums_.empty()) return;
        RequireMemory(static_cast<double>(count) * sizeof(FixedSum), "the film: splats of light paths", {});
        sums_.resize(count);
    }
    bool AreExpected() const { return !sums_.empty(); }
    void Add(size_t index, double x) { sums_[index].Add(x); }
    double Sum(size_t index) const { return sums_[index].Value(); }

    StateBlock Block(const char *name) const {
        StateBlock block = MakeStateBlock(name, std::span(sums_));
        block.isOfSplats = true;
        return block;
    }

  private:
    std::vector<FixedSum> sums_;
};

}  // namespace pbrt
