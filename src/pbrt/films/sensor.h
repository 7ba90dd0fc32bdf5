#pragma once
#include <string>
#include <vector>

#include "pbrt/core/params.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// What turns the spectrum of one camera path into three numbers, and those into XYZ.
class PixelSensor {
  public:
    /// The film's `sensor`, `iso` and `whitebalance` (pbrt-v4-format §5.2). `exposureTime` in seconds. Throws
    /// UserError.
    static PixelSensor Make(const ParamSet &params, const ColorSpace &outputSpace, Float exposureTime);

    /// `flux`: radiance over the density of its wavelengths.
    Vector3 Expose(const SampledSpectrum &flux, const SampledWavelengths &lambda) const {
        return Vector3((flux * first_.Sample(lambda)).Average(), (flux * second_.Sample(lambda)).Average(),
                       (flux * third_.Sample(lambda)).Average()) *
               imagingRatio_;
    }
    const glm::mat3 &XyzFromSensor() const { return xyzFromSensor_; }

  private:
    PixelSensor(const Spectrum &first, const Spectrum &second, const Spectrum &third, const glm::mat3 &xyzFromSensor,
                Float imagingRatio)
        : first_(first), second_(second), third_(third), xyzFromSensor_(xyzFromSensor), imagingRatio_(imagingRatio) {}
    DenseSpectrum first_, second_, third_;
    glm::mat3 xyzFromSensor_;
    Float imagingRatio_;
};

/// cie1931, then the cameras.
std::vector<std::string> SupportedSensors();

/// The matrix m that makes the sum of |m * from[i] - to[i]|^2 smallest.
glm::mat3 FitLinearMap(const std::vector<Vector3> &from, const std::vector<Vector3> &to);

}  // namespace pbrt
