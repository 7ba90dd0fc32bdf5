#pragma once
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

/// A pixel of such an image; negative values count as 0.
inline Rgb LightPixel(const Image &image, const Point2i &p) {
    return glm::max(Rgb(image.Get(p, 0), image.Get(p, 1), image.Get(p, 2)), Rgb(0));
}

/// Mean over the pixels of the illuminant spectra their colours stand for.
SampledSpectrum AverageIlluminant(const Image &image, const ColorSpace &colorSpace, const SampledWavelengths &lambda);

}  // namespace pbrt
