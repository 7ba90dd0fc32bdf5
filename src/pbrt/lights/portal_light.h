#pragma once
#include <array>

#include "pbrt/images/image.h"
#include "pbrt/lights/light_beyond_scene.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/transform.h"
#include "pbrt/math/windowed_distribution.h"

namespace pbrt {

/// An environment that shines only through a rectangle, to one side of it (Bitterli, Wyman and Pharr 2015). The image
/// is resampled once to a map in which the rectangle is, seen from anywhere, an axis-aligned window: the coordinates of
/// a direction (x, y, z) in the rectangle's frame are the angles atan(x/z) and atan(y/z).
class PortalLight final : public LightBeyondScene {
  public:
    /// `image`: as for ImageInfiniteLight. `portal`: corners in order around it, in the space `renderFromPortal` takes
    /// them from; light travels against cross(p3 - p0, p1 - p0). The sides at p0 must not have length 0 or be parallel.
    /// Corners that do not form a rectangle are replaced by the rectangle from p0 to p2 that has a side along p3 - p0.
    PortalLight(const Transform &renderFromLight, const Image &image, const ColorSpace &colorSpace, Float scale,
                const std::array<Point3, 4> &portal, const Transform &renderFromPortal);
    static bool IsRectangle(const std::array<Point3, 4> &portal);

    /// What enters the scene: the integral of radiance and cosine over the rectangle and the half-space behind it.
    LightPower Phi(const SampledWavelengths &lambda, uint32_t) const override;
    /// Draws pixels of the map within the window seen from the point, in proportion to their mean of R, G, B times
    /// solid angle.
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &u,
                                          const SampledWavelengths &lambda, bool allowIncompletePdfs,
                                          uint32_t) const override;
    Float PdfLi(const LightSampleContext &from, const Vector3 &wi, const Point3 &pHit, const Normal3 &nHit,
                bool allowIncompletePdfs, uint32_t) const override;
    /// Directions in proportion to the map, through points drawn evenly on the rectangle.
    std::optional<LightLeSample> SampleLe(const Point2 &uPosition, const Point2 &uDirection,
                                          const SampledWavelengths &lambda, uint32_t) const override;
    LightLePdf PdfLe(const Point3 &p, const Normal3 &n, const Vector3 &w, uint32_t) const override;
    SampledSpectrum Le(const Point3 &o, const Vector3 &d, const SampledWavelengths &lambda) const override;
    std::optional<LightBounds> Opening() const override;

  private:
    std::optional<Point2> MapFromDirection(const Vector3 &d) const;
    /// Solid angle per area of the map at a unit direction of the frame.
    static Float SolidAngleDensity(const Vector3 &local);
    /// The rectangle as seen from p; empty behind it.
    std::optional<Bounds2> Window(const Point3 &p) const;
    SampledSpectrum Radiance(const Point2 &st, const SampledWavelengths &lambda) const;

    Frame frame_;  ///< x, y along the sides, z to the outside; may be left-handed
    Point3 corner_, opposite_;
    Float area_;
    Image map_;
    const ColorSpace *colorSpace_;
    Float scale_;
    WindowedPiecewiseConstant2D distribution_;
};

}  // namespace pbrt
