#pragma once

#include "pbrt/images/image.h"

namespace pbrt {

/// False-colour palettes, sRGB-encoded. FalseColor() decodes them, so that PNG files show exactly these.
namespace false_color {
/// Dark at t = 0 to bright at t = 1, so that order is visible without a legend; t is clamped.
Rgb Ramp(Float t);
/// Blue at t = -1, black at 0, red at 1; t is clamped.
Rgb Signed(Float t);
/// Pseudo-random unordered colour of a number; never dark or grey.
Rgb OfId(uint64_t id);
/// Magenta, for non-finite values.
inline const Rgb Invalid(1, 0, 1);
}  // namespace false_color

struct FalseColorStyle {
    enum class Scale {
        Ramp,    ///< `min` to `max`
        Signed,  ///< -max to max
        Id       ///< one unordered colour per number
    };
    Scale scale = Scale::Ramp;
    Float min = 0, max = 1;
    int legendRows = 0;  ///< height in pixels of the legend bar below the image, low to high; none for Id
};

/// One channel as R, G, B (float). Pixels where `mask` (one channel, may be null) is 0 become dark grey.
Image FalseColor(const Image &image, int channel, const FalseColorStyle &style, const Image *mask = nullptr);

}  // namespace pbrt
