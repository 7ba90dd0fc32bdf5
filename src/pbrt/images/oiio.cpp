#include <Imath/half.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <array>
#include <fstream>

#include "pbrt/core/error.h"
#include "pbrt/core/log.h"
#include "pbrt/images/image_formats.h"

namespace pbrt::formats {

namespace {

std::vector<std::string> NamesFor(int channels) {
    static const std::vector<std::string> rgba = {"R", "G", "B", "A"};
    if (channels == 1) return {"Y"};
    return {rgba.begin(), rgba.begin() + channels};
}

// Channels stock pbrt-v4 keeps of a PNG: what the file says before transparency chunks are applied, without the
// alpha of grey images. 25 bytes into the file is IHDR's colour type.
int PngChannels(const std::string &path) {
    std::array<char, 26> head{};
    std::ifstream(path, std::ios::binary).read(head.data(), head.size());
    switch (head[25]) {
        case 0:
        case 4: return 1;
        case 6: return 4;
        default: return 3;
    }
}

// The first `kept` of each pixel's channels.
template <class T>
std::vector<T> ReadChannels(OIIO::ImageInput &in, OIIO::TypeDesc type, int kept, const std::string &path) {
    const OIIO::ImageSpec &spec = in.spec();
    size_t pixels = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
    std::vector<T> values(pixels * static_cast<size_t>(kept));
    if (!in.read_image(0, 0, 0, kept, type, values.data()))
        throw UserError(fmt::format("{}: {}.", path, in.geterror()));
    return values;
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
    OIIO::ImageSpec request;
    request["oiio:UnassociatedAlpha"] = 1;
    std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path, &request);
    if (!in) {
        const std::string reason = OIIO::geterror();
        if (reason.find("could not find a format reader") == std::string::npos)
            throw UserError(fmt::format("{}: {}.", path, reason));
        throw UserError(fmt::format("{}: not an image of a known format; PNG, EXR, PFM, HDR, JPEG, TGA, BMP, GIF, PNM, "
                                    "PSD and TIFF files can be read.", path));
    }
    const OIIO::ImageSpec &spec = in->spec();
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.deep)
        throw UserError(fmt::format("{}: not a plain two-dimensional image.", path));
    const std::string format = in->format_name();
    const bool png = format == "png";
    const int kept = std::min(spec.nchannels, png ? PngChannels(path) : spec.nchannels >= 3 ? 3 : 1);
    const Point2i resolution(spec.width, spec.height);
    const ColorEncoding bytes = png ? encoding.value_or(ColorEncoding{}) : ColorEncoding{};

    ImageFile result;
    Image &image = result.image;
    if (spec.format.is_floating_point()) {
        image = Image(PixelFormat::Float, resolution, NamesFor(kept));
        std::vector<float> values = ReadChannels<float>(*in, OIIO::TypeDesc::FLOAT, kept, path);
        std::copy(values.begin(), values.end(), static_cast<float *>(image.Data()));
    } else if (png && spec.format.basesize() > 1) {
        image = Image(PixelFormat::Half, resolution, NamesFor(kept), bytes);
        std::vector<uint16_t> values = ReadChannels<uint16_t>(*in, OIIO::TypeDesc::UINT16, kept, path);
        auto *out = static_cast<uint16_t *>(image.Data());
        for (uint16_t v : values) *out++ = imath_float_to_half(bytes.ToLinear(static_cast<Float>(v) / 65535));
    } else {
        // Everything else counts as 8 bit.
        image = Image(PixelFormat::U8, resolution, NamesFor(kept), bytes);
        std::vector<uint8_t> values = ReadChannels<uint8_t>(*in, OIIO::TypeDesc::UINT8, kept, path);
        std::copy(values.begin(), values.end(), static_cast<uint8_t *>(image.Data()));
    }
    // Photographs keep their rows: stock pbrt-v4 does not look at EXIF.
    if (format == "targa" || format == "hdr") image = Upright(image, spec.get_int_attribute("Orientation", 1));
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
    OIIO::ImageSpec spec(image.Resolution().x, image.Resolution().y, image.ChannelCount(), OIIO::TypeDesc::UINT8);
    spec["oiio:ColorSpace"] = "sRGB";
    spec["oiio:UnassociatedAlpha"] = 1;
    std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create("png");
    if (!out) throw UserError(fmt::format("{}: {}.", shownPath, OIIO::geterror()));
    if (!out->open(path, spec) || !out->write_image(OIIO::TypeDesc::UINT8, bytes.data()) || !out->close())
        throw UserError(fmt::format("{}: {}.", shownPath, out->geterror()));
}

}  // namespace pbrt::formats
