#pragma once
#include <optional>
#include <span>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/math/bounds.h"
#include "pbrt/math/piecewise_constant_rows.h"

namespace pbrt {

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
