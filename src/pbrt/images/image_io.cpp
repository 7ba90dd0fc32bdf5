#include <algorithm>
#include <cctype>
#include <filesystem>

#include "pbrt/core/error.h"
#include "pbrt/core/files.h"
#include "pbrt/core/log.h"
#include "pbrt/images/image_formats.h"

namespace pbrt {

namespace {

std::string Extension(const std::string &path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

// The message of a library without a final full stop or line end.
std::string Sentence(const std::exception &e) {
    std::string text = e.what();
    while (!text.empty() && (text.back() == '.' || std::isspace(static_cast<unsigned char>(text.back()))))
        text.pop_back();
    return text;
}

// What a format of at most four channels can hold: R, G, B of larger images, as sRGB.
Image ForPlainFormat(const std::string &path, const Image &image, const ImageMetadata &metadata, bool alphaFits) {
    const bool hasRgb = image.FindChannel("R") >= 0 && image.FindChannel("G") >= 0 && image.FindChannel("B") >= 0;
    Image result = image;
    if (image.ChannelCount() == 4 && alphaFits && hasRgb && image.FindChannel("A") >= 0) {
        result = image.Extract({"R", "G", "B", "A"});
    } else if (hasRgb) {
        if (image.ChannelCount() > 3)
            LogWarning(fmt::format("{}: only the channels R, G, B of {} are written; {} files hold no more.", path,
                                   image.ChannelCount(), Extension(path)));
        result = image.Extract({"R", "G", "B"});
    } else if (image.ChannelCount() != 1 && image.ChannelCount() != 3) {
        throw UserError(fmt::format("{}: an image of {} channels without R, G and B can only be written as .exr.", path,
                                    image.ChannelCount()));
    }
    if (!hasRgb || !metadata.colorSpace || metadata.colorSpace == &ColorSpace::SRGB()) return result;
    const glm::mat3 toSrgb = ConvertRgbMatrix(*metadata.colorSpace, ColorSpace::SRGB());
    result = result.ConvertTo(PixelFormat::Float);
    for (int y = 0; y < result.Resolution().y; ++y)
        for (int x = 0; x < result.Resolution().x; ++x) {
            Point2i p(x, y);
            Rgb rgb = toSrgb * Rgb(result.Get(p, 0), result.Get(p, 1), result.Get(p, 2));
            for (int c = 0; c < 3; ++c) result.Set(p, c, rgb[c]);
        }
    return result;
}

}  // namespace

ImageFile ReadImage(const std::string &path, std::optional<ColorEncoding> encoding) {
    std::error_code code;
    const auto status = std::filesystem::status(path, code);
    if (!std::filesystem::exists(status)) throw UserError(fmt::format("{}: No such image file.", path));
    if (std::filesystem::is_directory(status)) throw UserError(fmt::format("{}: is a directory, not an image.", path));
    const std::string extension = Extension(path);
    try {
        if (extension == ".exr") return formats::ReadExr(path);
        if (extension == ".pfm") return formats::ReadPfm(path);
        if (extension == ".qoi")
            throw UserError(fmt::format("{}: QOI images cannot be read; convert the image to PNG.", path));
        return formats::ReadOther(path, encoding);
    } catch (const UserError &) {
        throw;
    } catch (const std::exception &e) {
        throw UserError(fmt::format("{}: {}.", path, Sentence(e)));
    }
}

void WriteImage(const std::string &path, const Image &image, const ImageMetadata &metadata) {
    PBRT_CHECK(image);
    const std::string extension = Extension(path);
    if (extension != ".exr" && extension != ".png" && extension != ".pfm")
        throw UserError(fmt::format("{}: images can be written as .exr, .png or .pfm only.", path));
    try {
        WriteThenRename(path, [&](const std::string &temporary) {
            if (extension == ".exr")
                formats::WriteExr(temporary, path, image, metadata);
            else if (extension == ".png")
                formats::WritePng(temporary, path, ForPlainFormat(path, image, metadata, true));
            else
                formats::WritePfm(temporary, ForPlainFormat(path, image, metadata, false));
        });
    } catch (const UserError &) {
        throw;
    } catch (const std::exception &e) {
        throw UserError(fmt::format("{}: {}.", path, Sentence(e)));
    }
}

}  // namespace pbrt
