#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pbrt/math/bounds.h"

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
    int Size() const { return static_cast<int>(f_.size()); }
    Float Value(int i) const { return f_[i]; }
    size_t Bytes() const {
        return (f_.capacity() + cdf_.capacity()) * sizeof(Float) + cuts_.capacity() * sizeof(uint32_t);
    }

  private:
    std::vector<Float> f_, cdf_;
    /// Lookup table: cuts_[k] is the piece that contains k / n, n = cuts_.size() - 1, so the piece of u lies between
    /// neighbouring entries. n is a power of two, so that u n is exact.
    std::vector<uint32_t> cuts_;
    Float low_ = 0, high_ = 1, last_ = OneMinusEpsilon, integral_ = 0;  ///< last_: largest number below high_
};

/// Density on a rectangle, constant on nx * ny cells (row-major, x fastest), proportional to |f|.
class PiecewiseConstant2D {
  public:
    PiecewiseConstant2D() = default;
    PiecewiseConstant2D(std::span<const Float> f, int nx, int ny, const Bounds2 &domain = {{0, 0}, {1, 1}});

    Point2 Sample(const Point2 &u, Float *pdf) const;
    Float Pdf(const Point2 &p) const;
    Float Integral() const { return marginal_.Integral(); }

  private:
    Bounds2 domain_;
    std::vector<PiecewiseConstant1D> rows_;
    PiecewiseConstant1D marginal_;
};

/// Discrete distribution with O(1) sampling (Walker/Vose). Weights must be >= 0; uniform if all are 0.
class AliasTable {
  public:
    AliasTable() = default;
    explicit AliasTable(std::span<const Float> weights);

    struct Sampled {
        int index;
        Float pmf;
        Float uRemapped;  ///< u rescaled within the chosen entry, uniform in [0, 1)
    };
    Sampled Sample(Float u) const;
    Float PMF(int i) const { return bins_[i].p; }
    int Size() const { return static_cast<int>(bins_.size()); }
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
