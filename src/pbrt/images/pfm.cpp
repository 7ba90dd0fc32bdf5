#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string_view>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"
#include "pbrt/images/image_formats.h"

namespace pbrt::formats {

static_assert(std::endian::native == std::endian::little);

ImageFile ReadPfm(const std::string &path) {
    std::string content = ReadFileContents(path);
    char magic[8] = "";
    double width = 0, height = 0, scale = 0;
    int headBytes = 0;
    const int words = std::sscanf(content.c_str(), "%7s %lf %lf %lf%n", magic, &width, &height, &scale, &headBytes);
    const bool color = std::string_view(magic) == "PF";
    if (!color && std::string_view(magic) != "Pf")
        throw UserError("{}: not a PFM file: it does not start with \"PF\" or \"Pf\".", path);
    size_t at = headBytes;
    if (words != 4 || (at < content.size() && !std::isspace(static_cast<unsigned char>(content[at]))))
        throw UserError("{}: the PFM header is malformed.", path);
    at = std::min(at + 1, content.size());  // a single white space
    auto isSize = [](double v) { return v >= 1 && v <= 1e9 && v == std::floor(v); };
    if (!isSize(width) || !isSize(height) || scale == 0 || !std::isfinite(scale))
        throw UserError("{}: impossible PFM header: {} x {}, scale {}.", path, width, height, scale);
    CheckSize(path, int64_t(width), int64_t(height), color ? 3 : 1, sizeof(float), Infinity);
    Point2i resolution(static_cast<int>(width), static_cast<int>(height));
    size_t rowValues = size_t(resolution.x) * (color ? 3 : 1);
    size_t expected = rowValues * resolution.y * sizeof(float);
    if (content.size() - at < expected)
        throw UserError("{}: the pixels end too early ({} of {} bytes).", path, content.size() - at, expected);

    ImageFile result;
    result.image = Image(PixelFormat::Float, resolution,
                         color ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"});
    float *pixels = static_cast<float *>(result.image.Data());
    // Positive scale: big endian. Its magnitude scales all pixels, as in stock pbrt-v4.
    const bool swap = scale > 0;
    const float factor = float(std::abs(scale));
    for (int y = resolution.y - 1; y >= 0; --y)
        for (size_t i = 0; i < rowValues; ++i, at += sizeof(float)) {
            uint32_t bits = 0;
            std::memcpy(&bits, content.data() + at, sizeof(bits));
            pixels[y * rowValues + i] = std::bit_cast<float>(swap ? __builtin_bswap32(bits) : bits) * factor;
        }
    return result;
}

std::string EncodePfm(const Image &image) {
    const Image pixels = image.ConvertTo(PixelFormat::Float);
    const char *data = static_cast<const char *>(pixels.Data());
    const size_t rowBytes = pixels.Bytes() / image.Resolution().y;
    std::string content = fmt::format("{}\n{} {}\n-1\n", image.ChannelCount() == 3 ? "PF" : "Pf", image.Resolution().x,
                                      image.Resolution().y);
    content.reserve(content.size() + pixels.Bytes());
    for (int y = image.Resolution().y - 1; y >= 0; --y) content.append(data + y * rowBytes, rowBytes);
    return content;
}

}  // namespace pbrt::formats
