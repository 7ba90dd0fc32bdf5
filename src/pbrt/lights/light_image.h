#pragma once
#include <functional>
#include <memory>

#include "pbrt/images/image.h"

namespace pbrt {

struct LightImage {
    Image image;  ///< R, G, B, linear, finite
    const ColorSpace *colorSpace = nullptr;
    std::string name;
};

/// Throws UserError (no location).
LightImage ReadLightImage(const std::string &path);

/// Reads an image that scales an intensity, as one channel: Y, or the mean of R, G and B.
LightImage ReadIntensityImage(const std::string &path);

/// Pixel at st in [0, 1]^2.
inline Point2i PixelAt(const Point2 &st, const Point2i &n) {
    return {std::clamp(int(st.x * Float(n.x)), 0, n.x - 1), std::clamp(int(st.y * Float(n.y)), 0, n.y - 1)};
}

inline Point2 PixelCenter(int x, int y, const Point2i &n) {
    return {(Float(x) + Float(0.5)) / Float(n.x), (Float(y) + Float(0.5)) / Float(n.y)};
}

/// Pixel of an image with channels R, G, B; negative values are clamped to 0.
inline Rgb LightPixel(const Image &image, const Point2i &p) {
    return glm::max(Rgb(image.Get(p, 0), image.Get(p, 1), image.Get(p, 2)), Rgb(0));
}

inline Float MeanOf(const Rgb &rgb) { return (rgb.x + rgb.y + rgb.z) / 3; }

/// Illuminant spectrum of a colour. Its root mean square over the whole range is taken as that of R, G and B times that
/// of the colour space's illuminant.
inline SampledSpectrum RgbIlluminant(const ColorSpace &colorSpace, const Rgb &rgb, const SampledWavelengths &lambda) {
    if (lambda.IsWholeRange()) [[unlikely]] {
        const glm::dvec3 wide(rgb);
        return Float(std::sqrt(glm::dot(wide, wide) / 3)) * colorSpace.Illuminant().Sample(lambda);
    }
    return RgbIlluminantSpectrum(colorSpace, rgb).Sample(lambda);
}

inline SampledSpectrum PixelIlluminant(const Image &image, const Point2i &p, const ColorSpace &colorSpace,
                                       const SampledWavelengths &lambda) {
    return RgbIlluminant(colorSpace, LightPixel(image, p), lambda);
}

/// Emission as one value per nm, shared by all lights of equal emission. Thread-safe.
std::shared_ptr<const DenseSpectrum> InternSpectrum(const Spectrum &s);

/// Mean of PixelIlluminant over the pixels (x, y), weighted by weight(x, y) if given. Runs in parallel.
SampledSpectrum AverageIlluminant(const Image &image, const ColorSpace &colorSpace, const SampledWavelengths &lambda,
                                  const std::function<Float(int, int)> &weight = {});

}  // namespace pbrt
