#include <Imath/half.h>
#include <dlfcn.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"
#include "pbrt/core/log.h"
#include "pbrt/images/image_formats.h"
#include "pbrt/images/image_library.h"

namespace pbrt::oiio {

const ImageLibrary &Library() {
    static const ImageLibrary &library = []() -> const ImageLibrary & {
        // Found by the programs' run path. Never unloaded, because images may use it until exit.
        void *module = dlopen(PBRT_OIIO_MODULE, RTLD_NOW | RTLD_LOCAL);
        void *entry = module ? dlsym(module, "PbrtImageLibrary") : nullptr;
        if (!entry) throw UserError("{} cannot be loaded: {}.", PBRT_OIIO_MODULE, dlerror());
        return *reinterpret_cast<const ImageLibrary *(*)()>(entry)();
    }();
    return library;
}

}  // namespace pbrt::oiio

namespace pbrt::formats {
namespace {

// Applies an orientation, numbered as in TIFF, that only mirrors or rotates by 180 degrees.
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

/// True if all strips or tiles of the first image of a TIFF or BigTIFF file are in the file. Throws UserError for a
/// file without the tag BitsPerSample: OpenImageIO takes its 1 bit for 8.
bool HasTiffPixels(const std::string &path) {
    std::ifstream in(path, std::ios::binary);
    std::error_code failed;
    const uint64_t size = std::filesystem::file_size(path, failed);
    const bool isLittleEndian = in.peek() == 'I';
    bool isWhole = !failed;
    // Of `count` integers of `bytes` bytes each.
    const auto numbers = [&](uint64_t at, uint64_t count, uint64_t bytes) {
        std::vector<uint64_t> list;
        isWhole = isWhole && at <= size && count <= (size - at) / bytes;
        if (!isWhole) return std::vector<uint64_t>(1);
        std::string raw(count * bytes, '\0');
        in.seekg(std::streamoff(at)).read(raw.data(), std::streamsize(raw.size()));
        for (uint64_t first = 0; first < raw.size(); first += bytes) {
            uint64_t &v = list.emplace_back(0);
            for (uint64_t i = 0; i < bytes; ++i)
                v = v << 8 | uint8_t(raw[first + (isLittleEndian ? bytes - 1 - i : i)]);
        }
        return list;
    };
    const auto number = [&](uint64_t at, uint64_t bytes) { return numbers(at, 1, bytes)[0]; };
    const bool isBig = number(2, 2) == 43;
    const uint64_t word = isBig ? 8 : 4, directory = number(word, word), head = isBig ? 8 : 2;
    const uint64_t entries = number(directory, head);
    std::vector<uint64_t> starts, lengths;
    bool hasBits = false;
    for (uint64_t i = 0; i < entries && isWhole; ++i) {
        const uint64_t entry = directory + head + i * (4 + 2 * word);
        const uint64_t tag = number(entry, 2), type = number(entry + 2, 2), count = number(entry + 4, word);
        const bool isStart = tag == 273 || tag == 324;
        hasBits |= tag == 258;
        if (!isStart && tag != 279 && tag != 325) continue;
        const uint64_t bytes = type == 3 ? 2 : type == 16 ? 8 : 4, value = entry + 4 + word;
        (isStart ? starts : lengths) = numbers(count > word / bytes ? number(value, word) : value, count, bytes);
    }
    for (size_t i = 0; i < std::min(starts.size(), lengths.size()); ++i)
        isWhole = isWhole && starts[i] <= size && lengths[i] <= size - starts[i];
    if (isWhole && !hasBits) throw UserError("{}: TIFF files without the tag BitsPerSample are not supported.", path);
    return isWhole;
}

/// Throws UserError for truncated files that the libraries fill silently (JPEG with grey, TIFF with zeros) or report on
/// stderr themselves (PNG).
void CheckEnd(const std::string &path) {
    std::string start(4, '\0');
    std::ifstream(path, std::ios::binary).read(start.data(), 4);
    const bool isPng = start == "\x89PNG";
    bool isWhole = true;
    if (isPng || start.starts_with("\xff\xd8")) {
        // In the pixel data of JPEG a byte 0xff is always followed by 0 or a restart marker.
        const std::string content = ReadFileContents(path);
        const size_t pixels = content.rfind(isPng ? "IDAT" : "\xff\xda");
        const size_t end = content.rfind(isPng ? "IEND" : "\xff\xd9");
        isWhole = end != std::string::npos && (pixels == std::string::npos || end > pixels);
    } else if ((start.starts_with("II") || start.starts_with("MM")) && start.find_first_of("*+") != start.npos) {
        isWhole = HasTiffPixels(path);
    }
    if (!isWhole) throw UserError("{}: the pixels end too early.", path);
}

}  // namespace

ImageFile ReadOther(const std::string &path, std::optional<ColorEncoding> encoding) {
    CheckEnd(path);
    const std::unique_ptr<oiio::OpenFile> file = oiio::Library().Open(path);
    const Point2i resolution(file->width, file->height);
    std::vector<std::string> names = {"R", "G", "B", "A"};
    names.resize(file->channels);
    if (file->channels == 1) names = {"Y"};
    const ColorEncoding bytes = file->format == "png" ? encoding.value_or(ColorEncoding{}) : ColorEncoding{};
    const bool isFloat = file->type == oiio::ValueType::Float, isDeep = file->type == oiio::ValueType::U16;
    const int valueBytes = isFloat ? 4 : isDeep ? 2 : 1;
    // Upper bound on pixel bytes per file byte: constant data with deflate, run lengths, LZW or one Huffman bit per
    // block, times up to 24 for 1-bit pixels. TIFF files of white pages have no such limit.
    const double maxExpansion = file->format == "tiff" ? Infinity : 25000;
    CheckSize(path, resolution.x, resolution.y, file->channels, valueBytes, maxExpansion);
    // EXIF orientation of photographs is ignored, as in stock pbrt-v4.
    const bool isOriented = file->format == "hdr" || file->format == "targa" || file->format == "tiff";
    if (isOriented && file->orientation > 4)
        throw UserError(
            "{}: the pixels are stored column by column; only row by row is supported (HDR: a resolution line "
            "such as \"-Y {} +X {}\"; TIFF: orientations 1 to 4).",
            path, file->height, file->width);
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
    if (isOriented) image = Upright(image, file->orientation);
    return result;
}

std::string EncodeBytes(const std::string &format, const std::string &path, const Image &image) {
    const ByteCode &code = ByteCode::Of(ColorEncoding{});  // sRGB
    std::vector<uint8_t> bytes;
    bytes.reserve(image.ValueCount());
    size_t clamped = 0;
    ForEachValue(image, [&](Point2i p, int c) {
        const Float v = image.Get(p, c);
        clamped += !(v >= 0 && v <= 1);
        bytes.push_back(code.Encode(v));
    });
    if (clamped)
        LogWarning("{}: {} of {} channel values were outside [0, 1] and clamped.", path, clamped, bytes.size());
    const std::vector<unsigned char> file = oiio::Library().Encode(
        format, {image.Resolution().x, image.Resolution().y, image.ChannelCount(), oiio::ValueType::U8, bytes.data()});
    return {file.begin(), file.end()};
}

}  // namespace pbrt::formats
