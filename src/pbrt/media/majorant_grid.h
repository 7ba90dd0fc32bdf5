#pragma once
#include <functional>
#include <vector>

#include "pbrt/math/bounds.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// Upper bounds of a density in a regular grid of cells. Cell (x, y, z) is the cube from (x, y, z) to (x + 1, y + 1, z
/// + 1) in grid coordinates, which range from 0 to Resolution().
class MajorantGrid {
  public:
    MajorantGrid() = default;
    /// `bound` returns a cell's upper bound, finite and >= 0; it must be thread-safe.
    MajorantGrid(const glm::ivec3 &resolution, const std::function<Float(const glm::ivec3 &)> &bound);

    const glm::ivec3 &Resolution() const { return resolution_; }
    Float operator()(const glm::ivec3 &cell) const {
        return values_[(cell.z * resolution_.y + cell.y) * resolution_.x + cell.x];
    }
    size_t Bytes() const { return values_.size() * sizeof(Float); }

  private:
    glm::ivec3 resolution_{0};
    std::vector<Float> values_;
};

/// Affine map in double precision, so that boxes far from the rendering-space origin keep their cells.
struct AffineMap {
    glm::dmat3 linear{1};
    glm::dvec3 offset{0};

    AffineMap() = default;
    AffineMap(const glm::dmat3 &l, const glm::dvec3 &o) : linear(l), offset(o) {}
    explicit AffineMap(const glm::dmat4 &m) : linear(m), offset(m[3]) {}
    /// Maps the box from `low` to `high`, of non-zero extent, to that from 0 to `size`.
    static AffineMap ToBox(const glm::dvec3 &low, const glm::dvec3 &high, const glm::dvec3 &size) {
        const glm::dvec3 scale = size / (high - low);
        return {glm::dmat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z), -low * scale};
    }

    glm::dvec3 Point(const glm::dvec3 &p) const { return linear * p + offset; }
    glm::dvec3 Vector(const glm::dvec3 &v) const { return linear * v; }
    AffineMap operator*(const AffineMap &o) const { return {linear * o.linear, linear * o.offset + offset}; }
    AffineMap Inverse() const {
        const glm::dmat3 inverse = glm::inverse(linear);
        return {inverse, -(inverse * offset)};
    }
};

/// Traversal of a MajorantGrid, or of one unbounded cell, along a ray. A value of fixed size.
class GridWalk {
  public:
    /// One unbounded cell of value 1, from 0 to tMax.
    explicit GridWalk(Float tMax) : end_(tMax) {}
    /// Clips [0, tMax] to the box. `gridFromRender` maps to grid coordinates. The grid must outlive this object at a
    /// fixed address.
    GridWalk(const MajorantGrid &grid, const AffineMap &gridFromRender, const Ray &ray, Float tMax);

    /// Next segment in one cell of non-zero value; segments are in order and never empty. False if there are no more.
    bool Next(Float *begin, Float *end, Float *value);

    bool Contains(Float t) const { return t >= anchor_ && t <= end_; }
    /// Point on the ray in grid coordinates; only for walks through a grid, with t inside the box. Points of the
    /// current segment are in its cell regardless of rounding.
    Point3 At(Float t) const {
        const Point3 p = origin_ + direction_ * (t - anchor_);
        const bool isHere = t >= hereBegin_ && t <= hereEnd_;
        return isHere ? Min(Max(p, Point3(here_)), Point3(here_ + 1)) : Min(Max(p, Point3(0)), Point3(size_));
    }
    /// Distance at which the ray enters the grid; infinite if it misses.
    Float Anchor() const { return anchor_; }

  private:
    /// Distance from the anchor to the cell's next border along an axis.
    Float ExitOf(int axis) const {
        if (step_[axis] == 0) return Infinity;
        const int border = cell_[axis] + (step_[axis] > 0 ? 1 : 0);
        return (Float(border) - origin_[axis]) / direction_[axis];
    }

    const MajorantGrid *grid_ = nullptr;
    Float anchor_ = 0, end_ = 0;  ///< the ray's part in the box, by distance
    Float now_ = 0;               ///< distance from the anchor to the start of the current cell
    bool isDone_ = false;
    Point3 origin_{};  ///< position at the anchor, in grid coordinates
    Vector3 direction_{};
    glm::ivec3 cell_{0}, step_{0}, size_{0};
    Vector3 exit_{};  ///< distance from the anchor to each axis's border
    // Last segment of Next.
    glm::ivec3 here_{0};
    Float hereBegin_ = Infinity, hereEnd_ = -Infinity;
};

}  // namespace pbrt
