#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pbrt/math/bounds.h"

namespace pbrt {

/// Densities that are constant on n equal pieces of a segment, one per row. What a search reads lies side by side, as
/// the tables of an environment map are larger than the caches.
class PiecewiseConstantRows {
  public:
    PiecewiseConstantRows() = default;
    PiecewiseConstantRows(size_t rows, size_t n);

    size_t Rows() const { return rows_; }
    size_t PieceCount() const { return n_; }
    /// Density of a row in proportion to |f|, n values; uniform if f is 0. Returns the integral of |f| over `length`.
    Float Set(size_t row, std::span<const Float> f, double length);
    struct Sampled {
        Float place;  ///< in [0, 1) of the length
        Float pdf;    ///< with respect to the length
        size_t piece;
    };
    Sampled Sample(size_t row, Float u) const;
    Float Pdf(size_t row, size_t piece) const { return pieces_[row * (n_ + 1) + piece].pdf; }

  private:
    struct Piece {
        Float below = 0;  ///< probability of the pieces before this one
        Float pdf = 0;
    };
    size_t rows_ = 0, n_ = 0, cutCount_ = 0;
    std::vector<Piece> pieces_;  ///< n and an end per row
    /// Lookup table of a row: entry k is the piece that contains k / cutCount_, so the piece of u lies between
    /// neighbouring entries. cutCount_ is a power of two, so that u cutCount_ is exact.
    std::vector<uint32_t> cuts_;
};

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
    PiecewiseConstantRows row_;
    Float low_ = 0, high_ = 1, last_ = OneMinusEpsilon, integral_ = 0;  ///< last_: largest number below high_
};

/// Density on the unit square, constant on nx * ny cells (row-major, x fastest), proportional to |f|.
class PiecewiseConstant2D {
  public:
    PiecewiseConstant2D() = default;
    PiecewiseConstant2D(std::span<const Float> f, int nx, int ny);

    Point2 Sample(const Point2 &u, Float *pdf) const;
    Float Pdf(const Point2 &p) const;

  private:
    PiecewiseConstantRows rows_;
    PiecewiseConstant1D marginal_;
};

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
