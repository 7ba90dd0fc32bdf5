#pragma once
#include "pbrt/math/fast_functions.h"
#include "pbrt/math/warps.h"
#include "pbrt/shapes/shape.h"

namespace pbrt {

// Uniform solid-angle sampling about the origin; densities are 1 / area. Triangle corners are unit vectors. The
// rectangle uses double precision, because small ones are differences of nearly equal angles.

/// In double precision where corners may be nearly antipodal.
template <class T>
class SphericalTriangleOf {
  public:
    using Vector = glm::vec<3, T>;
    SphericalTriangleOf() = default;
    SphericalTriangleOf(const Vector &a, const Vector &b, const Vector &c) : a_(a), b_(b), c_(c) {
        // Corner differences keep precision for small triangles:
        //     cos(bc) - cos(ab) cos(ac) = (b-a).(c-a) - (1 - cos(ab)) (1 - cos(ac)).
        const Vector toB = b - a, toC = c - a;
        volume_ = std::abs(glm::dot(a, Product(toB, toC)));
        versineAB_ = Squared(toB) / 2;
        versineAC_ = Squared(toC) / 2;
        coversineAB_ = OneMinus(versineAB_ / 2, a, b) * 2;
        coversineAC_ = OneMinus(versineAC_ / 2, a, c) * 2;
        product_ = glm::dot(toB, toC) - versineAB_ * versineAC_;
        // Van Oosterom and Strackee 1983.
        area_ = 2 * Angle(volume_, 4 - versineAB_ - versineAC_ - Squared(b - c) / 2);
    }

    T Area() const { return area_; }
    /// Weights (A, B, C) of direction A a + B b + C c, uniform in the triangle (Arvo 1995): u.x picks a point on the
    /// arc a-c that cuts off the fraction u.x of the area, u.y moves from b towards it. Area() must be above 0.
    Vector Sample(const Point2 &u) const {
        // A triangle with sides p, q around the angle alpha has area E with
        //     tan(q/2) = sin(E/2) / (tan(p/2) sin(alpha - E/2)), which gives the side a-c' that cuts off E = u.x *
        //     area, without cancellation for small E. Here p = ab, volume = sin(ab) sin(ac) sin(alpha), product =
        //     sin(ab) sin(ac) cos(alpha). The square root of sin(ac)^2 cancels in t = tan(q/2) / sin(ac) and in c' =
        //     (sin(ac - q) a + sin(q) c) / sin(ac).
        T sin, cos;
        SinCosOfHalf(T(u.x) * area_, &sin, &cos);
        const T denominator = volume_ * cos - product_ * sin;
        const T numerator = sin * coversineAB_;
        const T longest = coversineAC_;  // its inverse is tan(ac/2) / sin(ac)
        const T t = numerator * longest < denominator ? numerator / denominator : 1 / longest;
        const T tangent2 = t * t * versineAC_ * longest, scale = 1 / (1 + tangent2);
        const T cutC = 2 * t * scale, cutA = std::max(T(0), 1 - tangent2 - 2 * t * (1 - versineAC_)) * scale;

        // h = 1 - cos of the arc from b; its tangent has length sqrt(k (1 - k/4)) for squared chord k.
        const Vector cut = cutA * a_ + cutC * c_;
        const T v = T(u.y), k = Squared(cut - b_), h = v * k / 2;
        const T along = std::sqrt(v * (1 - v * (k / 4)) / std::max(OneMinus(k / 4, cut, b_), kMinCoversine));
        return {along * cutA, std::max(T(0), 1 - h - along * (1 - k / 2)), along * cutC};
    }
    /// Inverts Sample at unit direction w with these weights, up to a common factor.
    Point2 Invert(const Vector &weights, const Vector &w) const {
        const Vector cutDirection = weights.x * a_ + weights.z * c_;
        const T length = std::sqrt(Squared(cutDirection));
        if (!(length > 0)) return {Float(0.5), 0};  // the direction is b, for every u.x
        const Vector cut = cutDirection / length;
        const T across = Squared(cut - b_);
        const T area = 2 * Angle(volume_ * (weights.z / length), 4 - versineAB_ - (Squared(cut - a_) + across) / 2);
        const T y = across > 0 ? Squared(w - b_) / across : 0;
        return {std::clamp(Float(area / area_), Float(0), Float(1)), std::clamp(Float(y), Float(0), Float(1))};
    }
    Vector Direction(const Vector &weights) const { return weights.x * a_ + weights.y * b_ + weights.z * c_; }
    /// Weights of direction w, up to a common factor.
    Vector WeightsOf(const Vector &w) const {
        const T sign = glm::dot(a_, Product(b_, c_)) < 0 ? -1 : 1;
        auto weight = [&](const Vector &p, const Vector &q) {
            return std::max(T(0), sign * glm::dot(w, Product(p, q)));
        };
        return {weight(b_, c_), weight(c_, a_), weight(a_, b_)};
    }

  private:
    static constexpr bool kIsDouble = std::is_same_v<T, double>;
    static constexpr T kMinCoversine = kIsDouble ? T(1e-30) : T(MachineEpsilon);
    static T Squared(const Vector &v) { return glm::dot(v, v); }
    static Vector Product(const Vector &a, const Vector &b) {
        if constexpr (kIsDouble) return glm::cross(a, b);
        else return Cross(a, b);
    }
    static T Angle(T y, T x) {
        if constexpr (kIsDouble) return std::atan2(y, x);
        else return ArcTangent2(y, x);
    }
    static void SinCosOfHalf(T angle, T *sin, T *cos) {
        if constexpr (kIsDouble) {
            *sin = std::sin(angle / 2);
            *cos = std::cos(angle / 2);
        } else {
            const SineCosine half = SineCosineOfTurn(angle * (Inv2Pi / 2));
            *sin = half.sin;
            *cos = half.cos;
        }
    }
    /// 1 - k / 4 for the squared chord k between unit vectors.
    static T OneMinus(T quarter, const Vector &p, const Vector &q) {
        if constexpr (kIsDouble) return Squared(p + q) / 4;
        else return 1 - quarter;
    }

    Vector a_, b_, c_;
    T volume_;                     ///< absolute triple product of the corners
    T versineAB_, versineAC_;      ///< 1 - cos of the sides
    T coversineAB_, coversineAC_;  ///< 1 + cos
    T product_;                    ///< sin(ab) sin(ac) cos(angle at a)
    T area_;
};
using SphericalTriangle = SphericalTriangleOf<Float>;

/// Rectangle corner + s * edgeX + t * edgeY, 0 <= s, t <= 1, as seen from `eye`; edges orthogonal.
class SphericalRectangle {
  public:
    SphericalRectangle() = default;
    SphericalRectangle(const Point3 &eye, const Point3 &corner, const Vector3 &edgeX, const Vector3 &edgeY);

    Float SolidAngle() const { return Float(area_); }
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

/// Sampling of directions to a triangle from a point. Inline, to stay in registers.
///
/// With a receiver normal, the density is nearly proportional to the receiver cosine, interpolated between the corners
/// with a minimum of about 0.01; otherwise it is uniform by solid angle. Triangles small for their distance are sampled
/// in their plane: area sampling has solid-angle density d^3 / (area * height) at distance d, which is equalised
/// together with the cosine. Larger ones are sampled on the sphere, in double precision if they have nearly antipodal
/// corners: there most of the solid angle belongs to little of the triangle.
class TriangleSampling {
  public:
    TriangleSampling(const ShapeSampleContext &from, const Point3 &p0, const Point3 &p1, const Point3 &p2)
        : view_{from.p, p0, p1, p2}, to0_(p0 - from.p), to1_(p1 - from.p), to2_(p2 - from.p), edge1_(p1 - p0),
          edge2_(p2 - p0) {
        const Float d0 = LengthSquared(to0_), d1 = LengthSquared(to1_), d2 = LengthSquared(to2_);
        const Float nearest = std::min(std::min(d0, d1), d2);
        const Float size = std::max(std::max(LengthSquared(edge1_), LengthSquared(edge2_)), DistanceSquared(p1, p2));
        inPlane_ = !(size > kMaxSizeSquared * nearest && nearest > 0 && TrySphere(from));
        if (!inPlane_) return;
        volume_ = std::abs(Dot(Cross(edge1_, edge2_), to0_));
        if (!(nearest > 0)) {
            SetWeights(1, 1, 1);
            return;
        }
        const Float ratio0 = d1 / d0, ratio2 = d1 / d2;
        if (from.ns == Normal3(0)) {
            SetWeights(ratio0 * std::sqrt(ratio0), 1, ratio2 * std::sqrt(ratio2));
            return;
        }
        const Float min = Float(0.01) * std::sqrt(d1);
        SetWeights(std::max(min, AbsDot(from.ns, to0_)) * (ratio0 * ratio0), std::max(min, AbsDot(from.ns, to1_)),
                   std::max(min, AbsDot(from.ns, to2_)) * (ratio2 * ratio2));
    }

    struct Point {
        Vector3 barycentrics;
        Float pdf;  ///< solid angle; 0 or infinite if sampling fails
        /// From the receiver, where float barycentrics are too coarse for it; else 0.
        Vector3 offset{0};
    };
    Point Sample(const Point2 &u) const {
        const Point2 square = SampleBilinear(u, weights_);
        if (inDouble_) [[unlikely]]
            return SampleInDouble(view_, square, BilinearPdf(square, weights_));
        if (inPlane_) {
            const Float t = std::sqrt(square.y), across = t * square.x;
            const Vector3 b(t - across, 1 - t, across);
            return {b, InPlane(square, b)};
        }
        const Vector3 b = sphere_.Sample(square) / distance_;
        return {b / (b.x + b.y + b.z), BilinearPdf(square, weights_) / sphere_.Area()};
    }
    /// Density of Sample in direction wi, which must hit the triangle.
    Float Pdf(const Vector3 &wi) const {
        if (inDouble_) [[unlikely]] {
            Float area;
            const Point2 square = InvertInDouble(view_, wi, &area);
            return BilinearPdf(square, weights_) / area;
        }
        // Hit with the triangle's plane, possibly outside the triangle by rounding.
        const Vector3 k = Cross(wi, edge2_);
        const Float determinant = Dot(k, edge1_);
        if (determinant == 0) return 0;
        const Float inverse = 1 / determinant;
        Vector3 b(0, std::clamp(-Dot(to0_, k) * inverse, Float(0), Float(1)),
                  std::clamp(Dot(wi, Cross(edge1_, to0_)) * inverse, Float(0), Float(1)));
        if (const Float sum = b.y + b.z; sum > 1) b /= sum;
        b.x = std::max(Float(0), 1 - b.y - b.z);
        if (!inPlane_) return BilinearPdf(sphere_.Invert(b * distance_, wi), weights_) / sphere_.Area();
        const Float t = b.x + b.z;
        return InPlane({t > 0 ? b.z / t : Float(0.5), t * t}, b);
    }
    bool IsInPlane() const { return inPlane_; }
    bool IsInDouble() const { return inDouble_; }

    /// Limit, for sampling in the plane, of the squared longest side relative to the squared distance of the nearest
    /// corner. At the limit a diffuse receiver has a mean relative variance of 0.003, as on the sphere with
    /// interpolated cosines without SetWeights (see the test).
    static constexpr Float kMaxSizeSquared = 0.2f;
    /// Limits in sr for the sphere: below, rounding dominates the angles; above, the triangle is nearly a hemisphere.
    static constexpr Float kMinSolidAngle = 2e-4f, kMaxSolidAngle = 6.22f;
    /// Of the squared chord between corners as seen from the receiver; above, double precision is used.
    static constexpr Float kMaxChordSquared = 3.99f;

  private:
    struct View {
        Point3 from, p0, p1, p2;
    };
    struct InDouble;
    static double AreaInDouble(View view);
    static Point SampleInDouble(View view, Point2 square, Float squarePdf);
    static Point2 InvertInDouble(View view, Vector3 wi, Float *area);
    static bool IsOnSphere(double area) { return area >= double(kMinSolidAngle) && area <= double(kMaxSolidAngle); }

    /// Sets the corner values of a linear density. In the square it depends on sqrt(y), because a row is the fraction y
    /// of the area away from corner 1. The root is replaced by its least-squares line 4/15 + 12/15 y.
    void SetWeights(Float at0, Float at1, Float at2) {
        constexpr Float kNear = Float(4) / 15, kFar = Float(16) / 15, kMin = 0.02f;
        auto between = [&](Float other, Float t) { return std::max(at1 + (other - at1) * t, kMin * at1); };
        weights_[0] = between(at0, kNear);
        weights_[1] = between(at2, kNear);
        weights_[2] = between(at0, kFar);
        weights_[3] = between(at2, kFar);
    }

    bool TrySphere(const ShapeSampleContext &from) {
        distance_ = {Length(to0_), Length(to1_), Length(to2_)};
        const Vector3 a = to0_ / distance_.x, b = to1_ / distance_.y, c = to2_ / distance_.z;
        const Float chord = std::max(std::max(DistanceSquared(a, b), DistanceSquared(a, c)), DistanceSquared(b, c));
        if (chord > kMaxChordSquared) [[unlikely]] {
            inDouble_ = IsOnSphere(AreaInDouble(view_));
            if (!inDouble_) return false;
        } else {
            sphere_ = SphericalTriangle(a, b, c);
            if (!IsOnSphere(double(sphere_.Area()))) return false;
        }
        if (from.ns == Normal3(0)) SetWeights(1, 1, 1);
        else
            SetWeights(std::max(Float(0.01), AbsDot(from.ns, a)), std::max(Float(0.01), AbsDot(from.ns, b)),
                       std::max(Float(0.01), AbsDot(from.ns, c)));
        return true;
    }

    Float InPlane(const Point2 &square, const Vector3 &barycentrics) const {
        const Float d2 = LengthSquared(barycentrics.x * to0_ + barycentrics.y * to1_ + barycentrics.z * to2_);
        return BilinearPdf(square, weights_) * 2 * d2 * std::sqrt(d2) / volume_;
    }

    View view_;
    Vector3 to0_, to1_, to2_;  ///< corners relative to the receiver
    Vector3 edge1_, edge2_;
    Float weights_[4];  ///< for SampleBilinear over the square whose side y = 0 is corner 1
    bool inPlane_, inDouble_ = false;
    Float volume_;      ///< in the plane: absolute triple product of the corners
    Vector3 distance_;  ///< on the sphere: of the corners
    SphericalTriangle sphere_;
};

/// Sampling of a rectangle from a point; (s, t) is corner + s * edgeX + t * edgeY. As TriangleSampling: in its plane if
/// small for its distance, else on the sphere.
class RectangleSampling {
  public:
    RectangleSampling(const ShapeSampleContext &from, const Point3 &corner, const Vector3 &edgeX, const Vector3 &edgeY)
        : corner_(corner), edgeX_(edgeX), edgeY_(edgeY), toCorner_(corner - from.p) {
        const Vector3 to[4] = {toCorner_, toCorner_ + edgeX, toCorner_ + edgeY, toCorner_ + edgeX + edgeY};
        Float d2[4];
        for (int i = 0; i < 4; ++i) d2[i] = LengthSquared(to[i]);
        const Float nearest = std::min(std::min(d2[0], d2[1]), std::min(d2[2], d2[3]));
        const bool hasNormal = from.ns != Normal3(0) && nearest > 0;
        inPlane_ = !(LengthSquared(edgeX) + LengthSquared(edgeY) > kMaxSizeSquared * nearest);
        if (!inPlane_) {
            sphere_ = SphericalRectangle(from.p, corner, edgeX, edgeY);
            inPlane_ = !(sphere_.SolidAngle() > kMinSolidAngle);
        }
        if (!inPlane_) {
            for (int i = 0; i < 4; ++i)
                weights_[i] = hasNormal ? std::max(Float(0.01), AbsDot(from.ns, to[i]) / std::sqrt(d2[i])) : Float(1);
            return;
        }
        volume_ = std::abs(Dot(Cross(edgeX, edgeY), toCorner_));
        const Float min = Float(0.01) * std::sqrt(d2[0]);
        for (int i = 0; i < 4; ++i) {
            const Float ratio = nearest > 0 ? d2[0] / d2[i] : Float(1);
            weights_[i] =
                hasNormal ? std::max(min, AbsDot(from.ns, to[i])) * (ratio * ratio) : ratio * std::sqrt(ratio);
        }
    }

    struct Point {
        Point2 st;
        Float pdf;  ///< solid angle; 0 or infinite if sampling fails
    };
    Point Sample(const Point2 &u) const {
        const Point2 square = SampleBilinear(u, weights_);
        if (inPlane_) return {square, InPlane(square)};
        return {sphere_.Sample(square), BilinearPdf(square, weights_) / sphere_.SolidAngle()};
    }
    /// Density of Sample at p, a point of the rectangle, by solid angle.
    Float Pdf(const Point3 &p) const {
        if (!inPlane_) return BilinearPdf(sphere_.Invert(p), weights_) / sphere_.SolidAngle();
        const Vector3 s = p - corner_;
        return InPlane({std::clamp(Dot(s, edgeX_) / LengthSquared(edgeX_), Float(0), Float(1)),
                        std::clamp(Dot(s, edgeY_) / LengthSquared(edgeY_), Float(0), Float(1))});
    }
    bool IsInPlane() const { return inPlane_; }

    /// As in TriangleSampling, of the diagonal. Relative variance at the limit: 0.001.
    static constexpr Float kMaxSizeSquared = 0.2f;
    /// sr; smaller rectangles are sampled in their plane.
    static constexpr Float kMinSolidAngle = 1e-4f;

  private:
    Float InPlane(const Point2 &st) const {
        const Float d2 = LengthSquared(toCorner_ + st.x * edgeX_ + st.y * edgeY_);
        return BilinearPdf(st, weights_) * d2 * std::sqrt(d2) / volume_;
    }
    Point3 corner_;
    Vector3 edgeX_, edgeY_, toCorner_;
    Float weights_[4];  ///< for SampleBilinear
    bool inPlane_;
    Float volume_;  ///< in the plane: absolute triple product of edges and vector to the corner
    SphericalRectangle sphere_;
};

}  // namespace pbrt
