#pragma once
#include <functional>

#include "pbrt/cameras/camera.h"
#include "pbrt/films/film.h"
#include "pbrt/math/statistics.h"

namespace pbrt {

/// The first scattering surface along a camera ray, in the film's coordinate system.
struct VisibleSurface {
    Point3 p{};
    Normal3 n{}, ns{};  ///< unit, geometric and shading, facing the camera
    Point2 uv{};
    Float dzdx = 0, dzdy = 0;  ///< size of the change of p.z over the filter footprint
    SampledSpectrum albedo;    ///< at `lambda`
    SampledWavelengths lambda;
};
using VisibleSurfaceQuery =
    std::function<std::optional<VisibleSurface>(const CameraRay &ray, const SampledWavelengths &lambda)>;

/// The `gbuffer` film: besides RGB, what the camera sees in every pixel (means over its samples) and the variance of
/// the samples that see something.
class GBufferFilm final : public RgbFilm {
  public:
    enum class CoordinateSystem { Camera, World };
    GBufferFilm(const ParamSet &params, const ColorSpace &outputSpace, Float exposureTime,
                const FilmOverrides &overrides, DiagnosticSink &sink);

    CoordinateSystem Coordinates() const { return coordinates_; }
    /// How the render loop finds what is visible; without it nothing is.
    void SetQuery(VisibleSurfaceQuery query) { query_ = std::move(query); }
    std::optional<VisibleSurface> Look(const CameraRay &ray, const SampledWavelengths &lambda) const {
        return query_ ? query_(ray, lambda) : std::nullopt;
    }

    void AddSample(Point2i pixel, const SampledSpectrum &L, const SampledWavelengths &lambda, Float weight,
                   const std::optional<VisibleSurface> &visible);

    /// The channels of pbrt-v4-format §14.
    Image ToImage() const override;

  private:
    struct Pixel {
        glm::dvec3 p{0}, n{0}, ns{0}, albedo{0};
        glm::dvec2 uv{0}, dz{0};
        double weight = 0;  ///< of samples that see a surface
        RunningMoments moments[3];
    };
    CoordinateSystem coordinates_;
    VisibleSurfaceQuery query_;
    std::vector<Pixel> pixels_;
};

}  // namespace pbrt
