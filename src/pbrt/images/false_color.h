#pragma once
#include <array>
#include <optional>

#include "pbrt/images/image.h"

namespace pbrt {

/// Colours for values. They are chosen as shown (encoded), and pass PNG's encoding unchanged.
namespace false_color {
/// 0 dark to 1 bright, so that order shows without a legend; clamped.
Rgb Ramp(Float t);
/// -1 blue, 0 black, 1 red; clamped.
Rgb Signed(Float t);
/// A colour of its own for every number, without order; never dark or grey.
Rgb OfId(uint64_t id);
/// Of values that are not finite.
inline const Rgb Invalid(1, 0, 1);
}  // namespace false_color

struct FalseColorStyle {
    enum class Scale {
        Ramp,    ///< `least` to `most`
        Signed,  ///< -most to most
        Id       ///< numbers without order
    };
    Scale scale = Scale::Ramp;
    Float least = 0, most = 1;
    int legendRows = 0;  ///< height of a bar of all colours below the image, low to high; Id has none
};

/// One channel as R, G, B (float). Pixels where `mask` (may be null; one channel) is 0 become dark grey.
Image FalseColor(const Image &image, int channel, const FalseColorStyle &style, const Image *mask = nullptr);

}  // namespace pbrt
