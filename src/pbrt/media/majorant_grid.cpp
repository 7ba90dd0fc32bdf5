#include "pbrt/media/medium.h"

#include "pbrt/core/error.h"
#include "pbrt/core/parallel.h"

namespace pbrt {

MajorantGrid::MajorantGrid(const glm::ivec3 &resolution, const std::function<Float(const glm::ivec3 &)> &bound)
    : resolution_(resolution) {
    PBRT_CHECK(resolution.x > 0 && resolution.y > 0 && resolution.z > 0);
    values_.resize(size_t(1) * resolution.x * resolution.y * resolution.z);
    ParallelForEach(int64_t(resolution.y) * resolution.z, [&](int64_t i) {
        const int y = int(i % resolution.y), z = int(i / resolution.y);
        for (int x = 0; x < resolution.x; ++x) values_[i * resolution.x + x] = bound({x, y, z});
    });
    for (Float v : values_) PBRT_CHECK_MSG(v >= 0 && std::isfinite(v), "majorant {}", v);
}

GridWalk::GridWalk(const MajorantGrid &grid, const AffineMap &gridFromRender, const Ray &ray, Float tMax)
    : grid_(&grid), isDone_(true), size_(grid.Resolution()) {
    const glm::dvec3 o = gridFromRender.Point(ray.o), d = gridFromRender.Vector(ray.d);
    double begin = 0, end = double(tMax);
    for (int a = 0; a < 3; ++a) {
        const double size = size_[a];
        if (d[a] == 0) {  // along two of the borders, which count as inside
            if (!(o[a] >= 0 && o[a] <= size)) end = -1;
            continue;
        }
        const double toLow = -o[a] / d[a], toHigh = (size - o[a]) / d[a];
        begin = std::max(begin, std::min(toLow, toHigh));
        end = std::min(end, std::max(toLow, toHigh));
    }
    anchor_ = Float(begin);
    end_ = std::min(Float(end), tMax);
    if (!(anchor_ <= end_)) {
        anchor_ = Infinity;
        end_ = -Infinity;
        return;
    }
    origin_ = Point3(o + d * double(anchor_));
    direction_ = Vector3(d);
    for (int a = 0; a < 3; ++a) {
        // Directions too small for division do not move within the box.
        const bool moves = std::isfinite(1 / direction_[a]);
        step_[a] = moves ? (direction_[a] > 0 ? 1 : -1) : 0;
        cell_[a] = std::clamp(int(std::floor(origin_[a])), 0, size_[a] - 1);
        exit_[a] = ExitOf(a);
    }
    isDone_ = !(anchor_ < end_);
}

bool GridWalk::Next(Float *begin, Float *end, Float *value) {
    if (!grid_) {
        if (isDone_ || !(end_ > 0)) return false;
        isDone_ = true;
        *begin = 0;
        *end = end_;
        *value = 1;
        return true;
    }
    while (!isDone_) {
        const glm::ivec3 cell = cell_;
        const int axis = exit_.x < exit_.y ? (exit_.x < exit_.z ? 0 : 2) : (exit_.y < exit_.z ? 1 : 2);
        // Rounding must not reverse: a border behind gives an empty segment.
        const Float from = anchor_ + now_;
        Float &exit = Component(exit_, axis);
        int &here = Component(cell_, axis);
        now_ = std::max(now_, exit);
        Float to = anchor_ + now_;
        here += Component(step_, axis);
        if (to < end_ && here >= 0 && here < Component(size_, axis)) {
            exit = ExitOf(axis);
        } else {  // outside the box; a rest by rounding belongs to the last cell
            to = end_;
            isDone_ = true;
        }
        if (!(from < to)) continue;
        const Float bound = (*grid_)(cell);
        if (bound == 0) continue;
        here_ = cell;
        hereBegin_ = *begin = from;
        hereEnd_ = *end = to;
        *value = bound;
        return true;
    }
    return false;
}

}  // namespace pbrt
