#include <Imath/half.h>
#include <dlfcn.h>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"
#include "pbrt/core/log.h"
#include "pbrt/images/image_formats.h"
#include "pbrt/images/image_library.h"

namespace pbrt::oiio {
namespace {

const ImageLibrary &Load() {
    // Found by the programs' run path. Never unloaded, because images may use it until exit.
    void *module = dlopen(PBRT_OIIO_MODULE, RTLD_NOW | RTLD_LOCAL);
    void *entry = module ? dlsym(module, "PbrtImageLibrary") : nullptr;
    if (!entry) throw UserError("{} cannot be loaded: {}.", PBRT_OIIO_MODULE, dlerror());
    return *reinterpret_cast<const ImageLibrary *(*)()>(entry)();
}

}  // namespace

const ImageLibrary &Library() {
    static const ImageLibrary &library = Load();
    return library;
}

}  // namespace pbrt::oiio

namespace pbrt::formats {
namespace {

std::vector<std::string> NamesFor(int channels) {
    static const std::vector<std::string> rgba = {"R", "G", "B", "A"};
    if (channels == 1) return {"Y"};
    return {rgba.begin(), rgba.begin() + channels};
}

// Applies an EXIF orientation that only mirrors or rotates by 180 degrees.
Image Upright(const Image &image, int orientation) {
    bool mirrorX = orientation == 2 || orientation == 3, mirrorY = orientation == 3 || orientation == 4;
    if (!mirrorX && !mirrorY) return image;
    Image result(image.Format(), image.Resolution(), image.Channels(), image.Encoding());
    Point2i last = image.Resolution() - 1;
    ForEachValue(image, [&](Point2i p, int c) {
        result.Set(p, c, image.Get({mirrorX ? last.x - p.x : p.x, mirrorY ? last.y - p.y : p.y}, c));
    });
    return result;
}

/// Upper bound on pixel bytes per file byte: constant data with deflate, run lengths, LZW or one Huffman bit per block,
/// times up to 24 for 1-bit pixels. TIFF files of white pages have no such limit.
double MaxExpansion(const std::string &format) {
    for (const char *limited : {"png", "jpeg", "bmp", "targa", "pnm", "hdr", "psd", "gif"})
        if (format == limited) return 25000;
    return Infinity;
}

/// Throws UserError for truncated JPEG files, which the JPEG library silently fills with grey.
void CheckJpegEnd(const std::string &path) {
    // In pixel data a byte 0xff is always followed by 0 or a restart marker.
    const std::string content = ReadFileContents(path);
    const size_t pixels = content.rfind("\xff\xda"), end = content.rfind("\xff\xd9");
    if (end == std::string::npos || (pixels != std::string::npos && end < pixels))
        throw UserError("{}: the pixels end too early.", path);
}

}  // namespace

ImageFile ReadOther(const std::string &path, std::optional<ColorEncoding> encoding) {
    const std::unique_ptr<oiio::OpenFile> file = oiio::Library().Open(path);
    const Point2i resolution(file->width, file->height);
    const std::vector<std::string> names = NamesFor(file->channels);
    const ColorEncoding bytes = file->format == "png" ? encoding.value_or(ColorEncoding{}) : ColorEncoding{};
    const bool isFloat = file->type == oiio::ValueType::Float, isDeep = file->type == oiio::ValueType::U16;
    const int valueBytes = isFloat ? 4 : isDeep ? 2 : 1;
    CheckSize(path, resolution.x, resolution.y, file->channels, valueBytes, MaxExpansion(file->format));
    std::error_code failed;
    if (file->format == "hdr" && file->orientation > 4)
        throw UserError(
            "{}: the pixels are stored column by column; only row by row is supported (a resolution line "
            "such as \"-Y {} +X {}\").",
            path, file->height, file->width);
    if (std::filesystem::file_size(path, failed) < file->minFileBytes)
        throw UserError("{}: the pixels end too early.", path);
    ImageFile result;
    Image &image = result.image;
    if (isDeep) {
        image = Image(PixelFormat::Half, resolution, names, bytes);
        // In place: integers and halves both have two bytes.
        auto *values = static_cast<uint16_t *>(image.Data());
        file->Read(values);
        for (size_t i = 0; i < image.ValueCount(); ++i)
            values[i] = imath_float_to_half(bytes.ToLinear(Float(values[i]) / 65535));
    } else {
        image = Image(isFloat ? PixelFormat::Float : PixelFormat::U8, resolution, names, bytes);
        file->Read(image.Data());
    }
    if (file->format == "jpeg") CheckJpegEnd(path);
    // EXIF orientation of photographs is ignored, as in stock pbrt-v4.
    if (file->format == "targa" || file->format == "hdr") image = Upright(image, file->orientation);
    return result;
}

std::string EncodeBytes(const std::string &format, const std::string &path, const Image &image) {
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
        ForEachValue(image, [&](Point2i p, int c) {
            const Float v = image.Get(p, c);
            clamped += !(v >= 0 && v <= 1);
            bytes[i++] = code.Encode(v);
        });
    }
    if (clamped) LogWarning("{}: {} of {} channel values were outside [0, 1] and clamped.", path, clamped, values);
    const std::vector<unsigned char> file = oiio::Library().Encode(
        format, {image.Resolution().x, image.Resolution().y, image.ChannelCount(), oiio::ValueType::U8, bytes.data()});
    return {file.begin(), file.end()};
}

}  // namespace pbrt::formats
