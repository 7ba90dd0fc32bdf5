#pragma once
#include "pbrt/lights/light.h"

namespace pbrt {

/// Base of all point-shaped lights. `Self` provides, non-virtually for speed,
///     SampledSpectrum Intensity(const Vector3 &w, const SampledWavelengths &lambda) const
/// for the intensity along w (render space, any nonzero length), and
///     Vector3 SampleDirection(const Point2 &u) const
///     Float PdfDirection(const Vector3 &w) const
/// for unit directions nearly in proportion to it (density by solid angle).
template <class Self>
class LightAtPoint : public Light {
  public:
    std::optional<LightLiSample> SampleLi(const LightSampleContext &from, const Point2 &,
                                          const SampledWavelengths &lambda, bool, uint32_t) const final {
        Vector3 d = position_ - from.p;
        Float d2 = LengthSquared(d);
        if (!(d2 > 0)) return {};
        LightLiSample s;
        s.L = static_cast<const Self &>(*this).Intensity(-d, lambda) / d2;
        if (!s.L) return {};
        s.wi = d / std::sqrt(d2);
        s.pdf = 1;
        s.pLight = position_;
        return s;
    }
    Float PdfLi(const LightSampleContext &, const Vector3 &, const Point3 &, const Normal3 &, bool,
                uint32_t) const final {
        return 0;
    }
    std::optional<LightLeSample> SampleLe(const Point2 &, const Point2 &uDirection, const SampledWavelengths &lambda,
                                          uint32_t) const final {
        const Self &self = static_cast<const Self &>(*this);
        LightLeSample s;
        s.ray.o = position_;
        s.ray.d = self.SampleDirection(uDirection);
        s.pdfPosition = 1;
        s.pdfDirection = self.PdfDirection(s.ray.d);
        if (!(s.pdfDirection > 0)) return {};
        s.L = self.Intensity(s.ray.d, lambda);
        if (!s.L) return {};
        return s;
    }
    LightLePdf PdfLe(const Point3 &, const Normal3 &, const Vector3 &w, uint32_t) const final {
        return {0, static_cast<const Self &>(*this).PdfDirection(w)};
    }

  protected:
    explicit LightAtPoint(const Point3 &position) : Light(LightKind::DeltaPosition), position_(position) {}

    std::optional<LightBounds> AllAround(double phi) const {
        if (!(phi > 0)) return {};
        return LightBounds{Bounds3(position_), Vector3(0, 0, 1), phi, -1, 0, false};
    }

    Point3 position_;
};

}  // namespace pbrt
