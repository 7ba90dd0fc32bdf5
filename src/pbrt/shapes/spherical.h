#pragma once
#include "pbrt/math/fast_functions.h"

namespace pbrt {

// Uniform solid-angle sampling about the origin; densities are 1 / area. Triangle corners are unit vectors. The
// rectangle uses double precision, because small ones are differences of nearly equal angles.

class SphericalTriangle {
  public:
    SphericalTriangle() = default;
    SphericalTriangle(const Vector3 &a, const Vector3 &b, const Vector3 &c) : a_(a), b_(b), c_(c) {
        // Corner differences keep precision for small triangles:
        //     cos(bc) - cos(ab) cos(ac) = (b-a).(c-a) - (1 - cos(ab)) (1 - cos(ac)).
        const Vector3 toB = b - a, toC = c - a;
        volume_ = std::abs(Dot(a, Cross(toB, toC)));
        versineAB_ = LengthSquared(toB) / 2;
        versineAC_ = LengthSquared(toC) / 2;
        product_ = Dot(toB, toC) - versineAB_ * versineAC_;
        // Van Oosterom and Strackee 1983.
        area_ = 2 * ArcTangent2(volume_, 4 - versineAB_ - versineAC_ - DistanceSquared(b, c) / 2);
    }

    Float Area() const { return area_; }
    /// Weights (A, B, C) of direction A a + B b + C c, uniform in the triangle (Arvo 1995): u.x picks a point on the
    /// arc a-c that cuts off the fraction u.x of the area, u.y moves from b towards it. Area() must be above 0.
    Vector3 Sample(const Point2 &u) const {
        // A triangle with sides p, q around the angle alpha has area E with
        //     tan(q/2) = sin(E/2) / (tan(p/2) sin(alpha - E/2)), which gives the side a-c' that cuts off E = u.x *
        //     area, without cancellation for small E. Here p = ab, volume = sin(ab) sin(ac) sin(alpha), product =
        //     sin(ab) sin(ac) cos(alpha). The square root of sin(ac)^2 cancels in t = tan(q/2) / sin(ac) and in c' =
        //     (sin(ac - q) a + sin(q) c) / sin(ac).
        const SineCosine halfE = SineCosineOfTurn(u.x * area_ * (Inv2Pi / 2));
        const Float denominator = volume_ * halfE.cos - product_ * halfE.sin;
        const Float numerator = halfE.sin * (2 - versineAB_);
        const Float longest = 2 - versineAC_;  // its inverse is tan(ac/2) / sin(ac)
        const Float t = numerator * longest < denominator ? numerator / denominator : 1 / longest;
        const Float tangent2 = t * t * versineAC_ * longest, scale = 1 / (1 + tangent2);
        const Float cutC = 2 * t * scale, cutA = std::max(Float(0), 1 - tangent2 - 2 * t * (1 - versineAC_)) * scale;

        // h = 1 - cos of the arc from b; its tangent has length sqrt(k (1 - k/4)) for squared chord k.
        const Float k = DistanceSquared(cutA * a_ + cutC * c_, b_), h = u.y * k / 2;
        const Float along = std::sqrt(u.y * (1 - u.y * (k / 4)) / std::max(1 - k / 4, MachineEpsilon));
        return {along * cutA, std::max(Float(0), 1 - h - along * (1 - k / 2)), along * cutC};
    }
    /// Inverts Sample at unit direction w with these weights, up to a common factor.
    Point2 Invert(const Vector3 &weights, const Vector3 &w) const {
        const Vector3 cutDirection = weights.x * a_ + weights.z * c_;
        const Float length = Length(cutDirection);
        if (!(length > 0)) return {Float(0.5), 0};  // the direction is b, for every u.x
        const Vector3 cut = cutDirection / length;
        const Float across = DistanceSquared(cut, b_);
        const Float area =
            2 * ArcTangent2(volume_ * (weights.z / length), 4 - versineAB_ - (DistanceSquared(cut, a_) + across) / 2);
        const Float y = across > 0 ? DistanceSquared(w, b_) / across : 0;
        return {std::clamp(area / area_, Float(0), Float(1)), std::clamp(y, Float(0), Float(1))};
    }
    Vector3 Direction(const Vector3 &weights) const { return weights.x * a_ + weights.y * b_ + weights.z * c_; }

  private:
    Vector3 a_, b_, c_;
    Float volume_;                 ///< absolute triple product of the corners
    Float versineAB_, versineAC_;  ///< 1 - cos of the sides
    Float product_;                ///< sin(ab) sin(ac) cos(angle at a)
    Float area_;
};

/// Rectangle corner + s * edgeX + t * edgeY, 0 <= s, t <= 1, as seen from `eye`; edges orthogonal.
class SphericalRectangle {
  public:
    SphericalRectangle() = default;
    SphericalRectangle(const Point3 &eye, const Point3 &corner, const Vector3 &edgeX, const Vector3 &edgeY);

    Float SolidAngle() const { return static_cast<Float>(area_); }
    /// Position (s, t) on the rectangle; uniform by solid angle for uniform u.
    Point2 Sample(const Point2 &u) const;
    /// Inverts Sample at p, a point of the rectangle.
    Point2 Invert(const Point3 &p) const;

  private:
    double AreaLeftOf(double x) const;
    Point3 eye_;
    Vector3 axisX_, axisY_;
    double x0_, x1_, y0_, y1_, z_;  ///< in the rectangle's frame, eye at the origin
    double b0_, b1_;                ///< sines of the elevations of the sides y0 and y1
    double left_, area_;
};

}  // namespace pbrt
