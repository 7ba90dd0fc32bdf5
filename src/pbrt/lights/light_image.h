#pragma once
#include <functional>

#include "pbrt/core/files.h"
#include "pbrt/core/params.h"
#include "pbrt/images/image.h"

namespace pbrt {

/// An image that a light emits.
struct LightImage {
    Image image;  ///< R, G, B, linear, finite
    const ColorSpace *colorSpace = nullptr;
    std::string name;
};

/// Reads the file named by `parameter`. All complaints are located UserErrors.
LightImage ReadLightImage(const ParamSet &params, const std::string &parameter, const FileResolver &files);

/// The same for an image that scales an intensity: one channel, Y or the mean of R, G, B.
LightImage ReadIntensityImage(const ParamSet &params, const std::string &parameter, const FileResolver &files);

/// The pixel at st in [0, 1]^2.
inline Point2i PixelAt(const Point2 &st, const Point2i &n) {
    return {std::clamp(static_cast<int>(st.x * static_cast<Float>(n.x)), 0, n.x - 1),
            std::clamp(static_cast<int>(st.y * static_cast<Float>(n.y)), 0, n.y - 1)};
}

/// A pixel of such an image; negative values count as 0.
inline Rgb LightPixel(const Image &image, const Point2i &p) {
    return glm::max(Rgb(image.Get(p, 0), image.Get(p, 1), image.Get(p, 2)), Rgb(0));
}

/// Mean over the pixels (x, y) of the illuminant spectra their colours stand for, times weight(x, y) if there is one. Runs
/// in parallel.
SampledSpectrum AverageIlluminant(const Image &image, const ColorSpace &colorSpace, const SampledWavelengths &lambda,
                                  const std::function<Float(int, int)> &weight = {});

}  // namespace pbrt
