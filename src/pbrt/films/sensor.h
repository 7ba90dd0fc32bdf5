#pragma once
#include <string>
#include <vector>

#include "pbrt/core/param_reader.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// All sensors: cie1931, then the cameras.
std::vector<std::string> SupportedSensors();

/// Sensor parameters of a film (pbrt-v4-format §5.2).
struct SensorParams {
    std::string name = "cie1931";
    Float iso = 100, whiteBalance = 0;
    void Describe(auto &&v) {
        v("sensor", name, SupportedSensors(), "spectral response");
        v("iso", iso, Positive(1e9f), "sensitivity");
        v("whitebalance", whiteBalance, Range<Float>{0, 1e6f, false, false, "K"},
          "colour temperature of white, at least 1000; 0: 6500, for cie1931 none");
    }
};

/// Converts path spectra to sensor values, and those to XYZ.
class PixelSensor {
  public:
    /// `set`: source of the parameters. `exposureTime` in seconds. Throws UserError.
    static PixelSensor Make(const SensorParams &params, const ParamSet &set, const ColorSpace &outputSpace,
                            Float exposureTime);

    /// `flux` is radiance divided by the density of its wavelengths.
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

/// Least-squares matrix m: minimises the sum of |m * from[i] - to[i]|^2.
glm::mat3 FitLinearMap(const std::vector<Vector3> &from, const std::vector<Vector3> &to);

}  // namespace pbrt
