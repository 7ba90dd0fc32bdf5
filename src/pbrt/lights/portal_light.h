#pragma once
#include <array>

#include "pbrt/images/image.h"
#include "pbrt/lights/environment_light.h"
#include "pbrt/lights/environment_portals.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// Environment light visible only through a rectangle, from one side (Bitterli, Wyman and Pharr 2015). As in stock
/// pbrt-v4 the image is resampled to a map over angles: atan(x/z) and atan(y/z) of a direction (x, y, z) in the
/// rectangle's frame. Radiance is constant per map pixel.
class PortalLight final : public EnvironmentLight {
  public:
    /// `image`: as for ImageInfiniteLight. `portal`: corners in order, in the source space of `renderFromPortal`; light
    /// travels against cross(p3 - p0, p1 - p0). The sides at p0 must not be degenerate or parallel. Non-rectangular
    /// corners are replaced by the rectangle from p0 to p2 with a side along p3 - p0.
    PortalLight(const Transform &renderFromLight, const Image &image, const ColorSpace &colorSpace, Float scale,
                const std::array<Point3, 4> &portal, const Transform &renderFromPortal);
    static bool IsRectangle(const std::array<Point3, 4> &portal);

    /// Entering power: integral of radiance and cosine over the rectangle and the half-space behind it.
    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    /// Directions in proportion to the radiance, through uniform points on the rectangle.
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t) const override;
    LightLePdf PdfLe(const Point3 &p, const Normal3 &n, const Vector3 &w, uint32_t) const override;
    SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const override;
    Float MeanRadiance(const Vector3 &d) const override;
    int Resolution() const override { return map_.Resolution().x; }
    std::optional<LightBounds> Opening() const override;

  private:
    /// Directions through the rectangle from the point, in proportion to the mean of R, G and B.
    std::optional<LightLiSample> SampleDirection(const Point3 &p, const Point2 &u, const SampledWavelengths &lambda,
                                                 bool allowIncompletePdfs) const override;
    Float DirectionPdf(const Point3 &p, const Vector3 &wi, bool allowIncompletePdfs) const override;
    /// Map pixel of a frame direction with z > 0.
    Point2i PixelTowards(const Vector3 &local) const;
    SampledSpectrum Radiance(const Vector3 &local, const SampledWavelengths &lambda) const;
    const Portal &Rectangle() const { return (*portal_)[0]; }
    Float Area() const {
        const Vector3 sides = Rectangle().high - Rectangle().low;
        return sides.x * sides.y;
    }

    Frame frame_;
    Image map_;
    const ColorSpace *colorSpace_;
    Float scale_;
    std::optional<EnvironmentPortals> portal_;
};

}  // namespace pbrt
