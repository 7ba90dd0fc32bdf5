#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/math/vec.h"

namespace pbrt {

struct NoValue {};

/// Densities that are constant on n equal pieces of a segment, one per row, and a value of each piece. What a sample
/// reads lies side by side, as the tables of an environment map are larger than the caches.
template <class Value = NoValue>
class PiecewiseConstantRows {
  public:
    struct Piece {
        Float below = 0;  ///< probability of the pieces before this one
        Float pdf = 0;    ///< with respect to the length
        [[no_unique_address]] Value value{};
    };
    PiecewiseConstantRows() = default;
    PiecewiseConstantRows(size_t rows, size_t n)
        : n_(n), cutCount_(std::bit_floor(std::max<size_t>(1, n / kPiecesPerCut))), pieces_(rows * (n + 1)),
          cuts_(rows * (cutCount_ + 1)) {}

    size_t Rows() const { return pieces_.size() / (n_ + 1); }
    size_t PieceCount() const { return n_; }
    Piece &At(size_t row, size_t piece) { return pieces_[row * (n_ + 1) + piece]; }
    const Piece &At(size_t row, size_t piece) const { return pieces_[row * (n_ + 1) + piece]; }
    /// Makes the density of a row proportional to |f|, n values; uniform if f is 0. Returns the integral of |f| over
    /// `length`.
    Float Set(size_t row, std::span<const Float> f, double length);
    struct Sampled {
        Float place;  ///< in [0, 1] of the length
        size_t index;
        const Piece &piece;
    };
    Sampled Sample(size_t row, Float u) const;

  private:
    /// Pieces between two cuts should fit a cache line.
    static constexpr size_t kPiecesPerCut = std::max<size_t>(1, 64 / sizeof(Piece));
    size_t n_ = 0, cutCount_ = 0;
    std::vector<Piece> pieces_;  ///< n and an end per row
    /// Lookup table of a row: entry k is the piece that contains k / cutCount_, so the piece of u lies between
    /// neighbouring entries. cutCount_ is a power of two, so that u cutCount_ is exact.
    std::vector<uint32_t> cuts_;
};

template <class Value>
Float PiecewiseConstantRows<Value>::Set(size_t row, std::span<const Float> f, double length) {
    PBRT_CHECK(f.size() == n_ && n_ > 0);
    Piece *const pieces = &At(row, 0);
    const double width = length / double(n_);
    double sum = 0;
    for (Float v : f) sum += double(std::abs(v)) * width;
    const auto integral = Float(sum);
    double running = 0;
    for (size_t i = 0; i < n_; ++i) {
        pieces[i].pdf = integral > 0 ? std::abs(f[i]) / integral : Float(1 / length);
        running += double(std::abs(f[i])) * width;
        pieces[i + 1].below = Float(sum > 0 ? running / sum : double(i + 1) / double(n_));
    }
    pieces[n_].below = 1;

    uint32_t *const cuts = &cuts_[row * (cutCount_ + 1)];
    size_t i = 0;
    for (size_t k = 0; k <= cutCount_; ++k) {
        const Float u = Float(k) / Float(cutCount_);
        while (i + 1 < n_ && pieces[i + 1].below <= u) ++i;
        cuts[k] = uint32_t(i);
    }
    return integral;
}

template <class Value>
auto PiecewiseConstantRows<Value>::Sample(size_t row, Float u) const -> Sampled {
    // Last piece whose lower end is <= u; pieces of no width are never chosen. Branchless, as u is random.
    const Piece *const pieces = &At(row, 0);
    const uint32_t *const cut = &cuts_[row * (cutCount_ + 1)] + std::min(size_t(u * Float(cutCount_)), cutCount_ - 1);
    size_t i = cut[0];
    for (size_t left = cut[1] - i + 1; left > 1;) {
        const size_t half = left / 2;
        i = pieces[i + half].below <= u ? i + half : i;
        left -= half;
    }
    const Float width = pieces[i + 1].below - pieces[i].below;
    const Float t = width > 0 ? std::min((u - pieces[i].below) / width, OneMinusEpsilon) : 0;
    return {(Float(i) + t) / Float(n_), i, pieces[i]};
}

}  // namespace pbrt
