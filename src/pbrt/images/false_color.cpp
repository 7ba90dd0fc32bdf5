#include "pbrt/images/false_color.h"

#include "pbrt/math/rng.h"

namespace pbrt {

namespace false_color {
namespace {
constexpr std::array<Rgb, 6> kColors = {Rgb(0.02f, 0.02f, 0.10f), Rgb(0.25f, 0.10f, 0.55f), Rgb(0.05f, 0.45f, 0.65f),
                                        Rgb(0.15f, 0.70f, 0.30f), Rgb(0.95f, 0.80f, 0.15f), Rgb(1.00f, 0.98f, 0.90f)};
}

Rgb Ramp(Float t) {
    const Float x = std::clamp(t, Float(0), Float(1)) * (kColors.size() - 1);
    const size_t i = std::min(size_t(x), kColors.size() - 2);
    return Lerp(x - Float(i), kColors[i], kColors[i + 1]);
}

Rgb Signed(Float t) {
    const Float x = std::clamp(t, Float(-1), Float(1));
    return x < 0 ? Lerp(-x, Rgb(0), Rgb(0.25f, 0.55f, 1)) : Lerp(x, Rgb(0), Rgb(1, 0.35f, 0.2f));
}

Rgb OfId(uint64_t id) {
    const uint64_t h = Hash(id);
    const Float hue = HashToFloat(h) * 6;
    const Float saturation = Float(0.45) + Float(0.5) * Float(h & 0xffff) / 65536;
    const Float value = Float(0.55) + Float(0.45) * Float((h >> 16) & 0xffff) / 65536;
    Rgb color(0);
    for (int c = 0; c < 3; ++c) {
        Float distance = std::abs(hue - Float(2 * c));
        distance = std::min(distance, 6 - distance);  // distance from this primary on the colour wheel
        color[c] = value * (1 - saturation * std::clamp(distance - 1, Float(0), Float(1)));
    }
    return color;
}

}  // namespace false_color

Image FalseColor(const Image &image, int channel, const FalseColorStyle &style, const Image *mask) {
    using Scale = FalseColorStyle::Scale;
    const Point2i resolution = image.Resolution();
    const int legend = style.scale == Scale::Id ? 0 : style.legendRows;
    Image result(PixelFormat::Float, {resolution.x, resolution.y + legend}, {"R", "G", "B"});
    const ColorEncoding shown{};
    auto put = [&](Point2i p, const Rgb &color) {
        for (int c = 0; c < 3; ++c) result.Set(p, c, shown.ToLinear(color[c]));
    };
    const Float range = style.max > style.min ? style.max - style.min : 1;
    ForEachPixel(image, [&](Point2i p) {
        const Float v = image.Get(p, channel);
        if (mask && mask->Get(p, 0) == 0) put(p, Rgb(0.13f));
        else if (!std::isfinite(v)) put(p, false_color::Invalid);
        else if (style.scale == Scale::Id) put(p, false_color::OfId(uint64_t(std::llround(v))));
        else if (style.scale == Scale::Signed) put(p, false_color::Signed(style.max > 0 ? v / style.max : v));
        else put(p, false_color::Ramp((v - style.min) / range));
    });
    for (int y = resolution.y; y < resolution.y + legend; ++y)
        for (int x = 0; x < resolution.x; ++x) {
            const Float t = (Float(x) + Float(0.5)) / Float(resolution.x);
            put({x, y}, style.scale == Scale::Signed ? false_color::Signed(2 * t - 1) : false_color::Ramp(t));
        }
    return result;
}

}  // namespace pbrt
