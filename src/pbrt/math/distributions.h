#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/math/bounds.h"

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
    /// The two entries of the lookup table that Sample(row, u) reads.
    const uint32_t *CutsAround(size_t row, Float u) const {
        return &cuts_[row * (cutCount_ + 1)] + std::min(size_t(u * Float(cutCount_)), cutCount_ - 1);
    }
    /// Prefetches the middle of the pieces between two cuts of a row, where Sample begins its search.
    void PrefetchPieces(size_t row, const uint32_t *cuts) const {
        const Piece *const middle = &At(row, (cuts[0] + cuts[1] + 1) / 2);
        __builtin_prefetch(middle);
        __builtin_prefetch(middle + kPiecesPerCut);
    }

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
    const uint32_t *const cut = CutsAround(row, u);
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

/// Density on [low, high), constant on n equal pieces, proportional to |f|; uniform if f is 0.
class PiecewiseConstant1D {
  public:
    PiecewiseConstant1D() = default;
    explicit PiecewiseConstant1D(std::span<const Float> f, Float low = 0, Float high = 1);

    struct Sampled {
        Float x;    ///< in [low, high)
        Float pdf;  ///< with respect to x
        int index;  ///< piece that contains x
    };
    Sampled Sample(Float u) const;
    Float Pdf(Float x) const;                     ///< 0 outside
    Float Integral() const { return integral_; }  ///< of |f| over [low, high)

  private:
    PiecewiseConstantRows<> row_;
    Float low_ = 0, high_ = 1, last_ = OneMinusEpsilon, integral_ = 0;  ///< last_: largest number below high_
};

/// Density on the unit square, constant on nx * ny cells (row-major, x fastest), proportional to |f|. Cells can carry
/// values, which lie beside their densities.
template <class Value = NoValue>
class PiecewiseConstantGrid {
  public:
    PiecewiseConstantGrid() = default;
    PiecewiseConstantGrid(std::span<const Float> f, int nx, int ny) : rows_(size_t(ny), size_t(nx)) {
        PBRT_CHECK(f.size() == size_t(nx) * size_t(ny));
        std::vector<Float> integrals;
        for (size_t y = 0; y < rows_.Rows(); ++y) integrals.push_back(rows_.Set(y, f.subspan(y * nx, nx), 1));
        marginal_ = PiecewiseConstant1D(integrals);
    }

    struct Sampled {
        Point2 p;
        Float pdf;
        const Value &value;
    };
    Sampled Sample(const Point2 &u) const {
        const PiecewiseConstant1D::Sampled y = marginal_.Sample(u.y);
        const auto x = rows_.Sample(size_t(y.index), u.x);
        return {{std::min(x.place, OneMinusEpsilon), y.x}, x.piece.pdf * y.pdf, x.piece.value};
    }
    /// Reads ahead for a later Sample(u), as tables larger than the caches are slow. The address of the second read is
    /// the result of the first, so time should pass in between.
    class Lookahead {
      public:
        Lookahead() = default;
        Lookahead(const PiecewiseConstantGrid &grid, const Point2 &u)
            : rows_(&grid.rows_), row_(size_t(grid.marginal_.Sample(u.y).index)), cuts_(rows_->CutsAround(row_, u.x)) {
            __builtin_prefetch(cuts_);
        }
        void Continue() const {
            if (rows_) rows_->PrefetchPieces(row_, cuts_);
        }

      private:
        const PiecewiseConstantRows<Value> *rows_ = nullptr;
        size_t row_ = 0;
        const uint32_t *cuts_ = nullptr;
    };
    Float Pdf(const Point2 &p) const {
        if (p.x < 0 || p.x > 1 || p.y < 0 || p.y > 1) return 0;
        return marginal_.Pdf(p.y) * rows_.At(Index(p.y, rows_.Rows()), Index(p.x, rows_.PieceCount())).pdf;
    }
    Value &ValueOf(int x, int y) { return rows_.At(size_t(y), size_t(x)).value; }
    const Value &ValueAt(const Point2 &p) const {
        return rows_.At(Index(p.y, rows_.Rows()), Index(p.x, rows_.PieceCount())).value;
    }

  private:
    static size_t Index(Float v, size_t n) { return std::min(size_t(std::max(v, Float(0)) * Float(n)), n - 1); }
    PiecewiseConstantRows<Value> rows_;
    PiecewiseConstant1D marginal_;
};
using PiecewiseConstant2D = PiecewiseConstantGrid<>;

/// Density on any axis-aligned window of the unit square, proportional to a function on nx * ny equal cells (row-major,
/// x fastest, >= 0). A summed-area table allows another window per call: sampling takes two searches, a density
/// four table corners (Bitterli, Wyman and Pharr 2015, Portal-Masked Environment Map Sampling).
class WindowedPiecewiseConstant2D {
  public:
    WindowedPiecewiseConstant2D() = default;
    WindowedPiecewiseConstant2D(std::span<const Float> f, int nx, int ny);

    /// Samples a point inside the window; pdf by area of the unit square. Empty if the function is 0 in the window.
    std::optional<Point2> Sample(const Point2 &u, const Bounds2 &window, Float *pdf) const;
    /// 0 outside the window.
    Float Pdf(const Point2 &p, const Bounds2 &window) const;
    double Integral(const Bounds2 &window) const;
    /// Integral over the cells that the window meets, four table corners: at least that of the window.
    Float IntegralAround(const Bounds2 &window) const;
    size_t Bytes() const { return (sums_.capacity() + columns_.capacity()) * sizeof(double); }

  private:
    /// Window in units of cells.
    struct Cells {
        double x0, x1, y0, y1;
    };
    Cells InCells(const Bounds2 &window) const;
    double Corner(int i, int j) const { return sums_[size_t(j) * (nx_ + 1) + i]; }
    /// Column sums between two heights. Points into the table.
    struct Band {
        const double *low, *high;  ///< rows below the heights
        size_t stride;
        double inLow, inHigh;  ///< fractions of the heights above these rows
        double operator()(int i) const {
            const auto at = [&](const double *row, double in) { return row[i] + in * (row[stride + i] - row[i]); };
            return at(high, inHigh) - at(low, inLow);
        }
    };
    Band BandOf(const Cells &w) const;
    const double *ColumnSums(int i) const { return columns_.data() + size_t(i) * (ny_ + 1); }
    double Total(const Cells &w) const;
    Float Density(const Point2 &p, double integral) const;

    int nx_ = 0, ny_ = 0;
    std::vector<double> sums_;     ///< summed-area table of (nx + 1) * (ny + 1) corners
    std::vector<double> columns_;  ///< sums up to each row of every column, column by column: ny + 1 each
};

/// Discrete distribution with O(1) sampling (Walker/Vose). Weights must be >= 0; uniform if all are 0.
class AliasTable {
  public:
    AliasTable() = default;
    explicit AliasTable(std::span<const Float> weights);

    struct Sampled {
        int index;
        Float pmf;
    };
    Sampled Sample(Float u) const;
    Float PMF(int i) const { return bins_[i].p; }
    size_t Bytes() const { return bins_.capacity() * sizeof(Bin); }

  private:
    struct Bin {
        Float q = 0;  ///< fraction of the column owned by the entry
        Float p = 0;  ///< probability
        int alias = -1;
    };
    std::vector<Bin> bins_;
};

}  // namespace pbrt
