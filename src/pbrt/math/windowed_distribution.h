#pragma once
#include <optional>
#include <span>
#include <vector>

#include "pbrt/math/bounds.h"

namespace pbrt {

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
    double Corner(int i, int j) const {
        return sums_[static_cast<size_t>(j) * static_cast<size_t>(nx_ + 1) + static_cast<size_t>(i)];
    }
    /// Column sums between two heights. Points into the table.
    struct Band {
        const double *low, *high;  ///< rows below the heights
        size_t stride;
        double inLow, inHigh;  ///< fractions of the heights above these rows
        double operator()(int i) const {
            const auto at = [&](const double *row, double in) {
                return row[i] + in * (row[stride + static_cast<size_t>(i)] - row[i]);
            };
            return at(high, inHigh) - at(low, inLow);
        }
    };
    Band BandOf(const Cells &w) const;
    const double *ColumnSums(int i) const {
        return columns_.data() + static_cast<size_t>(i) * static_cast<size_t>(ny_ + 1);
    }
    double Total(const Cells &w) const;
    Float Density(const Point2 &p, double integral) const;

    int nx_ = 0, ny_ = 0;
    std::vector<double> sums_;     ///< summed-area table of (nx + 1) * (ny + 1) corners
    std::vector<double> columns_;  ///< sums up to each row of every column, column by column: ny + 1 each
};

}  // namespace pbrt
