#pragma once
#include <array>
#include <optional>

#include "pbrt/images/image.h"

namespace pbrt {

/// Colours that stand for values, sRGB-encoded. FalseColor() decodes them, so that a PNG file shows exactly these.
namespace false_color {
/// Dark at t = 0 to bright at t = 1, so that the order of values shows without a legend; t is clamped.
Rgb Ramp(Float t);
/// Blue at t = -1, black at 0, red at 1; t is clamped.
Rgb Signed(Float t);
/// A pseudo-random colour for every number, without order; never dark or grey.
Rgb OfId(uint64_t id);
/// Magenta: the colour of values that are not finite.
inline const Rgb Invalid(1, 0, 1);
}  // namespace false_color

struct FalseColorStyle {
    enum class Scale {
        Ramp,    ///< `least` to `most`
        Signed,  ///< -most to most
        Id       ///< one colour per number, without order
    };
    Scale scale = Scale::Ramp;
    Float least = 0, most = 1;
    int legendRows = 0;  ///< height in pixels of a bar below the image, colours from low to high; Id has none
};

/// One channel as R, G, B (float). Pixels where `mask` (may be null; one channel) is 0 become dark grey.
Image FalseColor(const Image &image, int channel, const FalseColorStyle &style, const Image *mask = nullptr);

}  // namespace pbrt
