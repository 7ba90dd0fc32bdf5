#pragma once
#include <array>
#include <optional>
#include <vector>

#include "pbrt/math/distributions.h"
#include "pbrt/math/frame.h"

namespace pbrt {

class EnvironmentLight;

/// Radiance of an environment light over the half-space z > 0 of a frame. A rectangle with sides along x and y is an
/// axis-aligned window on the map, from any point before it. Map coordinates of a direction (x, y, z) are its slopes a
/// = x / z and b = y / z, mapped to (0, 1) by (1 + a / (1 + |a|)) / 2. (Bitterli, Wyman and Pharr 2015, Portal-Masked
/// Environment Map Sampling, use the arc tangent; this avoids trigonometry.)
///
/// Within a window, directions are sampled in proportion to the mean radiance of the map's pixels. Bright high-contrast
/// pixels are subdivided once: the rim of a sun would be noisy otherwise.
class PortalMap {
  public:
    PortalMap(const EnvironmentLight &light, const Frame &frame);

    static Float FromSlope(Float a) { return Float(0.5) + Float(0.5) * a / (1 + std::abs(a)); }
    static Float ToSlope(Float s) {
        const Float v = 2 * s - 1;
        return v / (1 - std::abs(v));
    }
    static Point2 FromSlopes(const Vector2 &a) { return {FromSlope(a.x), FromSlope(a.y)}; }
    static Vector2 ToSlopes(const Point2 &st) { return {ToSlope(st.x), ToSlope(st.y)}; }
    /// Solid angle per map area.
    static Float SolidAngleDensity(const Vector2 &a) {
        const Float x = 1 + std::abs(a.x), y = 1 + std::abs(a.y), z2 = 1 / (1 + a.x * a.x + a.y * a.y);
        return 4 * Sqr(x * y) * z2 * std::sqrt(z2);
    }

    /// Integral over a window of mean radiance (EnvironmentLight::MeanRadiance) and solid angle.
    Float Integral(const Bounds2 &window) const { return Float(pixels_.Integral(window)); }
    /// The same over a slightly larger window; a fraction of the cost.
    Float IntegralAround(const Bounds2 &window) const { return pixels_.IntegralAround(window); }
    /// Samples a direction (unit, in the frame) within the window; density by solid angle. Empty where the window has
    /// no radiance.
    std::optional<Vector3> SampleDirection(const Point2 &u, const Bounds2 &window, Float *pdf) const;
    /// Density of SampleDirection; 0 outside the window. `local`: in the frame.
    Float DirectionPdf(const Vector3 &local, const Bounds2 &window) const;
    size_t Bytes() const;

  private:
    struct Sample {
        Point2 st;
        Float pdf;  ///< by map area
    };
    std::optional<Sample> Draw(const Point2 &u, const Bounds2 &window) const;
    Float Pdf(const Point2 &st, const Bounds2 &window) const;

    static constexpr int kDetail = 8;
    /// Subpixel values; their mean is the pixel's value.
    using Detail = std::array<Float, kDetail * kDetail>;
    /// A subdivided pixel, clipped to a window.
    struct Part {
        const Detail *detail;
        Bounds2 window;  ///< in subpixel units
        Float Overlap(int part, int axis) const {
            return std::min(window.high[axis], Float(part + 1)) - std::max(window.low[axis], Float(part));
        }
        int First(int axis) const { return std::clamp(int(window.low[axis]), 0, kDetail - 1); }
        int Last(int axis) const { return std::clamp(int(window.high[axis]), 0, kDetail - 1); }
        Float OfColumn(int x) const;
        Float Sum() const;
    };
    /// Empty if the pixel is not subdivided. *pixel: its position.
    std::optional<Part> PartAt(const Point2 &st, const Bounds2 &window, Point2 *pixel) const;

    int n_ = 0;
    WindowedPiecewiseConstant2D pixels_;
    std::vector<uint32_t> detailOf_;  ///< per pixel: index in details_ + 1; 0: none
    std::vector<Detail> details_;
};

}  // namespace pbrt
