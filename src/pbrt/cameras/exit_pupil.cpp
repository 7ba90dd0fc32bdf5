#include "pbrt/cameras/exit_pupil.h"

#include <algorithm>
#include <array>

#include "pbrt/core/parallel.h"

namespace pbrt {
namespace {

constexpr int kSteps = 64;  // as in stock pbrt-v4, so that the same fraction of samples hits the pupil

bool IsEmpty(const Bounds2 &b) { return !(b.low.x <= b.high.x); }

Bounds2 Grow(const Bounds2 &b, const Vector2 &by) { return {b.low - by, b.high + by}; }

/// Finds the pupil of film points between two distances from the axis. Symmetric in y.
class Search {
  public:
    Search(const LensSystem &lens, Float low, Float high)
        : lens_(lens), film_{low, (low + high) / 2, high}, rear_(Float(1.5) * lens.RearRadius()) {}

    Bounds2 Find() {
        const Bounds2 whole{Point2(-rear_), Point2(rear_)};
        // Refines, because a coarse grid may miss a small stop.
        for (int n = 32; IsEmpty(found_) && n <= 512; n *= 2) Cover(whole, n);
        // Without a pupil the whole rear element is sampled, as in stock pbrt-v4; so missing a tiny pupil is harmless.
        if (IsEmpty(found_)) return whole;
        // The pupil extends little more than a grid step beyond the outermost hits.
        for (int n : {48, 96, 192}) Cover(Grow(found_, Float(1.5) * step_), n);
        return Grow(found_, Float(1.5) * step_);
    }

  private:
    void Cover(const Bounds2 &area, int n) {
        const Vector2 step((area.high.x - area.low.x) / Float(n), area.high.y / Float(n));
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const Point2 p = Point2(area.low.x, 0) + (Point2(i, j) + Point2(0.5f)) * step;
                if (p.x >= found_.low.x && p.x <= found_.high.x && p.y <= found_.high.y) continue;
                if (!Passes(p)) continue;
                found_.low = glm::min(found_.low, Point2(p.x, -p.y));
                found_.high = glm::max(found_.high, p);
            }
        step_ = step;
    }
    bool Passes(const Point2 &p) const {
        for (Float x : film_) {
            Ray ray;
            ray.o = {x, 0, 0};
            ray.d = Normalize(Point3(p, lens_.RearZ()) - ray.o);
            if (lens_.Trace(&ray) > 0) return true;
        }
        return false;
    }

    const LensSystem &lens_;
    std::array<Float, 3> film_;
    Float rear_;
    Bounds2 found_{Point2(Infinity), Point2(-Infinity)};
    Vector2 step_{0};
};

}  // namespace

ExitPupil::ExitPupil(const LensSystem &lens, Float filmRadius) : filmRadius_(filmRadius), bounds_(kSteps) {
    ParallelForEach(kSteps, [&](int64_t i) {
        auto distance = [&](int64_t step) { return Float(step) / kSteps * filmRadius; };
        bounds_[i] = Search(lens, distance(i), distance(i + 1)).Find();
    });
}

const Bounds2 &ExitPupil::Bounds(Float distance) const {
    const int step = int(distance / filmRadius_ * kSteps);
    return bounds_[std::min(step, kSteps - 1)];
}

Point2 ExitPupil::Sample(const Point2 &film, const Point2 &u) const {
    const Float distance = glm::length(film);
    const Point2 p = Bounds(distance).Lerp(u);
    if (!(distance > 0)) return p;
    const Vector2 direction = film / distance;
    return {direction.x * p.x - direction.y * p.y, direction.y * p.x + direction.x * p.y};
}

}  // namespace pbrt
