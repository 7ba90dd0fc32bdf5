#include <cctype>
#include <filesystem>
#include <new>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"
#include "pbrt/core/log.h"
#include "pbrt/core/memory.h"
#include "pbrt/images/image.h"
#include "pbrt/images/image_formats.h"

namespace pbrt {
namespace {

// Returns f(). Library errors become a UserError that names the file; `use`: "for" or "to write" it.
auto NamingFile(const std::string &path, const char *use, auto &&f) {
    try {
        return f();
    } catch (const UserError &) {
        throw;
    } catch (const std::bad_alloc &) {
        throw UserError("{}: there is not enough memory {} this image.", path, use);
    } catch (const std::exception &e) {
        // Without final full stop or line end.
        std::string text = e.what();
        while (!text.empty() && (text.back() == '.' || std::isspace(static_cast<unsigned char>(text.back()))))
            text.pop_back();
        // OpenImageIO gives no reason for damaged PNM files.
        if (text.empty()) text = "the pixels cannot be read or written; the file may be damaged or cut off";
        throw UserError("{}: {}.", path, text);
    }
}

// Restricts an image to formats of at most four channels: R, G, B and, if it fits, A, as sRGB.
Image ForPlainFormat(const std::string &path, const Image &image, const ImageMetadata &metadata, bool alphaFits) {
    const bool hasRgb = image.HasRgb();
    Image result = image;
    if (image.ChannelCount() == 4 && alphaFits && hasRgb && image.FindChannel("A") >= 0) {
        result = image.Extract({"R", "G", "B", "A"});
    } else if (hasRgb) {
        if (image.ChannelCount() > 3)
            LogWarning("{}: only the channels R, G, B of {} are written; {} files hold no more.", path,
                       image.ChannelCount(), LowerExtension(path));
        result = image.Extract({"R", "G", "B"});
    } else if (image.ChannelCount() != 1 && image.ChannelCount() != 3) {
        throw UserError("{}: an image of {} channels without R, G and B can only be written as .exr.", path,
                        image.ChannelCount());
    }
    if (!hasRgb || !metadata.colorSpace || metadata.colorSpace == &ColorSpace::SRGB()) return result;
    const glm::mat3 toSrgb = ConvertRgbMatrix(*metadata.colorSpace, ColorSpace::SRGB());
    result = result.ConvertTo(PixelFormat::Float);
    ForEachPixel(result, [&](Point2i p) {
        Rgb rgb = toSrgb * Rgb(result.Get(p, 0), result.Get(p, 1), result.Get(p, 2));
        for (int c = 0; c < 3; ++c) result.Set(p, c, rgb[c]);
    });
    return result;
}

}  // namespace

namespace formats {

void CheckSize(const std::string &path, int64_t width, int64_t height, int64_t channels, int bytesPerValue,
               double maxExpansion) {
    if (width < 1 || height < 1 || channels < 1)
        throw UserError("{}: the header has {} x {} pixels of {} channels, which is no image.", path, width, height,
                        channels);
    if (width > kMaxImageSide || height > kMaxImageSide)
        throw UserError("{}: the header has {} x {} pixels; images have at most {} in each direction.", path, width,
                        height, kMaxImageSide);
    const double bytes = double(width) * double(height) * double(channels) * double(bytesPerValue);
    const std::string what =
        fmt::format("{}: the header has {} x {} pixels of {} channels, which", path, width, height, channels);
    RequireMemory(bytes, what, {});
    std::error_code failed;
    const auto stored = double(std::filesystem::file_size(path, failed));
    if (!failed && bytes > stored * maxExpansion)
        throw UserError("{} take {}; the file has {} bytes, which cannot hold them.", what, BytesText(bytes), stored);
}

}  // namespace formats

ImageFile ReadImage(const std::string &path, std::optional<ColorEncoding> encoding) {
    std::error_code code;
    const auto status = std::filesystem::status(path, code);
    if (!std::filesystem::exists(status)) throw UserError("{}: No such image file.", path);
    if (std::filesystem::is_directory(status)) throw UserError("{}: is a directory, not an image.", path);
    if (!std::filesystem::is_regular_file(status))
        throw UserError("{}: is a pipe or a device, not an image file.", path);
    const std::string extension = LowerExtension(path);
    return NamingFile(path, "for", [&] {
        if (extension == ".exr") return formats::ReadExr(path);
        if (extension == ".pfm") return formats::ReadPfm(path);
        if (extension == ".qoi") throw UserError("{}: QOI images cannot be read; convert the image to PNG.", path);
        return formats::ReadOther(path, encoding);
    });
}

void CheckImageName(const std::string &path, const FileLoc &loc) {
    const std::string extension = LowerExtension(path);
    if (extension != ".exr" && extension != ".png" && extension != ".pfm")
        throw UserError(loc, "\"{}\": images are written as .exr, .png or .pfm.", path);
}

std::string WithSuffix(const std::string &path, const std::string &suffix) {
    const std::filesystem::path name(path);
    return (name.parent_path() / (name.stem().string() + suffix + name.extension().string())).string();
}

void WriteImage(const std::string &path, const Image &image, const ImageMetadata &metadata) {
    PBRT_CHECK(image);
    const std::string extension = LowerExtension(path);
    const bool jpeg = extension == ".jpg" || extension == ".jpeg";
    if (!jpeg && extension != ".exr" && extension != ".png" && extension != ".pfm")
        throw UserError("{}: images can be written as .exr, .png, .pfm or .jpg only.", path);
    WriteFile(path, NamingFile(path, "to write", [&] {
                  if (extension == ".exr") return formats::EncodeExr(path, image, metadata);
                  if (extension == ".pfm") return formats::EncodePfm(ForPlainFormat(path, image, metadata, false));
                  return formats::EncodeBytes(jpeg ? "jpeg" : "png", path,
                                              ForPlainFormat(path, image, metadata, !jpeg));
              }));
}

}  // namespace pbrt
