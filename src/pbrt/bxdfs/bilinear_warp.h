#pragma once
#include <array>
#include <vector>

#include "pbrt/math/vec.h"

namespace pbrt {

/// Slices of values on a regular grid over the unit square (row-major, x fastest, both ends included).
class GridSlices {
  public:
    GridSlices() = default;
    /// `values` holds whole slices; nx, ny >= 2.
    GridSlices(std::vector<Float> values, int nx, int ny) : values_(std::move(values)), nx_(nx), ny_(ny) {}

    /// Bilinear interpolation; p is clamped to the square.
    Float Evaluate(const Point2 &p, size_t slice) const;
    int Nx() const { return nx_; }
    int Ny() const { return ny_; }
    size_t Count() const { return values_.size() / nx_ / ny_; }
    Float At(size_t slice, int x, int y) const { return values_[(slice * ny_ + y) * nx_ + x]; }

  private:
    std::vector<Float> values_;
    int nx_ = 0, ny_ = 0;
};

/// Weighted mean of four slices (weights sum to 1).
struct SliceBlend {
    std::array<size_t, 4> slice;
    std::array<Float, 4> weight;
};

/// Densities over the unit square and the warp that samples a blend of them. Each slice is a density: the bilinear
/// interpolation of its values, normalised to 1.
class BilinearWarp {
  public:
    struct Mapped {
        Point2 p;
        Float pdf;  ///< by area, at the sampled point
    };
    BilinearWarp() = default;
    /// Values must be >= 0, with a positive one in every slice.
    BilinearWarp(const GridSlices &values);

    Mapped Sample(const Point2 &u, const SliceBlend &blend) const;
    Mapped Invert(const Point2 &p, const SliceBlend &blend) const;

  private:
    /// MassBelowRow: integral over the rows below knot row y. Left: integral along knot row y up to knot x. Density:
    /// value at a knot. Lengths are in grid cells.
    Float MassBelowRow(const SliceBlend &blend, int y) const { return Blend(blend, below_, y, ny_); }
    Float Left(const SliceBlend &blend, int x, int y) const { return Blend(blend, left_, Index(x, y), ny_ * nx_); }
    Float Density(const SliceBlend &blend, int x, int y) const {
        return Blend(blend, density_, Index(x, y), ny_ * nx_);
    }
    size_t Index(int x, int y) const { return y * nx_ + x; }
    static Float Blend(const SliceBlend &blend, const std::vector<Float> &table, size_t at, int perSlice) {
        Float sum = 0;
        for (size_t k = 0; k < 4; ++k)
            if (blend.weight[k] != 0) sum += blend.weight[k] * table[blend.slice[k] * perSlice + at];
        return sum;
    }
    Float CellArea() const { return Float(1) / Float((nx_ - 1) * (ny_ - 1)); }

    std::vector<Float> density_, left_, below_;
    int nx_ = 0, ny_ = 0;
};

}  // namespace pbrt
