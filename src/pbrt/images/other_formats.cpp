#include <Imath/half.h>

#include "pbrt/core/error.h"
#include "pbrt/core/log.h"
#include "pbrt/images/image_formats.h"
#include "pbrt/images/image_library.h"

namespace pbrt::formats {

namespace {

std::vector<std::string> NamesFor(int channels) {
    static const std::vector<std::string> rgba = {"R", "G", "B", "A"};
    if (channels == 1) return {"Y"};
    return {rgba.begin(), rgba.begin() + channels};
}

template <class T>
std::span<const T> ValuesOf(const oiio::File &file) {
    return {static_cast<const T *>(file.pixels.data), file.values.size() / sizeof(T)};
}

// Undoes a stored orientation (EXIF numbering), as far as it only mirrors or turns by 180 degrees.
Image Upright(const Image &image, int orientation) {
    bool mirrorX = orientation == 2 || orientation == 3, mirrorY = orientation == 3 || orientation == 4;
    if (!mirrorX && !mirrorY) return image;
    Image result(image.Format(), image.Resolution(), image.Channels(), image.Encoding());
    Point2i last = image.Resolution() - 1;
    for (int y = 0; y <= last.y; ++y)
        for (int x = 0; x <= last.x; ++x)
            for (int c = 0; c < image.ChannelCount(); ++c)
                result.Set({x, y}, c, image.Get({mirrorX ? last.x - x : x, mirrorY ? last.y - y : y}, c));
    return result;
}

}  // namespace

ImageFile ReadOther(const std::string &path, std::optional<ColorEncoding> encoding) {
    const oiio::File file = oiio::Library().Read(path);
    const Point2i resolution(file.pixels.width, file.pixels.height);
    const std::vector<std::string> names = NamesFor(file.pixels.channels);
    const ColorEncoding bytes = file.format == "png" ? encoding.value_or(ColorEncoding{}) : ColorEncoding{};
    ImageFile result;
    Image &image = result.image;
    if (file.pixels.type == oiio::ValueType::U16) {
        image = Image(PixelFormat::Half, resolution, names, bytes);
        auto *out = static_cast<uint16_t *>(image.Data());
        for (uint16_t v : ValuesOf<uint16_t>(file))
            *out++ = imath_float_to_half(bytes.ToLinear(static_cast<Float>(v) / 65535));
    } else {
        const bool isFloat = file.pixels.type == oiio::ValueType::Float;
        image = isFloat ? Image(PixelFormat::Float, resolution, names) : Image(PixelFormat::U8, resolution, names, bytes);
        std::copy(file.values.begin(), file.values.end(), static_cast<std::byte *>(image.Data()));
    }
    // Photographs keep their rows: stock pbrt-v4 does not look at EXIF.
    if (file.format == "targa" || file.format == "hdr") image = Upright(image, file.orientation);
    return result;
}

void WritePng(const std::string &path, const std::string &shownPath, const Image &image) {
    const ColorEncoding sRGB{};
    const size_t values = image.ValueCount();
    std::vector<uint8_t> bytes(values);
    size_t clamped = 0;
    if (image.Format() == PixelFormat::U8 && image.Encoding() == sRGB) {
        const auto *data = static_cast<const uint8_t *>(image.Data());
        bytes.assign(data, data + values);
    } else {
        const ByteCode &code = ByteCode::Of(sRGB);
        size_t i = 0;
        for (int y = 0; y < image.Resolution().y; ++y)
            for (int x = 0; x < image.Resolution().x; ++x)
                for (int c = 0; c < image.ChannelCount(); ++c) {
                    const Float v = image.Get({x, y}, c);
                    clamped += !(v >= 0 && v <= 1);
                    bytes[i++] = code.Encode(v);
                }
    }
    if (clamped)
        LogWarning(
            fmt::format("{}: {} of {} channel values were outside [0, 1] and clamped.", shownPath, clamped, values));
    oiio::Library().WritePng(path, {image.Resolution().x, image.Resolution().y, image.ChannelCount(),
                                    oiio::ValueType::U8, bytes.data()});
}

}  // namespace pbrt::formats
